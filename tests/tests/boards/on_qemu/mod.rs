//! What only emulated boards have: a monitor that acts on a board from outside, telemetry with the simulated machine's own
//! positions, an input for a ranging probe, and `cargo xtask weld` by default.

mod by_hand;
mod failures;
mod long;
mod marks;
mod panel;
mod programs;
