//! The machine files that are shipped, as they were when this was built.

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
