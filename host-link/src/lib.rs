//! How a PC speaks with the boards of a machine: connections, clocks, and what they tell.

pub mod boards;
pub mod clock;
pub mod geometry;
pub mod record;
