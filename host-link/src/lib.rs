//! The PC's part of Seamwright: programs, planning, sessions with the boards, reports.

// Writers that panic have no place beside a machine that moves: crate::console has others.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod boards;
pub mod cli;
pub mod console;
pub mod evaluate;
pub mod part;
pub mod plan;
pub mod record;
pub mod report;
pub mod seam;
pub mod unwelded;
pub mod weld;
pub mod welded;
pub mod world;
