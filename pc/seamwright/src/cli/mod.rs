//! The command line: one file for each command.

mod boards;
mod calibrate;
mod cameras;
mod check;
mod circle;
mod commission;
mod dry_run;
mod explain;
mod jog;
mod measure;
mod pivots;
mod plan;
mod positioning;
mod probe;
mod teach;
mod teach_places;
mod teach_seam;
mod waits;
mod weld;

use crate::console::errln;
use anyhow::{Context, bail};
use cam::path::{PlannedPath, Planner, check_constant_speed};
use clap::{Parser, Subcommand};
use config::machine::MachineFile;
use config::weld_data::WeldData;
use nc::{NcError, Options, Program, Setup, interpret_file};
use parts::PartFile;
use shared::io::AXES;
use std::fs::File;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Plans, checks and welds with a seam-following machine.
#[derive(Debug, Parser)]
#[command(name = "seamwright", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Calibrate(calibrate::Calibrate),
    Check(check::Check),
    Circle(circle::Circle),
    Commission(commission::Commission),
    DryRun(dry_run::DryRun),
    Jog(jog::JogCommand),
    Measure(measure::Measure),
    Pivots(pivots::Pivots),
    Plan(plan::Plan),
    Positioning(positioning::PositioningCommand),
    Probe(probe::Probe),
    Teach(teach::Teach),
    Weld(weld::Weld),
}

impl Cli {
    /// Does what was asked; an error reads as one sentence.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self.command {
            Command::Calibrate(command) => command.run(),
            Command::Check(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::Circle(command) => command.run(),
            Command::Commission(command) => command.run(),
            Command::DryRun(command) => command.run(),
            Command::Jog(command) => command.run(),
            Command::Measure(command) => command.run(),
            Command::Pivots(command) => command.run(),
            Command::Plan(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::Positioning(command) => command.run(),
            Command::Probe(command) => command.run(),
            Command::Teach(command) => command.run(),
            Command::Weld(command) => command.run(),
        }
    }
}

/// Exit code of what is outside its limits.
const OUTSIDE: u8 = 3;

/// A rest that makes sense.
fn dwell(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(seconds) if (0.1..=60.0).contains(&seconds) => Ok(seconds),
        _ => Err("must be a number of seconds from 0.1 to 60"),
    }
}

/// A number that is above 0, of an option.
fn above_0(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok();
    let value = value.filter(|value| value.is_finite() && *value > 0.0);
    value.ok_or_else(|| "must be a number above 0".to_owned())
}

/// Reads the NC program in a file for a machine that stands at its reference marks, by the operator's choices among `options`,
/// and says what a person should know of how it is understood. Subroutines in files of their own stand beside it.
fn read_program(path: &Path, machine: &MachineFile, options: Options) -> anyhow::Result<Program> {
    read_program_by(path, machine, options, interpret_file)
}

/// The same with `read`, which is [`interpret_file`] or does more on the way.
fn read_program_by(
    path: &Path,
    machine: &MachineFile,
    options: Options,
    read: impl FnOnce(File, Options) -> Result<Program, NcError>,
) -> anyhow::Result<Program> {
    let name = path.display();
    if path.extension().is_some_and(|extension| extension == "toml") {
        bail!(
            "{name} is a part file, not a program: plan it with seamwright plan {name} --machine FILE -o PROGRAM.ngc"
        );
    }
    let file = File::open(path).with_context(|| format!("cannot read program {name}"))?;
    let planner = Planner::build(machine).with_context(|| format!("machine {}", machine.name))?;
    let setup = Setup {
        folders: path.parent().map(Path::to_owned).into_iter().collect(),
        ..planner.setup(&machine.homed_axes())
    };
    let options = Options {
        setup: Arc::new(setup),
        ..options
    };
    let program = read(file, options).with_context(|| format!("program {name}"))?;
    for notice in &program.notices {
        errln!("program {name}: {}: {}", notice.place, notice.text);
    }
    for notice in planner.notices(&program) {
        errln!("program {name}: {notice}");
    }
    Ok(program)
}

/// The machine in `file`, with the weld data beside `program`, or in `weld_data` if it is said.
fn machine_for(file: &Path, program: &Path, weld_data: Option<&Path>) -> anyhow::Result<MachineFile> {
    let mut machine = MachineFile::read(file)?;
    machine.welding = match weld_data {
        Some(weld_data) => WeldData::read(weld_data)?,
        None => WeldData::beside(program)?,
    };
    Ok(machine)
}

/// The paths of a program by `planner`, from where the axes stand at `from` (mm, degrees). The part file beside it, if there is
/// one, asks for a constant speed with a beam on, as in a weld.
fn plan_program(
    file: &Path,
    program: &Program,
    planner: &Planner,
    from: &[f64; AXES],
    speed_m_min: Option<f64>,
) -> anyhow::Result<Vec<PlannedPath>> {
    let part = PartFile::of_program(file)?;
    let judged = part.is_some_and(|part| part.keeps_feed());
    let speed = speed_m_min.map(|m_min| m_min * shared::units::MM_S_PER_M_MIN);
    let of_program = || format!("program {}", file.display());
    let paths = planner.program(program, from, speed).with_context(of_program)?;
    check_constant_speed(&paths, judged).with_context(of_program)?;
    Ok(paths)
}

/// What a person should know of feeds that are more than the machine can do, a sentence a path.
fn slower(paths: &[PlannedPath]) -> impl Iterator<Item = String> {
    let found = paths.iter().filter_map(|path| path.too_fast.anywhere.as_ref());
    found.map(|found| format!("{found}: the machine slows down where it must"))
}
