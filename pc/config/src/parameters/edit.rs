//! Another value in the text of a file.

use super::{Kind, Parameter};
use thiserror::Error;
use toml::de::DeTable;

/// Why a value is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum EditError {
    /// It must be a number.
    #[error("must be a number")]
    NotANumber,
    /// It must be a whole number.
    #[error("must be a whole number")]
    NotWhole,
    /// It must be written as values are in the file.
    #[error("must be written as in the file, such as true or [1.0, 2.0]")]
    NotAValue,
}

/// `text` with what was typed as the value of `parameter`, one of its own; the rest of it stays to the letter.
///
/// # Errors
/// [`EditError`]: it is no value of that kind. Whether the machine can be run with it is for the reader of the file to say.
pub fn replace(text: &str, parameter: &Parameter, typed: &str) -> Result<String, EditError> {
    let value = written(parameter.kind, typed.trim())?;
    let (before, after) = (&text[..parameter.span.start], &text[parameter.span.end..]);
    Ok(format!("{before}{value}{after}"))
}

/// What was typed, as it is written in a file.
fn written(kind: Kind, typed: &str) -> Result<String, EditError> {
    let as_in_file = kind_in_file(typed);
    match kind {
        Kind::Float => match typed.replace('_', "").parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(match as_in_file {
                Some(Kind::Float) => typed.to_owned(),
                _ => format!("{number:?}"),
            }),
            _ => Err(EditError::NotANumber),
        },
        Kind::Integer if as_in_file == Some(Kind::Integer) => Ok(typed.to_owned()),
        Kind::Integer => Err(EditError::NotWhole),
        // With its quotation marks or without.
        Kind::Text if as_in_file == Some(Kind::Text) => Ok(typed.to_owned()),
        Kind::Text => Ok(toml::Value::from(typed).to_string()),
        Kind::Other if as_in_file.is_some() => Ok(typed.to_owned()),
        Kind::Other => Err(EditError::NotAValue),
    }
}

/// What `typed` is, where it is a value as it is written in a file, and nothing else, not even a comment.
fn kind_in_file(typed: &str) -> Option<Kind> {
    let line = format!("value = {typed}");
    let document = DeTable::parse(&line).ok()?;
    let mut values = document.get_ref().iter();
    let (_, value) = values.next().filter(|_| values.next().is_none())?;
    (line[value.span()] == *typed).then(|| Kind::of(value.get_ref()))
}
