//! TOML files: what is wrong with one is named by file and line.

use serde::de::DeserializeOwned;
use std::path::Path;
use thiserror::Error;
use toml::de::{DeTable, DeValue};

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
            line: line_at(text, start),
            message: match key_at(text, start) {
                Some(key) => format!("{key}: {}", one_line(error.message())),
                None => one_line(error.message()),
            },
        }
    })
}

/// The line of `text` with the key of this dotted name, or with the innermost table around it that is there; the first
/// line is 1. What follows a blank is no part of the name.
pub fn line_of(text: &str, key: &str) -> usize {
    let mut line = 1;
    let Ok(document) = DeTable::parse(text) else {
        return line;
    };
    let mut table = Some(document.get_ref());
    for part in key.split_whitespace().next().unwrap_or_default().split('.') {
        let Some((name, value)) = table.and_then(|table| table.get_key_value(part)) else {
            break;
        };
        line = line_at(text, name.span().start);
        table = match value.get_ref() {
            DeValue::Table(inner) => Some(inner),
            _ => None,
        };
    }
    line
}

/// Dotted name of the key whose value, no table, is at the byte number `start`.
fn key_at(text: &str, start: usize) -> Option<String> {
    fn inside(table: &DeTable, start: usize) -> Option<String> {
        table.iter().find_map(|(name, value)| {
            let name = name.get_ref();
            let inner = match value.get_ref() {
                DeValue::Table(inner) => inside(inner, start),
                DeValue::Array(values) if values.iter().any(|value| value.get_ref().is_table()) => {
                    let tables = values.iter().filter_map(|value| value.get_ref().as_table());
                    tables.into_iter().find_map(|table| inside(table, start))
                }
                _ => return value.span().contains(&start).then(|| name.to_string()),
            };
            inner.map(|key| format!("{name}.{key}"))
        })
    }
    inside(DeTable::parse(text).ok()?.get_ref(), start)
}

fn one_line(text: &str) -> String {
    text.replace('\n', ", ")
}

/// The line of the byte number `start`.
pub(crate) fn line_at(text: &str, start: usize) -> usize {
    1 + text.bytes().take(start).filter(|byte| *byte == b'\n').count()
}
