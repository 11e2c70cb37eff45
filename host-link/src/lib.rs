//! How a PC speaks with the boards of a machine: connections, clocks, what they tell, and how a job is driven and watched.

pub mod boards;
pub mod clock;
mod control;
pub mod events;
pub mod geometry;
pub mod record;

pub use control::{Command, CommandError, Control, Remote, control};
