//! The plants of the shipped machines.

use crate::{PlantChoice, PlantFile, PlantFileError, Quality};

/// The machine where none is named.
pub const DEFAULT_MACHINE: &str = SHIPPED[0].0;

/// The plant that `machines/commissioned` was commissioned on: a usual machine of the kind of [`DEFAULT_MACHINE`].
pub const COMMISSIONED: PlantChoice = PlantChoice::Drawn {
    quality: Quality::Usual,
    seed: 401,
};

/// The plants, called as the kinematics of their machines are ([`shared::kinematics::KinematicsConfig::NAMES`]).
const SHIPPED: [(&str, &str); 5] = [
    (
        "dual-beam-gantry",
        include_str!("../../../machines/dual-beam-gantry.plant.toml"),
    ),
    (
        "pipe-welder",
        include_str!("../../../machines/pipe-welder.plant.toml"),
    ),
    ("ac-head", include_str!("../../../machines/ac-head.plant.toml")),
    ("wire-arc", include_str!("../../../machines/wire-arc.plant.toml")),
    (
        "stir-gantry",
        include_str!("../../../machines/stir-gantry.plant.toml"),
    ),
];

/// Names of all machines that have a plant.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}

impl PlantFile {
    /// The shipped plant of the machine that is called so, as its kinematics are.
    pub fn shipped(machine: &str) -> Result<Self, PlantFileError> {
        let (name, text) =
            SHIPPED
                .iter()
                .find(|(name, _)| *name == machine)
                .ok_or_else(|| PlantFileError::Unknown {
                    machine: machine.to_owned(),
                    known: names().collect::<Vec<_>>().join(", "),
                })?;
        Self::parse(&format!("machines/{name}.plant.toml"), text)
    }
}
