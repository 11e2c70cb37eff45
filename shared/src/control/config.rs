//! Parameters of drives from the machine file (mm, degrees, seconds).
//!
//! Rotary motors take degrees wherever linear ones take mm; the built laws hold radians.

use super::loop_filter::NOTCHES;
use core::f64::consts::PI;
use heapless::Vec;
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
    /// Notches in the feedback, in series; none if left out.
    #[serde(default)]
    pub notches: Vec<NotchConfig, NOTCHES>,
    /// Low-pass in the feedback; none if left out.
    #[serde(default)]
    pub low_pass: Option<LowPassConfig>,
    /// Feed-forward of friction; none if left out.
    #[serde(default)]
    pub friction: Option<FrictionConfig>,
    /// Largest velocity command \[1/s\].
    pub max_command: f64,
    /// Following-error trip at standstill.
    pub following_error_base: f64,
    /// Following-error trip grows by this time × speed \[s\].
    pub following_error_time_s: f64,
    /// Vibration trip: root mean square of the following error above 10 Hz; 0, or left out, switches it off.
    #[serde(default)]
    pub vibration_limit: f64,
    /// Motors with a lower number find their reference first, those with the same number together.
    pub home_sequence: u8,
    /// How the motor finds its reference mark.
    pub home: HomeConfig,
}

impl MotorConfig {
    /// By how much notches and low-pass delay what is slow against them \[s\].
    pub fn filter_lag_s(&self) -> f64 {
        let notch = |notch: &NotchConfig| notch.damping * (1.0 - notch.depth) / (PI * notch.frequency_hz);
        let low_pass = |filter: &LowPassConfig| filter.damping / (PI * filter.frequency_hz);
        self.notches.iter().map(notch).sum::<f64>() + self.low_pass.as_ref().map_or(0.0, low_pass)
    }
}

/// A notch (s² + 2·depth·ζ·ω·s + ω²)/(s² + 2ζω·s + ω²) (mathematics 0.10).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct NotchConfig {
    /// Where its gain is least \[Hz\], below half the rate of the servo ticks.
    pub frequency_hz: f64,
    /// Damping ζ of its poles, above 0: the gain is less than 1/√2 over 2ζ times the frequency, if the depth is 0.
    pub damping: f64,
    /// Gain at that frequency, 0…1.
    pub depth: f64,
}

/// A low-pass ω²/(s² + 2ζω·s + ω²) (mathematics 0.10).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct LowPassConfig {
    /// Its corner \[Hz\], below half the rate of the servo ticks.
    pub frequency_hz: f64,
    /// Damping ζ of its poles, above 0; 0.7 has no peak.
    pub damping: f64,
}

/// Friction, as the speed that a drive falls short of its command by it (mathematics 0.10).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct FrictionConfig {
    /// Coulomb friction \[1/s\] (unit per second).
    pub coulomb: f64,
    /// Viscous friction, as a part of the speed.
    #[serde(default)]
    pub viscous: f64,
    /// Speed at which Coulomb friction has turned round, and below which it grows smoothly \[1/s\], above 0.
    pub reversal_speed: f64,
    /// So much earlier than the motor moves the drive is told: its dead time \[s\].
    #[serde(default)]
    pub lead_s: f64,
    /// Time constant in which the integral part of the drive's velocity loop takes the friction over \[s\]; 0 for a
    /// drive without one.
    #[serde(default)]
    pub decay_s: f64,
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
