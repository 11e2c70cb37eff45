//! Planning of welds at both feet of a rib: from drawn or taught seam curves to NC programs. Other kinds of parts plan their own.

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
