//! TOML files: what is wrong with one is named by file and line.

use serde::de::DeserializeOwned;
use std::path::Path;
use thiserror::Error;

/// Why a TOML file cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum TomlError {
    /// The file cannot be read.
    #[error("cannot read {what} {path}: {source}")]
    Read {
        /// What it is, as "machine file".
        what: &'static str,
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not TOML, or a key is missing, unknown or of the wrong type.
    #[error("{what} {path}, line {line}: {message}")]
    Content {
        /// What it is.
        what: &'static str,
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
}

/// The text of the file at `path`; `what` it is, as "machine file", is used in messages only.
///
/// # Errors
/// [`TomlError::Read`].
pub fn text(what: &'static str, path: &Path) -> Result<String, TomlError> {
    std::fs::read_to_string(path).map_err(|source| TomlError::Read {
        what,
        path: path.display().to_string(),
        source,
    })
}

/// Understands the `text` of the file at `path`; both `what` it is and `path` are used in messages only.
///
/// # Errors
/// [`TomlError::Content`].
pub fn parse<T: DeserializeOwned>(what: &'static str, path: &str, text: &str) -> Result<T, TomlError> {
    toml::from_str(text).map_err(|error| {
        let start = error.span().map_or(0, |span| span.start);
        TomlError::Content {
            what,
            path: path.to_owned(),
            line: 1 + text.bytes().take(start).filter(|byte| *byte == b'\n').count(),
            message: error.message().replace('\n', ", "),
        }
    })
}
