//! The table of tools.

use super::Mistake;
use crate::in_range;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Longest and shortest tool against the one of the machine file \[mm\].
const MOST_MM: f64 = 1000.0;

/// `[tools.N]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ToolConfig {
    /// How far its end is beyond the tip of the machine file, along the tool \[mm\].
    length_mm: f64,
}

/// Their lengths by their numbers \[mm\].
pub(super) fn lengths(tools: BTreeMap<String, ToolConfig>) -> Result<BTreeMap<u32, f64>, Mistake> {
    let mut lengths = BTreeMap::new();
    for (name, tool) in tools {
        let key = format!("tools.{name}");
        let number = name
            .parse()
            .ok()
            .filter(|number: &u32| *number > 0 && number.to_string() == name);
        let number = number.ok_or_else(|| Mistake::ToolNumber { key: key.clone() })?;
        let length = tool.length_mm;
        let key = format!("{key}.length_mm");
        in_range(key, length, length.abs() <= MOST_MM, "from -1000 to 1000")?;
        lengths.insert(number, length);
    }
    Ok(lengths)
}
