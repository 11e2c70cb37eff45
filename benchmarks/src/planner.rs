//! The planner of the motion board, call by call, on programs that are made here: so on the PC and on the board.

mod programs;
#[cfg(test)]
mod tests;

use crate::Failure;
use crate::machine::machines;
use crate::meter::Meter;
use crate::record::{Checksum, NOTHING, Record};

use core::fmt;
use core::hint::black_box;
use programs::{PROGRAMS, Program};
use shared::kinematics::Kinematics;
use shared::trajectory::BoardPlanner;

/// The machine whose kinematics and limits are used.
const MACHINE: &str = "dual-beam-gantry";
/// Elements that come over the link in a tick at most.
const CREDITS: usize = 8;
/// Ticks after which a program is stuck.
const PATIENCE: usize = 60_000;

/// The functions that are counted: adding an element, and a tick.
pub const FUNCTIONS: [&str; 2] = ["push", "tick"];

/// Runs every program to its end, and prints what each call took; before each program what counting itself costs.
pub(crate) fn run(
    file: &[u8],
    meter: &mut impl Meter,
    console: &mut impl fmt::Write,
    planner: &mut BoardPlanner,
) -> Result<(), Failure> {
    let mut machines = machines(file).filter_map(Result::ok);
    let machine = machines
        .find(|machine| machine.kinematics.name() == MACHINE)
        .ok_or(Failure::NoMachine(MACHINE))?;
    let (kinematics, limits) = machine.build()?;
    let mut checksum = Checksum::new();
    for program in &PROGRAMS {
        let start = program.start(&kinematics).ok_or(Failure::Stuck(program.name))?;
        planner.start(&program.limits(&limits), program.space, 0.0, &start);
        drive(program, &kinematics, planner, meter, console, &mut checksum)?;
    }
    writeln!(console, "{}", Record::Checksum(checksum.sum()))?;
    Ok(())
}

/// Runs a program to its end; the planner stands at its beginning.
fn drive(
    program: &Program,
    kinematics: &Kinematics,
    planner: &mut BoardPlanner,
    meter: &mut impl Meter,
    console: &mut impl fmt::Write,
    checksum: &mut Checksum,
) -> Result<(), Failure> {
    let subject = program.name;
    let mut tell = |function, instructions| {
        let record = Record::Call {
            subject,
            function,
            instructions,
        };
        writeln!(console, "{record}")
    };
    tell(NOTHING, meter.count(black_box(&mut || {})))?;
    let mut next = 0;
    for _ in 0..PATIENCE {
        for _ in 0..CREDITS.min(planner.room()).min(program.elements - next) {
            let mut element = program.element(kinematics, next);
            let mut result = None;
            let count = meter.count(&mut || result = element.take().map(|element| planner.push(element)));
            result.ok_or(Failure::Stuck(subject))??;
            tell(FUNCTIONS[0], count)?;
            next += 1;
        }
        let mut output = None;
        let count = meter.count(&mut || output = Some(planner.tick(kinematics)));
        let output = black_box(output).ok_or(Failure::Stuck(subject))??;
        tell(FUNCTIONS[1], count)?;
        output.axes.position.iter().for_each(|x| checksum.add(*x));
        if next == program.elements && output.at_rest {
            return Ok(());
        }
    }
    Err(Failure::Stuck(subject))
}
