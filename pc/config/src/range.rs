//! Numbers that have to be within a range.

use std::borrow::Cow;
use thiserror::Error;

/// A number of a file that makes no sense.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{key} is {value}, but must be {requirement}")]
pub struct RangeError {
    /// Name of the key, with those of the tables around it where it needs them.
    pub key: Cow<'static, str>,
    /// What was given.
    pub value: f64,
    /// What it must be.
    pub requirement: &'static str,
}

impl RangeError {
    /// The same of a key that stands in `table`.
    #[must_use]
    pub fn within(self, table: &str) -> Self {
        Self {
            key: format!("{table}.{}", self.key).into(),
            ..self
        }
    }
}

/// `value` of `key` if it is finite and `ok`.
///
/// # Errors
/// [`RangeError`] with the `requirement`.
pub fn in_range(
    key: impl Into<Cow<'static, str>>,
    value: f64,
    ok: bool,
    requirement: &'static str,
) -> Result<f64, RangeError> {
    if value.is_finite() && ok {
        Ok(value)
    } else {
        Err(RangeError {
            key: key.into(),
            value,
            requirement,
        })
    }
}
