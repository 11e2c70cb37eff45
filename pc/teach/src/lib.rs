//! Teaching by ranging: the normal of a surface from distances to it on a small circle (mathematics 2).
//!
//! Everything is in the frame of the probe: Z against its beam (from the surface to the probe), the centre of the
//! ring at the origin. What is measured there has to be turned into the work frame with the probe's attitude.
//!
//! Teaching by cameras, for seams that can be seen, is in [`seam`]. Places to which an operator leads the tip are
//! [`TipPoint`]s.

mod halving;
mod kept;
mod lead;
mod points;
mod ring;
mod routine;
pub mod seam;
mod spoken;
mod tip_points;
mod triples;

pub use halving::{Halving, HalvingConfig, HalvingError, StopRule, Taught};
pub use lead::{LEAD_WORDS, LedMachine, lead};
pub use points::{TaughtPoint, parse_points, read_points, write_points};
pub use ring::{Curvature, Harmonics, Plane, Ring, RingError, Unsmooth};
pub use routine::{GuidePoint, Look, PointError, ProbeMachine, TeachError, Teacher, TeachingConfig, aim};
pub use tip_points::{TipFile, TipPoint, parse_tip_points, read_tip_points, write_tip_points};
pub use triples::Triples;

#[cfg(test)]
mod tests;
