//! States and faults of both boards, as the controllers use and report them.

mod fault;
mod motion;
mod tracker;

pub use fault::{Fault, NoPermit};
pub use motion::{Event, State};
pub use tracker::{TrackerFault, TrackerState};
