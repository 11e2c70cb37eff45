//! Parameters of the motion board from the machine file (mm, degrees, seconds).
//!
//! Rotary axes and motors take degrees wherever linear ones take mm; the built forms hold radians.

use crate::control::{GantryConfig, MotorConfig};
use crate::io::{ANALOG_OUTPUTS, AXES, MOTORS, OUTPUTS, PROCESS_INPUTS, SIDES};
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
    /// What the board switches, sets and looks at for the process besides.
    pub process: ProcessIo,
    /// A running path, or homing, stops when nothing was received from the PC for this long \[ms\].
    pub link_timeout_ms: u32,
    /// From their enable on, drives take so long until they follow a command, brakes open and all \[ms\]; they are told 0 V until
    /// then.
    pub drive_enable_ms: u32,
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

/// Outputs and inputs of the process; none of what the machine does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct ProcessIo {
    /// Digital outputs.
    pub outputs: [Option<OutputConfig>; OUTPUTS],
    /// Analog outputs.
    pub analog: [Option<AnalogConfig>; ANALOG_OUTPUTS],
    /// Inputs by which the process answers.
    pub inputs: [Option<ProcessInputConfig>; PROCESS_INPUTS],
}

/// A digital output of the process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct OutputConfig {
    /// It is on only while this beam is open, 0 or 1: wire that would run on without its arc.
    pub follows_beam: Option<u8>,
}

/// An analog output of the process.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct AnalogConfig {
    /// Value at +10 V, in whatever unit programs use.
    pub value_at_10v: f64,
    /// It is 0 V but while this beam is open, 0 or 1.
    pub follows_beam: Option<u8>,
}

/// An input by which the process answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ProcessInputConfig {
    /// The line that it answers: 0 and 1 are the gates of the beams, the digital outputs follow.
    pub answers: u8,
    /// The machine stops where the input is off for longer than this while the line is on \[ms\].
    pub within_ms: u32,
}

impl BeamConfig {
    /// The overlap if the machine file gives none: assumed, about the width of a bead.
    pub const fn overlap_mm() -> f64 {
        2.0
    }
}
