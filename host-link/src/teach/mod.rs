//! Teaching by ranging: the normal of a surface from distances to it on a small circle (mathematics 2).
//!
//! Everything is in the frame of the probe: Z against its beam (from the surface to the probe), the centre of the
//! ring at the origin. What is measured there has to be turned into the work frame with the probe's attitude.
//!
//! Teaching by cameras, for seams that can be seen, is in [`seam`].

mod halving;
mod points;
mod probe;
mod ring;
mod routine;
pub mod seam;
mod triples;
mod unit;

pub use halving::{Halving, HalvingConfig, HalvingError, StopRule, Taught};
pub use points::{TaughtPoint, read_points, write_points};
pub use probe::{Probe, ProbeConfig, Ranging, RangingError, Reading, Refused};
pub use ring::{Curvature, Harmonics, Plane, Ring, RingError, Unsmooth};
pub use routine::{Arm, Guide, Look, PointError, TeachError, Teacher, TeachingConfig, aim};
pub use triples::Triples;
pub use unit::{ProbeUnit, SimulatedProbeConfig};

#[cfg(test)]
mod tests;

use thiserror::Error;

/// A parameter that makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{key} is {value}, but must be {requirement}")]
pub struct TeachParameterError {
    /// Name of the key.
    pub key: &'static str,
    /// What was given.
    pub value: f64,
    /// What it must be.
    pub requirement: &'static str,
}

/// The error for `key` unless it is `ok`.
fn check(
    key: &'static str,
    value: f64,
    ok: bool,
    requirement: &'static str,
) -> Result<f64, TeachParameterError> {
    if value.is_finite() && ok {
        Ok(value)
    } else {
        Err(TeachParameterError {
            key,
            value,
            requirement,
        })
    }
}
