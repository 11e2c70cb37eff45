//! Parameters of drives from the machine file (mm, degrees, seconds).
//!
//! Rotary motors take degrees wherever linear ones take mm; the built laws hold radians.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

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
