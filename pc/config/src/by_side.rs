//! Lists with a value for each side; one stands for all.

use serde::de::Error;
use serde::{Deserialize, Deserializer};
use shared::io::SIDES;

/// One value or two.
pub fn by_side<'de, T, D>(list: D) -> Result<[T; SIDES], D::Error>
where
    T: Deserialize<'de> + Clone,
    D: Deserializer<'de>,
{
    let given: Vec<T> = Vec::deserialize(list)?;
    match &given[..] {
        [all] => Ok([all.clone(), all.clone()]),
        [first, second] => Ok([first.clone(), second.clone()]),
        _ => Err(D::Error::invalid_length(given.len(), &"a value for each side")),
    }
}

/// The same of a key that may be left out.
pub fn some_by_side<'de, T, D>(list: D) -> Result<Option<[T; SIDES]>, D::Error>
where
    T: Deserialize<'de> + Clone,
    D: Deserializer<'de>,
{
    by_side(list).map(Some)
}
