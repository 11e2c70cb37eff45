//! Planning: from seam curves to NC programs.

mod beams;
mod cut;
mod dual_beam;
mod locate;
mod smooth;
mod taught;

pub use beams::{Approach, closest_approach, slide_extension};
pub use cut::{Crossing, OtherSeam, Polyline, SmoothSeam};
pub use dual_beam::{DualBeamPlan, PlanError, PlanOptions, PlannedPoint, plan_dual_beam};
pub use locate::{LocateError, Location, SeamPlace, locate, locate_symmetric};
pub use taught::{Deviations, TaughtSeamError, TaughtSeams};

use config::machine::PlanningConfig;

/// Length that a feed path takes to reach `velocity` \[mm/s\] from rest \[mm\].
pub(crate) fn speed_up_length(planning: &PlanningConfig, velocity: f64) -> f64 {
    let (a, j) = (planning.path_acceleration_mm_s2, planning.path_jerk_mm_s3);
    // Without constant acceleration in between if a is never reached.
    let time = if velocity * j > a * a {
        velocity / a + a / j
    } else {
        2.0 * libm::sqrt(velocity / j)
    };
    velocity / 2.0 * time
}
