//! The machines as both programs get them: one after the other in postcard.

use serde::{Deserialize, Serialize};
use shared::io::AXES;
use shared::kinematics::{AxisConfig, AxisLimits, Kinematics, KinematicsConfig};
use shared::parameter::ParameterError;
use thiserror::Error;

/// What of a machine file the benchmarks need.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Geometry.
    pub kinematics: KinematicsConfig,
    /// Limits of X Y Z A B C (mm, degrees).
    pub axes: [Option<AxisConfig>; AXES],
}

impl Machine {
    /// Kinematics and limits, ready for use.
    pub fn build(&self) -> Result<(Kinematics, [AxisLimits; AXES]), ParameterError> {
        let limits = AxisLimits::build_all(&self.axes)?;
        Ok((self.kinematics.build(&limits)?, limits))
    }
}

/// The file of machines is cut off, or of another version.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the file of machines cannot be read: {0}")]
pub struct Unreadable(postcard::Error);

/// The machines of `file`.
pub fn machines(file: &[u8]) -> impl Iterator<Item = Result<Machine, Unreadable>> {
    let mut rest = file;
    core::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let (machine, left) = postcard::take_from_bytes(rest).map_err(Unreadable).map_or_else(
            |error| (Err(error), &[][..]),
            |(machine, left)| (Ok(machine), left),
        );
        rest = left;
        Some(machine)
    })
}
