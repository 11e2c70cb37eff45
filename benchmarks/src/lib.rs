//! What is counted, and how: the same calls with the same data on the PC (under callgrind) and on the emulated
//! Cortex-M7.
//!
//! The programs of both read the machines from one [file](machine) and print [`Record`](record::Record)s. `cargo
//! xtask bench` writes that file, runs both programs and makes the table.
#![cfg_attr(target_os = "none", no_std)]

pub mod kinematics;
pub mod machine;
#[cfg(not(target_os = "none"))]
pub mod machine_files;
pub mod meter;
pub mod planner;
mod random;
pub mod record;
#[cfg(not(target_os = "none"))]
pub mod trajectories;
#[cfg(not(target_os = "none"))]
pub mod vision;

use core::ffi::CStr;
use machine::Unreadable;
use shared::trajectory::BoardPlanner;
use thiserror::Error;

/// On the emulated board an instruction takes 2^this ns.
pub const SHIFT: u32 = 10;

/// The file that both programs read the machines from, in the folder they run in.
pub const MACHINES_FILE: &CStr = c"machines.postcard";

/// Why a benchmark was not run to its end.
#[derive(Debug, Error)]
pub enum Failure {
    /// No benchmark is called so.
    #[error("there is no such benchmark; kinematics and planner are some")]
    Unknown,
    /// The machines cannot be read.
    #[error(transparent)]
    Machines(#[from] Unreadable),
    /// A machine cannot be built.
    #[error("a machine of the file cannot be built: {0}")]
    Parameter(#[from] shared::parameter::ParameterError),
    /// A machine has next to no regular poses inside its travel.
    #[error("{0}: no regular pose was found inside the travel")]
    NoPose(&'static str),
    /// The machine is not among those of the file.
    #[error("{0} is not in the file of machines")]
    NoMachine(&'static str),
    /// The planner has refused an element.
    #[error("the planner has refused an element: {0}")]
    Push(#[from] shared::trajectory::PushError),
    /// The planner has given no output.
    #[error("the planner has given no output: {0}")]
    Tick(#[from] shared::trajectory::Unreachable),
    /// A program cannot be made, or does not come to its end.
    #[error("the program {0} does not come to its end")]
    Stuck(&'static str),
    /// Printing failed.
    #[error("the results cannot be printed")]
    Print(#[from] core::fmt::Error),
}

/// Runs the benchmark called `name` over the machines in `file`, counts by `meter` and prints records to `console`.
/// `planner` is too large for the stack of a board.
pub fn run(
    name: &str,
    file: &[u8],
    meter: &mut impl meter::Meter,
    console: &mut impl core::fmt::Write,
    planner: &mut BoardPlanner,
) -> Result<(), Failure> {
    match name {
        "kinematics" => kinematics::run(file, meter, console),
        "planner" => planner::run(file, meter, console, planner),
        _ => Err(Failure::Unknown),
    }
}
