//! Validation of machine parameters: every `build` names the field it refuses.

use core::fmt;
use core::ops::RangeInclusive;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A parameter that makes no sense, by the name it has in the machine file.
///
/// Two are equal where owner, field and value are.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, Schema, Error)]
#[error("{} of {} is {value}{allowed}", FIELDS.get(*.field as usize).unwrap_or(&"a field"), OWNERS.get(*.owner as usize).unwrap_or(&"the machine"))]
pub struct ParameterError {
    /// Index into the names of owners.
    owner: u8,
    /// Index into the names of fields.
    field: u8,
    /// What was given.
    value: f32,
    /// What may be.
    allowed: Allowed,
}

impl PartialEq for ParameterError {
    fn eq(&self, other: &Self) -> bool {
        (self.owner, self.field) == (other.owner, other.field)
            && (self.value == other.value || self.value.is_nan() && other.value.is_nan())
    }
}

/// What a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Allowed {
    /// Something else.
    Unsaid,
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// From the first to the second.
    Within(f32, f32),
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsaid => f.write_str(", which is out of range"),
            Self::Positive => write!(f, ", but must be above 0"),
            Self::NotNegative => write!(f, ", but must not be below 0"),
            Self::Within(min, max) => write!(f, ", but must be from {min} to {max}"),
        }
    }
}

const OWNERS: &[&str] = &[
    "X1",
    "X2",
    "Y",
    "Z",
    "A",
    "B",
    "C",
    "U1",
    "V1",
    "U2",
    "V2",
    "axis X",
    "axis Y",
    "axis Z",
    "axis A",
    "axis B",
    "axis C",
    "gantry",
    "kinematics",
    "beam 1",
    "beam 2",
    "head",
    "tracking",
    "link",
    "drives",
    "output 1",
    "output 2",
    "output 3",
    "output 4",
    "output 5",
    "output 6",
    "output 7",
    "output 8",
    "analog output 1",
    "analog output 2",
    "input 1",
    "input 2",
    "input 3",
    "input 4",
];

const FIELDS: &[&str] = &[
    "follows_beam",
    "value_at_10v",
    "answers",
    "within_ms",
    "counts_per_unit",
    "velocity_at_10v",
    "kp",
    "ki",
    "integral_limit",
    "anti_windup_time_s",
    "kd",
    "derivative_filter_s",
    "velocity_feed_forward",
    "acceleration_feed_forward_s",
    "notches.frequency_hz",
    "notches.damping",
    "notches.depth",
    "low_pass.frequency_hz",
    "low_pass.damping",
    "friction.coulomb",
    "friction.viscous",
    "friction.reversal_speed",
    "friction.lead_s",
    "friction.decay_s",
    "excitation.amplitude",
    "excitation.from_hz",
    "excitation.to_hz",
    "excitation.settle_periods",
    "excitation.max_travel",
    "excitation.max_speed",
    "max_command",
    "following_error_base",
    "following_error_time_s",
    "vibration_limit",
    "home.velocity",
    "home.mark_position",
    "home.max_travel",
    "travel_min",
    "travel_max",
    "max_velocity",
    "max_acceleration",
    "max_jerk",
    "coupling",
    "coupling_derivative",
    "square_offset_mm",
    "skew_trip_mm",
    "y1_mm",
    "y2_mm",
    "power_at_10v_w",
    "min_speed_mm_s",
    "fitted",
    "home_sequence",
    "slides",
    "joints",
    "direction",
    "point_mm",
    "tip_mm",
    "tool_axis",
    "tangent",
    "work_mm",
    "o1_mm",
    "o2_mm",
    "o3_mm",
    "torch_mm",
    "tilt_axis_mm",
    "turntable_mm",
    "l4_mm",
    "included_angle_deg",
    "working_distance_mm",
    "camera_lead_mm",
    "counts_per_mm",
    "velocity_at_10v_mm_s",
    "travel_min_mm",
    "travel_max_mm",
    "max_velocity_mm_s",
    "max_acceleration_mm_s2",
    "window_mm",
    "hold_mm",
    "gate_mm",
    "lock_mm",
    "preview_s",
    "frame_period_ms",
    "dead_band_mm",
    "stale_path_ms",
    "saturation_trip_ms",
    "search_mm",
    "search_speed_mm_s",
    "link_timeout_ms",
    "period_s",
    "following_error_mm",
    "max_path_speed_mm_s",
    "max_seam_deviation_mm",
    "max_seam_slope",
    "overlap_mm",
    "readback.tolerance",
    "readback.time_ms",
    "unlock_mm",
    "search_height_mm",
    "view_mm",
    "drive_enable_ms",
    "deviation.axis",
    "deviation.motor",
    "deviation.from",
    "deviation.step",
    "deviation.values",
];

impl ParameterError {
    /// The error for `field` of `owner`; both must be in the tables of this file, or they are reported as
    /// "a field" of "the machine".
    pub fn new(owner: &str, field: &str, value: f64) -> Self {
        let place = |names: &[&str], name: &str| {
            let place = names.iter().position(|n| *n == name);
            debug_assert!(place.is_some(), "{name} is not in the tables");
            place.map_or(u8::MAX, |i| i as u8)
        };
        Self {
            owner: place(OWNERS, owner),
            field: place(FIELDS, field),
            value: value as f32,
            allowed: Allowed::Unsaid,
        }
    }

    /// Name of the part of the machine that it is of, such as "axis X".
    pub fn owner(&self) -> Option<&'static str> {
        OWNERS.get(usize::from(self.owner)).copied()
    }

    /// Its name, such as "home.velocity".
    pub fn field(&self) -> Option<&'static str> {
        FIELDS.get(usize::from(self.field)).copied()
    }

    /// What was given, as exact as an error keeps it.
    pub fn value(&self) -> f32 {
        self.value
    }

    /// What may be.
    pub fn allowed(&self) -> Allowed {
        self.allowed
    }

    fn allowing(self, allowed: Allowed) -> Self {
        Self { allowed, ..self }
    }
}

/// `value` if it is finite and `ok`, the error otherwise.
pub fn check(owner: &str, field: &str, value: f64, ok: impl Fn(f64) -> bool) -> Result<f64, ParameterError> {
    if value.is_finite() && ok(value) {
        Ok(value)
    } else {
        Err(ParameterError::new(owner, field, value))
    }
}

/// No part of a machine is longer, and no axis farther from its zero \[mm\]: 100 m.
pub const LARGEST_MACHINE_MM: f64 = 1e5;

/// `vector` \[mm\] if it is one of a machine: none of its numbers beyond [`LARGEST_MACHINE_MM`].
#[inline(never)]
pub fn length_of_machine(
    owner: &str,
    field: &str,
    vector: &[f64; 3],
) -> Result<Vector3<f64>, ParameterError> {
    for &x in vector {
        within(owner, field, x, -LARGEST_MACHINE_MM..=LARGEST_MACHINE_MM)?;
    }
    Ok(Vector3::from(*vector))
}

/// As [`check`], for a value that must be above zero.
pub fn positive(owner: &str, field: &str, value: f64) -> Result<f64, ParameterError> {
    check(owner, field, value, |x| x > 0.0).map_err(|error| error.allowing(Allowed::Positive))
}

/// As [`check`], for a value that must not be below zero.
pub fn not_negative(owner: &str, field: &str, value: f64) -> Result<f64, ParameterError> {
    check(owner, field, value, |x| x >= 0.0).map_err(|error| error.allowing(Allowed::NotNegative))
}

/// As [`check`], for a value that must be in a range, which the error names.
pub fn within(
    owner: &str,
    field: &str,
    value: f64,
    range: RangeInclusive<f64>,
) -> Result<f64, ParameterError> {
    let allowed = Allowed::Within(*range.start() as f32, *range.end() as f32);
    check(owner, field, value, |x| range.contains(&x)).map_err(|error| error.allowing(allowed))
}

/// As [`within`], for the size of a value that may be negative; gives the size.
pub fn within_either_sign(
    owner: &str,
    field: &str,
    value: f64,
    range: RangeInclusive<f64>,
) -> Result<f64, ParameterError> {
    let signed = if value < 0.0 {
        -*range.end()..=-*range.start()
    } else {
        range
    };
    Ok(libm::fabs(within(owner, field, value, signed)?))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_bad_value_is_named_as_in_the_machine_file() {
        let error = positive("Y", "kp", -3.0).unwrap_err();
        assert_eq!(error.to_string(), "kp of Y is -3, but must be above 0");
        let error = within("axis X", "travel_max", 1e6, 0.0..=5e3).unwrap_err();
        assert_eq!(
            error.to_string(),
            "travel_max of axis X is 1000000, but must be from 0 to 5000"
        );
        assert_eq!(error, ParameterError::new("axis X", "travel_max", 1e6));
        assert_ne!(error, ParameterError::new("axis Y", "travel_max", 1e6));
        assert!(positive("Y", "kp", f64::NAN).is_err());
        assert_eq!(not_negative("Y", "ki", 0.0), Ok(0.0));
    }
}
