//! How the screen looks, and its PINs, in a file that outlives it.

use crate::access::{Access, Pins};
use crate::serving::token::Token;
use crate::texts::Language;
use anyhow::Context;
use config::toml_file::parse;
use config::{kept, sentence};
use serde::{Deserialize, Serialize};
use std::fs::OpenOptions;
use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};
use view::look::{Look, SIZES};

/// What the file begins with.
const COMMENT: &str =
    "# Written by the operator's screen. Without this file it begins as usual, without PINs.\n";

/// What is in the file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Content {
    language: Language,
    size: Size,
    high_contrast: bool,
    left_handed: bool,
    keys_on_screen: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pins: Option<Pins>,
    #[serde(skip_serializing_if = "Option::is_none")]
    viewers_token: Option<String>,
}

impl Default for Content {
    fn default() -> Self {
        Self::of(&Look::default(), None, None)
    }
}

impl Content {
    fn of(look: &Look, pins: Option<&Pins>, token: Option<&Token>) -> Self {
        Self {
            language: look.language,
            size: Size(look.zoom),
            high_contrast: look.high_contrast,
            left_handed: look.left_handed,
            keys_on_screen: look.keys_on_screen,
            pins: pins.cloned(),
            viewers_token: token.map(|token| token.text().to_owned()),
        }
    }
}

/// A size that can be chosen.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(into = "f64", try_from = "f64")]
struct Size(f32);

impl From<Size> for f64 {
    /// Without the digits that a shorter number does not have.
    fn from(size: Size) -> Self {
        (Self::from(size.0) * 100.0).round() / 100.0
    }
}

impl TryFrom<f64> for Size {
    type Error = String;

    #[allow(clippy::cast_possible_truncation, reason = "of a size, few digits matter")]
    fn try_from(size: f64) -> Result<Self, Self::Error> {
        let size = size as f32;
        if SIZES.contains(&size) {
            Ok(Self(size))
        } else {
            let (least, most) = SIZES.into_inner();
            Err(format!("must be from {least} to {most}"))
        }
    }
}

/// The file, and what was in it when it was read.
#[derive(Debug, Default)]
pub struct Settings {
    /// Nothing is written without one, nor over one that could not be read.
    file: Option<PathBuf>,
    /// How the screen looks.
    pub look: Look,
    /// Who may do what.
    pub access: Access,
    /// What a viewer has to know, once the screen was served.
    token: Option<Token>,
    /// Why the file was not read.
    pub unread: Option<String>,
}

impl Settings {
    /// What is in `file`; as usual, if there is none. Where it cannot be read, and may hold PINs, nothing lets in.
    pub fn read(file: PathBuf) -> Self {
        let text = match std::fs::read_to_string(&file) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Self {
                    file: Some(file),
                    ..Self::default()
                };
            }
            Err(error) => return Self::unread(&format!("{}: {error}", file.display()), true),
        };
        match parse::<Content>("settings", &file.display().to_string(), &text) {
            Ok(content) => Self {
                file: Some(file),
                look: Look {
                    language: content.language,
                    high_contrast: content.high_contrast,
                    left_handed: content.left_handed,
                    keys_on_screen: content.keys_on_screen,
                    zoom: content.size.0,
                },
                access: Access::new(content.pins),
                // One that is none is made anew.
                token: content.viewers_token.as_deref().and_then(Token::read),
                unread: None,
            },
            Err(error) => Self::unread(&sentence(&error), may_hold_pins(&text)),
        }
    }

    fn unread(error: &str, may_hold_pins: bool) -> Self {
        Self {
            access: if may_hold_pins {
                Access::closed()
            } else {
                Access::default()
            },
            unread: Some(error.to_owned()),
            ..Self::default()
        }
    }

    /// Where the settings are, if nothing else is told: `seamwright/hmi.toml` among those of the user.
    pub fn usual_file() -> Option<PathBuf> {
        let told = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        let folder = told("XDG_CONFIG_HOME")
            .map(PathBuf::from)
            // A path that is not absolute is none, by the specification.
            .filter(|folder| folder.is_absolute())
            .or_else(|| Some(PathBuf::from(told("HOME")?).join(".config")))?;
        Some(folder.join("seamwright").join("hmi.toml"))
    }

    /// The folder that they are in.
    pub fn folder(&self) -> Option<&Path> {
        self.file.as_deref().and_then(Path::parent)
    }

    /// What a viewer has to know; made once, and written.
    ///
    /// # Errors
    /// A sentence: there are no random numbers, or it cannot be written.
    pub fn token(&mut self) -> anyhow::Result<Token> {
        if let Some(token) = &self.token {
            return Ok(token.clone());
        }
        let token = Token::random().context("the system gives no random numbers")?;
        self.token = Some(token.clone());
        self.write(&self.look, self.access.pins())?;
        Ok(token)
    }

    /// Writes `look` and `pins`, if there is a file that may be written.
    ///
    /// # Errors
    /// A sentence; the file is as before then.
    pub fn write(&self, look: &Look, pins: Option<&Pins>) -> anyhow::Result<()> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let cannot = || format!("cannot write {}", file.display());
        let content = toml::to_string(&Content::of(look, pins, self.token.as_ref())).with_context(cannot)?;
        make_private(file)
            .and_then(|()| kept::replace(file, &format!("{COMMENT}{content}")))
            .with_context(cannot)
    }
}

/// Whether a text that is no settings may yet hold PINs: better too often than too rarely.
fn may_hold_pins(text: &str) -> bool {
    text.contains("pins") || text.contains("sha256")
}

/// Makes the file and its folder if there is none: what replaces it later is for the same readers.
fn make_private(file: &Path) -> Result<(), IoError> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    match options.write(true).create_new(true).open(file) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
