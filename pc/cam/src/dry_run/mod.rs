//! Prediction of a program's run by the planner of the motion board, without boards.
//!
//! The same code in the same size as on the board plans the speed ([`shared::trajectory::BoardPlanner`]), it is given
//! elements as the board is, in batches and no more than it has room for, and its outputs are looked at as any
//! outputs would be: by differences of positions a millisecond apart.

mod around;
mod differences;
mod error;
mod figures;
mod forecast;
mod run;
mod slowed;
mod stream;
mod table;
#[cfg(test)]
mod tests;
mod trace;

pub use error::DryRunError;
pub use figures::{DryRun, Highest, PathFigures, Peak, Peaks, QUANTITIES, Ruled, Stop};
pub use forecast::{Forecast, forecast};
pub use slowed::{Slowed, SlowedDown};
pub use table::{row_name, unit};
pub use trace::{Bin, Envelope, Trace};

use crate::path::{PlannedPath, Planner};
use config::machine::MachineFile;
use run::Runner;
use shared::io::AXES;

/// Rows of figures: the path, then the axes.
pub const ROWS: usize = 1 + AXES;
/// Row of the path.
pub const PATH: usize = 0;

/// Runs `paths`, which `planner` planned for `machine` from [`MachineFile::homed_axes`], and parks, as a weld does; at
/// the feed override `factor`, 0 < `factor` ≤ 2.
///
/// # Errors
/// Whatever keeps the planner from running a path, with its line.
pub fn run(
    machine: &MachineFile,
    planner: &Planner,
    paths: &[PlannedPath],
    factor: f64,
) -> Result<DryRun, DryRunError> {
    let mut runner = Runner::new(machine, &machine.homed_axes(), factor)?;
    for path in paths {
        runner.run(path, false)?;
    }
    for path in planner.park(&runner.axes())? {
        runner.run(&path, true)?;
    }
    Ok(runner.finish())
}

/// Time that the motion board is on `paths` in a row \[s\], at the programmed feed.
///
/// # Errors
/// Whatever keeps the planner from running a path, with its line.
pub fn motion_s<'a>(
    machine: &MachineFile,
    paths: impl IntoIterator<Item = &'a PlannedPath>,
) -> Result<f64, DryRunError> {
    let mut runner = Runner::new(machine, &machine.homed_axes(), 1.0)?;
    for path in paths {
        runner.run(path, false)?;
    }
    Ok(runner.finish().motion_s)
}
