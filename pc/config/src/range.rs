//! Numbers that have to be within a range.

use thiserror::Error;

/// A number of a file that makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{key} is {value}, but must be {requirement}")]
pub struct RangeError {
    /// Name of the key.
    pub key: &'static str,
    /// What was given.
    pub value: f64,
    /// What it must be.
    pub requirement: &'static str,
}

/// `value` of `key` if it is finite and `ok`.
///
/// # Errors
/// [`RangeError`] with the `requirement`.
pub fn in_range(
    key: &'static str,
    value: f64,
    ok: bool,
    requirement: &'static str,
) -> Result<f64, RangeError> {
    if value.is_finite() && ok {
        Ok(value)
    } else {
        Err(RangeError {
            key,
            value,
            requirement,
        })
    }
}
