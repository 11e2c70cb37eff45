//! `seamwright weld`: the job.

use super::boards::{BoardArgs, exit_code};
use super::cameras::CameraArgs;
use super::{OUTSIDE, machine_for, read_program, slower, waits};
use crate::console::{errln, out, outln};
use crate::terminal::Operator;
use anyhow::{Context, Error, bail};
use cam::path::{Planner, check_constant_speed};
use clap::Args;
use config::machine::MachineFile;
use config::sentence;
use emulator::{JOB_VARIABLE, MACHINE_VARIABLE, SEAM_VARIABLE};
use host_link::spool::Spooling;
use job::{Job, JobError, Names, NoTeaching, Taught, Work, check_teaching};
use nc::{Options, Program, Wait};
use parts::PartFile;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use teach::write_points;
use world::{Deviation, DrawingError, SeamError, Surroundings, Workpiece, not_followed};

/// Names of the planned program and of the taught points in the report.
const PROGRAM: &str = "program.ngc";
const TAUGHT: &str = "taught.csv";

/// Weld: run a program on the machine and judge the result
///
/// A machine with a tracker follows the seam on two boards; every other machine needs the motion board only.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code: 0 if the weld is done and within its limits, 3 if it is outside them, \
    1 if it was refused or failed, 130 after Ctrl-C, SIGTERM or SIGHUP."
)]
pub struct Weld {
    /// NC program, or part file (*.toml) that a program is planned from; a panel is taught first
    #[arg(value_name = "JOB", env = JOB_VARIABLE, hide_env = true)]
    job: PathBuf,
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: PathBuf,
    /// Part file that the run is judged by [default: the one beside the program, of the same name]
    #[arg(long)]
    part: Option<PathBuf>,
    /// Deviation of the real seams (CSV), for programs that follow them
    #[arg(long, env = SEAM_VARIABLE, hide_env = true)]
    seam: Option<PathBuf>,
    /// Program planned from the drawing, from whose seams --seam deviates [default: JOB itself]
    #[arg(long, value_name = "DRAWING", requires = "seam")]
    seam_of: Option<PathBuf>,
    /// Speed of the weld in place of the programmed feed [m/min]
    #[arg(long, value_name = "M_PER_MIN", value_parser = speed, allow_negative_numbers = true)]
    speed: Option<f64>,
    #[command(flatten)]
    boards: BoardArgs,
    #[command(flatten)]
    cameras: CameraArgs,
    /// Where report.json, log.csv and the plots go, the program planned from a part, and taught points
    #[arg(long, value_name = "DIR", default_value = "report")]
    report: PathBuf,
    /// Start of the noise of simulated cameras and probes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Weld data that the program calls with WELDON [default: welddata.toml beside the program]
    #[arg(long, value_name = "FILE")]
    weld_data: Option<PathBuf>,
    /// Leave out blocks that start with /
    #[arg(long)]
    block_delete: bool,
    /// Stop at M1 as at M0
    #[arg(long)]
    optional_stop: bool,
    /// Wait after every block of the program until the operator continues
    #[arg(long)]
    single_block: bool,
    /// Start at this line of the program (its first motion in or after it); no part but a seam is judged then
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "part")]
    from_line: Option<u32>,
}

/// A speed that makes sense \[m/min\].
pub(super) fn speed(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(speed) if f64::is_finite(speed) && speed > 0.0 => Ok(speed),
        _ => Err("must be a number of m/min above 0"),
    }
}

/// What the job is.
enum Task {
    /// A program and its file.
    Program(PathBuf, Program),
    /// A panel that has to be taught first.
    Panel,
}

impl Weld {
    /// Checks everything that can be checked without boards, then runs the job; prints the table and writes the
    /// report even if the job ended early.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = machine_for(&self.machine, &self.job, self.weld_data.as_deref())?;
        self.boards.check(&machine)?;
        let (task, mut part) = self.task(&machine)?;
        let judged = part.is_some();
        if self.from_line.is_some() {
            if matches!(task, Task::Panel) {
                bail!("--from-line needs a program, and a panel is taught before there is one");
            }
            // Of a seam what is programmed from there on is judged; every other part is judged as a whole.
            part = part.filter(|part| part.t_seam().is_some());
        }
        let seam = self
            .seam
            .as_deref()
            .map(Deviation::read)
            .transpose()?
            .map(Arc::new);
        let drawing = match &self.seam_of {
            Some(file) => Some(read_program(file, &machine, self.options())?),
            None => None,
        };
        let cameras = self
            .cameras
            .choose(&machine, &self.machine, &self.boards.choice)?;
        let name = |path: &Path| path.display().to_string();
        let job = Job {
            machine: &machine,
            work: match &task {
                Task::Program(_, program) => Work::Program(program),
                Task::Panel => Work::TeachAndMake,
            },
            part: part.as_ref(),
            speed_m_per_min: self.speed,
            from_line: self.from_line,
            surroundings: Surroundings {
                seam: seam.clone(),
                drawing: drawing.map(Arc::new),
                cameras: cameras.clone(),
                seed: self.seed,
                truth: self.boards.truth(&machine)?,
                work: Workpiece::Seams,
            }
            .into(),
            spooling: Spooling::in_folder(&self.report),
            names: Names {
                program: match (&task, self.from_line) {
                    (Task::Program(file, _), None) => name(file),
                    (Task::Program(file, _), Some(line)) => format!("{} from line {line}", file.display()),
                    (Task::Panel, _) => name(&self.job),
                },
                machine: name(&self.machine),
                seam: self.seam.as_deref().map(name),
                boards: self.boards.name(),
            },
        };
        self.check(&job, judged, seam.as_deref())?;
        report::prepare(&self.report)?;
        let keepers = self.cameras.keep(&cameras)?;
        let operator = Operator::SaysWords {
            single_block: self.single_block,
            stops: matches!(&task, Task::Program(_, program) if program.waits().any(Wait::is_for_operator)),
        };
        let ended = match self.boards.run(&job, operator, Some(&self.report))? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        keepers.end();
        let taught = self.write_taught(&ended.taught);
        let report = || report::write(&self.report, &ended);
        let report = if ended.began {
            report().map_err(Error::from)
        } else {
            Ok(())
        };
        let written = taught.and(report);
        if ended.began {
            out!("{}", ended.report);
        }
        if let Err(unwritten) = written {
            if let Some(error) = ended.error {
                errln!("seamwright: {}", sentence(&error));
            }
            return Err(unwritten);
        }
        if ended.began {
            outln!("  report in {}", self.report.display());
        }
        for limit in &ended.report.not_judged {
            errln!("seamwright: not judged: {limit}");
        }
        if ended.error.is_none()
            && let Some(outside) = report::verdict(&ended.report)
        {
            errln!("seamwright: {outside}");
            return Ok(ExitCode::from(OUTSIDE));
        }
        exit_code(ended.error)
    }

    /// The operator's choices.
    fn options(&self) -> Options {
        Options {
            block_delete: self.block_delete,
            optional_stop: self.optional_stop,
            ..Options::default()
        }
    }

    /// What to do, and the part to judge it by.
    fn task(&self, machine: &MachineFile) -> anyhow::Result<(Task, Option<PartFile>)> {
        let told = self.part.as_deref().map(PartFile::read).transpose()?;
        let program = |file: PathBuf| -> anyhow::Result<Task> {
            let program = read_program(&file, machine, self.options())?;
            Ok(Task::Program(file, program))
        };
        if self.job.extension().is_none_or(|extension| extension != "toml") {
            let part = match told {
                Some(part) => Some(part),
                None => PartFile::of_program(&self.job)?,
            };
            return Ok((program(self.job.clone())?, part));
        }
        let part = PartFile::read(&self.job)?;
        if part.untaught().is_some() {
            return Ok((Task::Panel, Some(part)));
        }
        let title = self.job.file_stem().unwrap_or_default().to_string_lossy();
        let plan = part
            .plan(machine, &title)
            .with_context(|| format!("part {}", self.job.display()))?;
        report::prepare(&self.report)?;
        let file = self.report.join(PROGRAM);
        write(&file, &plan.program)?;
        told_of(&file, &plan.notes);
        Ok((program(file)?, Some(told.unwrap_or(part))))
    }

    /// Writes what was taught on the way.
    fn write_taught(&self, taught: &Taught) -> anyhow::Result<()> {
        if !taught.points.is_empty() {
            write(&self.report.join(TAUGHT), &write_points(&taught.points))?;
        }
        if let Some(program) = &taught.program {
            let file = self.report.join(PROGRAM);
            write(&file, program)?;
            told_of(&file, &taught.notes);
        }
        Ok(())
    }

    /// What the operator has to be there for, and which tool has to be in the machine at a line in the middle.
    fn tell_waits(&self, program: &Program) {
        if let Some(waits) = waits::told(program, self.from_line.unwrap_or(0)) {
            errln!("seamwright: the program {waits}");
        }
        if let Some(line) = self.from_line
            && let Some(tool) = program.changed_tool_at(line)
        {
            errln!("seamwright: from line {line}: tool {tool} must be in the machine");
        }
    }

    /// Whether the machine can run the program and the slides reach the seam, from the park position. The boards
    /// are asked to move only if so. The speed must be constant with a beam on if a part is `judged` by it, also where a job
    /// that is started at a line is not.
    fn check(&self, job: &Job, judged: bool, seam: Option<&Deviation>) -> anyhow::Result<()> {
        let planner = Planner::build(job.machine)
            .with_context(|| format!("machine file {}", self.machine.display()))?;
        let program = match (job.work, job.part) {
            (Work::Program(program), _) => program,
            (Work::Teach | Work::TeachAndMake, Some(part)) => {
                let note = check_teaching(job.machine, part)
                    .with_context(|| format!("part {}", self.job.display()))?;
                if let Some(note) = note {
                    errln!("seamwright: part {}: {note}", self.job.display());
                }
                return Ok(());
            }
            (Work::Pictures(run), _) => run.program,
            (Work::Mark(run), _) => run.program,
            (Work::Teach | Work::TeachAndMake, None) => return Err(NoTeaching::Part.into()),
            (Work::TeachSeam(_) | Work::Lead(_) | Work::Excite(_) | Work::ByHand, _) => return Ok(()),
        };
        let planned = job.plan(program, &planner, &job.machine.planning.park_axes());
        let around = match &planned {
            Err(JobError::Surroundings(around)) => Some(around),
            _ => None,
        };
        let of_seam = |error: &SeamError| {
            matches!(
                error,
                SeamError::TooShort { .. } | SeamError::Elsewhere { .. } | SeamError::Reach { .. }
            )
        };
        let owner = match (around, &self.seam) {
            (Some(around), _) if around.is::<DrawingError>() => "--seam-of".to_owned(),
            (Some(around), Some(seam)) if around.downcast_ref().is_some_and(of_seam) => {
                format!("seam {}", seam.display())
            }
            _ => format!("program {}", job.names.program),
        };
        let paths = planned.with_context(|| owner.clone())?;
        check_constant_speed(&paths, judged).context(owner)?;
        if let Some(part) = job.part {
            part.check_judging(job.machine, planner.kinematics())
                .with_context(|| format!("part {}", part.path().display()))?;
        }
        slower(&paths).for_each(|found| errln!("seamwright: warning: {found}"));
        self.tell_waits(program);
        if self.seam_of.is_none() && self.cameras.pictures() {
            for found in not_followed(&paths, job.machine, seam)? {
                errln!("seamwright: warning: {found}");
            }
        }
        Ok(())
    }
}

/// Writes a file of the report.
fn write(file: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(file, text).with_context(|| format!("cannot write {}", file.display()))
}

/// Tells of a planned program.
fn told_of(file: &Path, notes: &[String]) {
    outln!("{}:", file.display());
    for note in notes {
        outln!("  {note}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_positive_numbers() {
        assert_eq!(speed("7.5"), Ok(7.5));
        for wrong in ["0", "-1", "fast", "NaN", "inf"] {
            assert!(speed(wrong).is_err(), "{wrong}");
        }
    }
}
