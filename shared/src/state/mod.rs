//! States and faults of both boards: what the controllers are in, and what everybody else is told of it.

mod fault;
mod motion;
mod tracker;

pub use fault::{Fault, NoPermit};
pub use motion::{Event, State};
pub use tracker::{TrackerFault, TrackerState};
