//! What the runs are held to.

use shared::io::AXES;
use shared::trajectory::PlanLimits;

/// Acceleration along the path is not limited.
const LARGE: f64 = 1e9;
/// Accuracy of the path \[mm\].
pub const TOLERANCE: f64 = 0.05;

/// Limits of every axis. Speed is limited by the feed only, acceleration along the path by that of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Acceleration of a linear axis \[mm/s²\], and of a rotary one \[°/s²\].
    acceleration: f64,
    /// Jerk of the path and of a linear axis \[mm/s³\], and of a rotary one \[°/s³\].
    jerk: f64,
}

/// Full acceleration in 10 ms from rest: of the programs that another planner ran too.
pub const QUICK: Limits = Limits {
    acceleration: 2000.0,
    jerk: 200_000.0,
};

/// In 50 ms, as the shipped machines.
pub const HEAVY: Limits = Limits {
    acceleration: 1000.0,
    jerk: 20_000.0,
};

/// Whether the axis is one of X Y Z.
pub fn is_linear(axis: usize) -> bool {
    axis < 3
}

/// Degrees as radians, of a rotary axis.
fn of_axis(limit: f64, linear: bool) -> f64 {
    if linear { limit } else { limit.to_radians() }
}

impl Limits {
    /// Acceleration of an axis (mm/s² or rad/s²).
    pub fn acceleration(&self, linear: bool) -> f64 {
        of_axis(self.acceleration, linear)
    }

    /// Jerk of an axis (mm/s³ or rad/s³).
    pub fn jerk(&self, linear: bool) -> f64 {
        of_axis(self.jerk, linear)
    }

    /// Jerk of the path \[mm/s³\].
    pub fn path_jerk(&self) -> f64 {
        self.jerk
    }

    /// By how much longer a way takes at `speed` \[mm/s\] if it begins and ends at rest \[s\].
    pub fn start_and_stop(&self, speed: f64) -> f64 {
        if speed * self.jerk > self.acceleration * self.acceleration {
            speed / self.acceleration + self.acceleration / self.jerk
        } else {
            2.0 * (speed / self.jerk).sqrt()
        }
    }

    /// For the planner.
    pub fn plan_limits(&self) -> PlanLimits {
        PlanLimits {
            velocity: [f64::INFINITY; AXES],
            acceleration: std::array::from_fn(|axis| self.acceleration(is_linear(axis))),
            jerk: std::array::from_fn(|axis| self.jerk(is_linear(axis))),
            path_acceleration: LARGE,
            path_jerk: self.path_jerk(),
            tolerance: TOLERANCE,
        }
    }
}
