//! What differs between two versions of a file.

use super::{Table, list};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A value that differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// Dotted name of its key.
    pub key: String,
    /// What it was, as it was written; `None` where it was left out.
    pub old: Option<String>,
    /// What it is, or `None`.
    pub new: Option<String>,
}

/// The values that differ between `old` and `new`, in the order of `old`; what only `new` has comes last. How they are
/// written, and comments, are no matter.
pub fn changes(old: &str, new: &str) -> Vec<Change> {
    differing(&list(old), &list(new))
}

/// The same of what is listed.
pub fn differing(old: &[Table], new: &[Table]) -> Vec<Change> {
    let values = |tables: &[Table]| -> Vec<(String, String)> {
        let parameters = tables.iter().flat_map(|table| &table.parameters);
        parameters
            .map(|one| (one.key.clone(), one.value.clone()))
            .collect()
    };
    let (old, new) = (values(old), values(new));
    let mut news: BTreeMap<&str, &str> = new.iter().map(|(key, value)| (&**key, &**value)).collect();
    let mut found = Vec::new();
    for (key, before) in &old {
        let after = news.remove(&**key);
        if !after.is_some_and(|after| is_same(before, after)) {
            found.push(Change {
                key: key.clone(),
                old: Some(before.clone()),
                new: after.map(str::to_owned),
            });
        }
    }
    let added = new.iter().filter(|(key, _)| news.contains_key(&**key));
    found.extend(added.map(|(key, value)| Change {
        key: key.clone(),
        old: None,
        new: Some(value.clone()),
    }));
    found
}

/// Whether two values are the same, as they are written or as numbers.
pub fn is_same(one: &str, other: &str) -> bool {
    let number = |value: &str| value.trim().replace('_', "").parse::<f64>().ok();
    one == other || number(one).is_some_and(|one| number(other) == Some(one))
}
