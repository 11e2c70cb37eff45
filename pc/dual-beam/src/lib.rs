//! Planning of welds at both feet of a rib, by a beam each: from drawn or taught seam curves to NC programs.

mod beams;
mod cut;
mod locate;
mod planning;
mod seam_curves;
mod smooth;
mod taught;

pub use beams::{Approach, closest_approach, slide_extension};
pub use cut::{Crossing, OtherSeam, Polyline, SmoothSeam};
pub use locate::{LocateError, Location, SeamPlace, locate, locate_symmetric};
pub use planning::{DualBeamPlan, PlanError, PlanOptions, PlannedPoint, plan_dual_beam, plan_taught};
pub use seam_curves::{SeamPoint, parse_main_curve, parse_other_curve, read_main_curve, read_other_curve};
pub use taught::{Deviations, Marked, TaughtSeamError, TaughtSeams};
