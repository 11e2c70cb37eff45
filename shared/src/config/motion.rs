//! Parameters of the motion board from the machine file (mm, degrees, seconds).
//!
//! Rotary axes and motors take degrees wherever linear ones take mm; the built forms hold radians.

use crate::control::{GantryConfig, MotorConfig};
use crate::io::{AXES, MOTORS, SIDES};
use crate::kinematics::{AxisConfig, AxisLimits, Kinematics, KinematicsConfig};
use crate::parameter::ParameterError;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Everything the motion board needs to know of its machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct MotionConfig {
    /// Geometry of the machine.
    pub kinematics: KinematicsConfig,
    /// X, Y, Z, A, B, C; those that the kinematics use.
    pub axes: [Option<AxisConfig>; AXES],
    /// X1, X2, Y, Z, A, B, C; one for every axis, and X2 where X is a gantry.
    pub motors: [Option<MotorConfig>; MOTORS],
    /// Coupling of X1 and X2.
    pub gantry: Option<GantryConfig>,
    /// Beam 1 and 2, or whatever else the process switches: an arc, a spindle.
    pub beams: [Option<BeamConfig>; SIDES],
    /// A running path, or homing, stops when nothing was received from the PC for this long \[ms\].
    pub link_timeout_ms: u32,
}

impl MotionConfig {
    /// The kinematics, built with the limits of the axes.
    pub fn kinematics(&self) -> Result<Kinematics, ParameterError> {
        self.kinematics.build(&AxisLimits::build_all(&self.axes)?)
    }
}

/// One beam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct BeamConfig {
    /// Power at +10 V \[W\].
    pub power_at_10v_w: f64,
    /// The gate stays closed below this path speed \[mm/s\].
    pub min_speed_mm_s: f64,
    /// After a hold the beam goes over so much of the path again \[mm\], where it does not stay on.
    #[serde(default = "BeamConfig::overlap_mm")]
    pub overlap_mm: f64,
    /// The gate stays as it is between two paths and in a hold, as a spindle needs it; a stop closes it when the
    /// machine stands. Only sensible with a least speed of 0.
    #[serde(default)]
    pub stays_on_at_rest: bool,
    /// Supervision of the power that the source gives back; none where it is not measured.
    #[serde(default)]
    pub readback: Option<ReadbackConfig>,
}

/// How far and for how long the measured power of a beam may be off the commanded one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct ReadbackConfig {
    /// By how much, as part of the power at +10 V (0.1 for a tenth).
    pub tolerance: f64,
    /// For how long \[ms\]: longer than the source takes to follow its command, and the measurement that.
    pub time_ms: u32,
}

impl BeamConfig {
    /// The overlap if the machine file gives none: assumed, about the width of a bead.
    pub const fn overlap_mm() -> f64 {
        2.0
    }
}
