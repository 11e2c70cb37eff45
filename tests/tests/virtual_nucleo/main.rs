//! Jobs on the model of the real board: a selection of those on emulated boards. `cargo xtask test --boards virtual-nucleo`
//! builds what they need.
//!
//! The model has no monitor, so what the emulated suite does to boards from outside is not here.

mod at_rest;
mod jobs;
mod pair;
