//! The command line of the PC's part of Seamwright.

// Writers that panic have no place beside a machine that moves: crate::console has others.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod cli;
pub mod console;
mod terminal;
