//! What only emulated boards have: a monitor that acts on a board from outside, telemetry with the simulated machine's own
//! positions, and `cargo xtask weld` by default.

mod failures;
mod marks;
mod programs;
