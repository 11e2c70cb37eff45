//! The machine files that are shipped, as they were when this was built.

use super::list;
use std::collections::BTreeMap;

/// Each by its kinematics.
const SHIPPED: [(&str, &str); 5] = [
    (
        "dual-beam-gantry",
        include_str!("../../../../machines/dual-beam-gantry.toml"),
    ),
    (
        "pipe-welder",
        include_str!("../../../../machines/pipe-welder.toml"),
    ),
    ("ac-head", include_str!("../../../../machines/ac-head.toml")),
    ("wire-arc", include_str!("../../../../machines/wire-arc.toml")),
    (
        "stir-gantry",
        include_str!("../../../../machines/stir-gantry.toml"),
    ),
];

/// The text of the shipped file of the machine with these kinematics.
pub fn shipped(kinematics: &str) -> Option<&'static str> {
    let found = SHIPPED.iter().find(|(name, _)| *name == kinematics);
    found.map(|(_, text)| *text)
}

/// The values, by their keys, of the shipped file of the machine that has the kinematics of the machine file `text`.
pub fn shipped_values(text: &str) -> BTreeMap<String, String> {
    let tables = list(text);
    let mut kinds = tables
        .iter()
        .filter_map(|table| table.name.strip_prefix("kinematics."));
    let shipped = kinds.next().and_then(shipped).map_or_else(Vec::new, list);
    let parameters = shipped.into_iter().flat_map(|table| table.parameters);
    parameters.map(|one| (one.key, one.value)).collect()
}
