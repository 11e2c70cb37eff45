//! Letters for where there are no fonts of a system, as in a browser.

use eframe::egui::{Context, FontData, FontDefinitions};
use std::sync::Arc;

/// The Chinese letters of [`crate::texts`], and no others: [how it is made](../../fonts/README.md).
const CHINESE: &[u8] = include_bytes!("../fonts/chinese.ttf");

/// Has `ctx` draw with the fonts that egui brings, and with letters for Chinese.
pub fn add_chinese(ctx: &Context) {
    let mut fonts = FontDefinitions::default();
    let font = Arc::new(FontData::from_static(CHINESE));
    fonts.font_data.insert("chinese".to_owned(), font);
    for names in fonts.families.values_mut() {
        // Hack has arrows.
        for name in ["Hack", "chinese"] {
            if !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
    }
    ctx.set_fonts(fonts);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::{Language, Text};
    use eframe::egui::{FontId, RawInput};

    #[test]
    fn every_text_in_every_language_has_its_letters() {
        let ctx = Context::default();
        add_chinese(&ctx);
        ctx.run_ui(RawInput::default(), |_| {})
            .drop_without_applying_deltas();
        let font = FontId::proportional(16.0);
        let has = |text: &str| ctx.fonts_mut(|fonts| fonts.has_glyphs(&font, text));
        for text in Text::ALL {
            for language in Language::ALL {
                assert!(has(text.in_language(language)), "{text:?} in {language:?}");
            }
        }
        // Faults are no table.
        for letter in include_str!("texts/faults.rs")
            .chars()
            .filter(|letter| !letter.is_control())
        {
            assert!(has(&letter.to_string()), "{letter}");
        }
        assert!(!has("饕"), "only what is said is in it");
    }
}
