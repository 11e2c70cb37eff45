//! Programs of canonical segments, and free-form curves, through the trajectory planner, and what the axes did. On the PC only.
//!
//! The planner is called as on the board: a tick a millisecond, elements as the link brings them. Everything is
//! judged by the positions that come out, and by the program as it was written.

pub mod baseline;
mod contour;
pub mod curves;
pub mod elements;
pub mod evenness;
pub mod free_form;
pub mod limits;
mod metrics;
mod nurbs;
mod outcome;
pub mod run;
pub mod seg;
mod spiral;
#[cfg(test)]
mod testing;
pub mod way;

pub use contour::{Contour, Nearest, cut_off};
pub use metrics::Figures;
pub use nurbs::FreeForm;
pub use outcome::{Outcome, of_file};
pub use spiral::{Spiral, SpiralError};

/// A tick \[s\].
pub const TICK: f64 = shared::ticks::PATH_PERIOD_S;
