//! Whole jobs on emulated boards. `cargo xtask test` builds what they need and runs two at a time: a pair of boards keeps about
//! one core busy, and waits where a core is short.

mod machines;
mod outside;
mod pair;
mod process;
mod trouble;
mod weld_data;
mod welds;
