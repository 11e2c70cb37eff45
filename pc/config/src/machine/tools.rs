//! The table of tools.

use super::Mistake;
use crate::in_range;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Longest and shortest tool against the one of the machine file, and the largest diameter \[mm\].
const MOST_MM: f64 = 1000.0;

/// `[tools.N]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ToolConfig {
    /// How far its end is beyond the tip of the machine file, along the tool \[mm\].
    pub length_mm: f64,
    /// For cutter compensation \[mm\].
    pub diameter_mm: f64,
}

/// Tools by their numbers.
pub(super) fn by_number(tools: BTreeMap<String, ToolConfig>) -> Result<BTreeMap<u32, ToolConfig>, Mistake> {
    let mut by_number = BTreeMap::new();
    for (name, tool) in tools {
        let key = format!("tools.{name}");
        let number = name
            .parse()
            .ok()
            .filter(|number: &u32| *number > 0 && number.to_string() == name);
        let number = number.ok_or_else(|| Mistake::ToolNumber { key: key.clone() })?;
        for (name, value) in [("length_mm", tool.length_mm), ("diameter_mm", tool.diameter_mm)] {
            let key = format!("{key}.{name}");
            in_range(key, value, value.abs() <= MOST_MM, "from -1000 to 1000")?;
        }
        by_number.insert(number, tool);
    }
    Ok(by_number)
}
