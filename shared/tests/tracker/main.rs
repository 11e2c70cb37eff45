//! The tracker board's controller against the slides' model, a path and a seam.

mod bench;
mod clock;
mod estop;
mod following;
mod forged;
mod jog;
mod one_side;
mod parameters;
mod permits;
mod searching;
mod states;
mod supervision;
