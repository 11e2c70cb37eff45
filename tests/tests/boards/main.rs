//! Whole jobs on boards that run the firmware: emulated ones, or the model of the real one. `cargo xtask test`, and the same with
//! `--boards virtual-nucleo`, builds what they need and runs three at a time: a pair of boards keeps about one core busy in
//! real time, and waits where a core is short.

mod by_hand;
mod machines;
mod model;
mod on_model;
mod on_qemu;
mod outside;
mod pair;
mod process;
mod trouble;
mod weld_data;
mod welds;
