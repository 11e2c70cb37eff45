//! What a machine file says about the motion board, in human units (mm, degrees, seconds).
//!
//! Rotary axes and motors take degrees wherever linear ones take mm; the built forms hold radians.

use crate::io::{AXES, MOTORS, SIDES};
use crate::kinematics::{AxisLimits, Kinematics, KinematicsConfig};
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
    /// A running path, or homing, stops when the PC has not been heard for this long \[ms\].
    pub link_timeout_ms: u32,
}

impl MotionConfig {
    /// The kinematics, built with the limits of the axes.
    pub fn kinematics(&self) -> Result<Kinematics, ParameterError> {
        self.kinematics.build(&AxisLimits::build_all(&self.axes)?)
    }
}

/// Limits of one axis (mm or degrees).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct AxisConfig {
    /// Lowest position.
    pub travel_min: f64,
    /// Highest position.
    pub travel_max: f64,
    /// Highest speed \[1/s\].
    pub max_velocity: f64,
    /// Highest acceleration \[1/s²\].
    pub max_acceleration: f64,
    /// Highest jerk \[1/s³\].
    pub max_jerk: f64,
}

/// One servo drive with its grating and its position loop (mm or degrees).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct MotorConfig {
    /// Grating counts in one mm or degree; negative if the grating counts down in the positive direction.
    pub counts_per_unit: f64,
    /// Speed at +10 V \[1/s\]; negative if the drive turns backwards.
    pub velocity_at_10v: f64,
    /// Position gain kp \[1/s\].
    pub kp: f64,
    /// Integral gain ki \[1/s²\].
    pub ki: f64,
    /// Largest contribution of the integral part \[1/s\] (unit per second).
    pub integral_limit: f64,
    /// Anti-windup tracking time tt \[s\]; 0 switches it off.
    pub anti_windup_time_s: f64,
    /// Derivative gain kd; 0 is normally best with a velocity drive.
    pub kd: f64,
    /// Time constant of the derivative filter td \[s\].
    pub derivative_filter_s: f64,
    /// Velocity feed-forward kv, 1 for a calibrated drive.
    pub velocity_feed_forward: f64,
    /// Acceleration feed-forward ka \[s\]: the delay of the velocity loop.
    pub acceleration_feed_forward_s: f64,
    /// Largest velocity command \[1/s\].
    pub max_command: f64,
    /// Following-error trip at standstill.
    pub following_error_base: f64,
    /// Following-error trip grows by this time × speed \[s\].
    pub following_error_time_s: f64,
    /// Motors with a lower number find their reference first, those with the same number together.
    pub home_sequence: u8,
    /// How the motor finds its reference mark.
    pub home: HomeConfig,
}

/// Search for one reference mark (mm or degrees).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct HomeConfig {
    /// Speed and first direction of the search \[1/s\]; turns round at a limit switch.
    pub velocity: f64,
    /// Axis position of the mark.
    pub mark_position: f64,
    /// The search fails after this much travel.
    pub max_travel: f64,
}

/// Gantry X1/X2 (mathematics 0.10).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct GantryConfig {
    /// Cross-coupling gain kc \[1/s\].
    pub coupling: f64,
    /// Cross-coupling derivative gain kcd.
    pub coupling_derivative: f64,
    /// Time constant of the derivative filter \[s\].
    pub derivative_filter_s: f64,
    /// X1 − X2 at which the beam is square, after both marks are found \[mm\].
    pub square_offset_mm: f64,
    /// Skew at which both drives are switched off \[mm\].
    pub skew_trip_mm: f64,
    /// Cross position of motor X1 \[mm\].
    pub y1_mm: f64,
    /// Cross position of motor X2 \[mm\].
    pub y2_mm: f64,
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
    /// An overlap where the machine file tells none: assumed, about the width of a bead.
    pub const fn overlap_mm() -> f64 {
        2.0
    }
}
