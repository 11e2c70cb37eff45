//! What the runs are held to.

use shared::io::AXES;
use shared::trajectory::PlanLimits;

/// Acceleration of a linear axis \[mm/s²\], and of a rotary one \[°/s²\].
const ACCELERATION: f64 = 2000.0;
/// Jerk of a linear axis \[mm/s³\], and of a rotary one \[°/s³\].
const JERK: f64 = 200_000.0;
/// Jerk of the path \[mm/s³\].
pub const PATH_JERK: f64 = 200_000.0;
/// Acceleration along the path is not limited.
const LARGE: f64 = 1e9;
/// Accuracy of the path \[mm\].
pub const TOLERANCE: f64 = 0.05;

/// Whether the axis is one of X Y Z.
pub fn is_linear(axis: usize) -> bool {
    axis < 3
}

/// Acceleration of an axis (mm/s² or rad/s²).
pub fn acceleration(linear: bool) -> f64 {
    if linear {
        ACCELERATION
    } else {
        ACCELERATION.to_radians()
    }
}

/// Jerk of an axis (mm/s³ or rad/s³).
pub fn jerk(linear: bool) -> f64 {
    if linear { JERK } else { JERK.to_radians() }
}

/// For the planner. Speed is limited by the feed only, acceleration along the path by that of the axes.
pub fn plan_limits() -> PlanLimits {
    PlanLimits {
        velocity: [f64::INFINITY; AXES],
        acceleration: std::array::from_fn(|axis| acceleration(is_linear(axis))),
        jerk: std::array::from_fn(|axis| jerk(is_linear(axis))),
        path_acceleration: LARGE,
        path_jerk: PATH_JERK,
        tolerance: TOLERANCE,
    }
}
