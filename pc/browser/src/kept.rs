//! How the page looks, kept by the browser.

use serde::{Deserialize, Serialize};
use view::look::{Look, SIZES};
use view::texts::Language;
use web_sys::Storage;

/// What it is kept under.
const KEY: &str = "seamwright";

/// What is kept.
#[derive(Serialize, Deserialize)]
struct Kept {
    language: Language,
    high_contrast: bool,
    zoom: f32,
}

/// As it was kept, or else in the language of the browser.
pub(super) fn look() -> Look {
    let text = storage().and_then(|storage| storage.get_item(KEY).ok()?);
    let kept: Option<Kept> = text.and_then(|text| serde_json::from_str(&text).ok());
    match kept {
        Some(kept) => Look {
            language: kept.language,
            high_contrast: kept.high_contrast,
            zoom: kept.zoom.clamp(*SIZES.start(), *SIZES.end()),
            ..Look::default()
        },
        None => Look {
            language: language().unwrap_or_default(),
            ..Look::default()
        },
    }
}

/// Keeps `look`; or a sentence why not.
pub(super) fn keep(look: &Look) -> Result<(), String> {
    let kept = Kept {
        language: look.language,
        high_contrast: look.high_contrast,
        zoom: look.zoom,
    };
    let text = serde_json::to_string(&kept).map_err(|error| error.to_string())?;
    let storage = storage().ok_or("this browser keeps nothing for this page")?;
    let kept = storage.set_item(KEY, &text);
    kept.map_err(|_| "this browser keeps nothing for this page".to_owned())
}

fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok()?
}

/// That of the browser, if the page speaks it.
fn language() -> Option<Language> {
    let told = web_sys::window()?.navigator().language()?;
    let primary = |tag: &str| tag.split('-').next().map(str::to_ascii_lowercase);
    let mut all = Language::ALL.into_iter();
    all.find(|language| primary(language.tag()) == primary(&told))
}
