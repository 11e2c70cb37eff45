//! Programs of tests of a machine (circle, positions, pivots), which begin where it is homed.

use cam::path::{PathError, Planner};
use config::machine::MachineFile;
use nc::{NcError, Options, Program, interpret};
use std::sync::Arc;

/// The program `text` from where the machine is once it is homed.
///
/// # Errors
/// It makes no sense, or the machine cannot follow it.
pub(crate) fn program_from_home<E: From<NcError> + From<PathError>>(
    text: &str,
    machine: &MachineFile,
    planner: &Planner,
) -> Result<Program, E> {
    let from = machine.homed_axes();
    let options = Options {
        setup: Arc::new(planner.setup(&from)),
        ..Options::default()
    };
    let program = interpret(text, options)?;
    planner.program(&program, &from, None)?;
    Ok(program)
}
