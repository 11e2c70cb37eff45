//! Following the seam: from captures to the velocity of the slides.

pub mod clock;
mod controller;
pub mod frames;
pub mod gain;
pub mod history;
pub mod law;
pub mod map;
pub mod parameters;
pub mod plausible;
mod seam;
pub mod search;
mod sensible;
pub mod supervision;

pub use controller::{TickInput, TickOutput, TrackerController};
