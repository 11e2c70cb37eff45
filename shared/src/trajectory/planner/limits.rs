//! What the planner must never exceed.

use crate::io::AXES;

/// Limits of the axes and of the path, and the accuracy that the output filter is made for (mm, rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanLimits {
    /// Highest speed of each axis; infinite where there is none.
    pub velocity: [f64; AXES],
    /// Highest acceleration of each axis.
    pub acceleration: [f64; AXES],
    /// Highest jerk of each axis.
    pub jerk: [f64; AXES],
    /// Highest acceleration along the path \[mm/s²\].
    pub path_acceleration: f64,
    /// Highest jerk along the path \[mm/s³\].
    pub path_jerk: f64,
    /// Tolerance that most elements are programmed with \[mm\]: decides how long the output filter is.
    pub tolerance: f64,
}
