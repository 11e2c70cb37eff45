//! The tracker board's controller against the slides' model, a path and a seam.

mod bench;
mod following;
mod jog;
mod parameters;
mod searching;
mod states;
