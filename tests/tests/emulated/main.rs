//! Whole jobs on emulated boards. `cargo xtask test` builds what they need and runs them one after another.

mod machines;
mod outside;
mod pair;
mod process;
mod trouble;
mod weld_data;
mod welds;
