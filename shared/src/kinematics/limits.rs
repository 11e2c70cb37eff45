//! Travel and speed of the linked axes.

use crate::io::{AXES, Bits};
use crate::parameter::{ParameterError, check, positive};
use crate::units::DEG_PER_RAD;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Internal units (mm, rad) in one unit of the machine file (mm, degrees), for X Y Z A B C.
pub const AXIS_UNIT: [f64; AXES] = [
    1.0,
    1.0,
    1.0,
    1.0 / DEG_PER_RAD,
    1.0 / DEG_PER_RAD,
    1.0 / DEG_PER_RAD,
];

/// Names of the axes as owners of parameters.
pub(crate) const AXIS_OWNERS: [&str; AXES] = ["axis X", "axis Y", "axis Z", "axis A", "axis B", "axis C"];

/// How far outside its travel an axis may be by rounding, in units of the machine file (mathematics 0.2).
const TOLERANCE: f64 = 1e-9;

/// Limits of one axis as the machine file has them (mm or degrees).
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

/// Limits of one axis (mm, rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Lowest position.
    pub min: f64,
    /// Highest position.
    pub max: f64,
    /// Highest speed.
    pub velocity: f64,
    /// Highest acceleration.
    pub acceleration: f64,
    /// Highest jerk.
    pub jerk: f64,
    /// By how much `min` and `max` may be passed.
    tolerance: f64,
}

impl AxisLimits {
    /// Limits of axis number `axis` of X Y Z A B C; refuses a travel that is empty and limits that are not
    /// positive.
    pub fn build(axis: usize, config: &AxisConfig) -> Result<Self, ParameterError> {
        let (owner, unit) = (AXIS_OWNERS[axis], AXIS_UNIT[axis]);
        let min = check(owner, "travel_min", config.travel_min, |_| true)?;
        Ok(Self {
            min: min * unit,
            max: check(owner, "travel_max", config.travel_max, |max| max > min)? * unit,
            velocity: positive(owner, "max_velocity", config.max_velocity)? * unit,
            acceleration: positive(owner, "max_acceleration", config.max_acceleration)? * unit,
            jerk: positive(owner, "max_jerk", config.max_jerk)? * unit,
            tolerance: TOLERANCE * unit,
        })
    }

    /// Of an axis that the machine does not have: it stands at 0, and limits no other.
    pub const NOT_FITTED: Self = Self {
        min: 0.0,
        max: 0.0,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        tolerance: TOLERANCE,
    };

    /// Whether `x` is within the travel; a value that is not a number is not.
    pub fn contains(&self, x: f64) -> bool {
        x >= self.min - self.tolerance && x <= self.max + self.tolerance
    }

    /// Limits of all axes, X Y Z A B C.
    pub fn build_all(configs: &[Option<AxisConfig>; AXES]) -> Result<[Self; AXES], ParameterError> {
        let mut limits = [Self::NOT_FITTED; AXES];
        for (axis, (limits, config)) in limits.iter_mut().zip(configs).enumerate() {
            if let Some(config) = config {
                *limits = Self::build(axis, config)?;
            }
        }
        Ok(limits)
    }
}

/// The axes of `q` outside their travel; a value that is not a number is outside.
pub fn violations(q: &[f64; AXES], limits: &[AxisLimits; AXES]) -> Bits {
    let mut outside = Bits::NONE;
    for (i, (&x, limit)) in q.iter().zip(limits).enumerate() {
        outside.set(i, !limit.contains(x));
    }
    outside
}

/// The highest path speed \[mm/s\] that the speeds of the axes allow where they move by `q_prime` = dq/ds,
/// and the axis that sets it (mathematics 0.3). Infinite where no axis moves.
pub fn feed_limit(q_prime: &[f64; AXES], limits: &[AxisLimits; AXES]) -> (f64, usize) {
    let mut lowest = (f64::INFINITY, 0);
    for (i, (rate, limit)) in q_prime.iter().zip(limits).enumerate() {
        let feed = limit.velocity / libm::fabs(*rate);
        if feed < lowest.0 {
            lowest = (feed, i);
        }
    }
    lowest
}
