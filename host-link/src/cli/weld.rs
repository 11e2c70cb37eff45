//! `host-link weld`: the job.

use super::read_program;
use crate::boards::simulated::SimulatedBoards;
use crate::boards::{Boards, Endpoint, LinkError, NetworkBoards, Patience};
use crate::machine::MachineFile;
use crate::part::PartFile;
use crate::path::Planner;
use crate::report::{self, Report};
use crate::seam::{Deviation, SeamError};
use crate::weld::{Job, JobError, Names, Terminal, run};
use anyhow::{Context, bail};
use clap::Args;
use emulator::{JOB_VARIABLE, MACHINE_VARIABLE, SEAM_VARIABLE, SESSION_VARIABLE, Session};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Exit code of a weld that is outside the limits of its part.
const OUTSIDE: u8 = 3;
/// Exit code after Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;
/// How often Ctrl-C is looked for while the boards are connected.
const POLL: Duration = Duration::from_millis(20);

/// Weld: run a program on the machine and judge what came of it
///
/// A machine with a tracker follows the seam on two boards; every other machine needs the motion board only.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code: 0 if the weld is done and within its limits, 3 if it is outside them, \
    1 if it was refused or failed, 130 after Ctrl-C."
)]
pub struct Weld {
    /// NC program, or part file (*.toml) that a program is planned from
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
    /// Speed of the weld in place of the programmed feed [m/min]
    #[arg(long, value_name = "M_PER_MIN", value_parser = speed, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// emulated, simulated, or the addresses of real boards: MOTION,TRACKER, or MOTION without a tracker
    #[arg(long, default_value = "emulated")]
    boards: BoardChoice,
    /// Where report.json, log.csv and the plots go, and the program planned from a part
    #[arg(long, value_name = "DIR", default_value = "report")]
    report: PathBuf,
    /// Start of the simulated cameras' noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Leave out blocks that start with /
    #[arg(long)]
    block_delete: bool,
}

/// Which boards.
#[derive(Clone, Debug, PartialEq, Eq)]
enum BoardChoice {
    Emulated,
    Simulated,
    At { motion: String, tracker: Option<String> },
}

impl FromStr for BoardChoice {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (motion, tracker) = match text.split_once(',') {
            Some((motion, tracker)) => (motion, Some(tracker)),
            None => (text, None),
        };
        match text {
            "emulated" => Ok(Self::Emulated),
            "simulated" => Ok(Self::Simulated),
            _ if motion.is_empty() || tracker == Some("") => {
                Err("say emulated, simulated, or the addresses MOTION,TRACKER (MOTION without a tracker)")
            }
            _ => Ok(Self::At {
                motion: motion.to_owned(),
                tracker: tracker.map(str::to_owned),
            }),
        }
    }
}

impl BoardChoice {
    fn name(&self) -> String {
        match self {
            Self::Emulated => "emulated".to_owned(),
            Self::Simulated => "simulated".to_owned(),
            Self::At {
                motion,
                tracker: None,
            } => motion.clone(),
            Self::At {
                motion,
                tracker: Some(tracker),
            } => format!("{motion},{tracker}"),
        }
    }

    /// Whether these are the boards that the machine needs.
    fn check(&self, machine: &MachineFile) -> anyhow::Result<()> {
        match (self, &machine.tracking) {
            (Self::At { tracker: None, .. }, Some(_)) => {
                bail!("this machine has a tracker: say the addresses of both boards, --boards MOTION,TRACKER")
            }
            (Self::At { tracker: Some(_), .. }, None) => {
                bail!(
                    "this machine has no tracker: say the address of the motion board only, --boards MOTION"
                )
            }
            _ => Ok(()),
        }
    }

    /// Connects; simulated boards become the machine whose kinematics are `wanted`, emulated ones must have been
    /// booted as it. The tracker board is left alone unless the machine is `tracked`.
    fn connect(&self, wanted: &'static str, tracked: bool) -> Result<Box<dyn Boards + Send>, LinkError> {
        let patience = Patience::default();
        match self {
            Self::Simulated => Ok(Box::new(SimulatedBoards::new(wanted)?)),
            Self::At { motion, tracker } => {
                let motion = Endpoint::board(motion);
                let tracker = tracker.as_deref().map(Endpoint::board);
                let boards = NetworkBoards::connect(&motion, tracker.as_ref(), None, patience)?;
                Ok(Box::new(boards))
            }
            Self::Emulated => {
                let path = std::env::var_os(SESSION_VARIABLE).ok_or(LinkError::NoEmulator)?;
                let session = Session::read(Path::new(&path))?;
                if session.machine != wanted {
                    let wired = session.machine;
                    return Err(LinkError::WrongMachine { wired, wanted });
                }
                Ok(Box::new(NetworkBoards::emulated(&session, tracked, patience)?))
            }
        }
    }
}

/// Does `connect`, which may wait for boards that are silent, unless the operator gives up before: `None`.
fn unless_interrupted<T: Send + 'static>(
    connect: impl FnOnce() -> Result<T, LinkError> + Send + 'static,
    interrupted: &AtomicBool,
) -> Result<Option<T>, LinkError> {
    let (sender, connected) = channel();
    // An attempt that nobody waits for any more ends with this program.
    std::thread::spawn(move || sender.send(connect()));
    loop {
        match connected.recv_timeout(POLL) {
            Ok(boards) => return boards.map(Some),
            Err(RecvTimeoutError::Timeout) if !interrupted.load(Ordering::Relaxed) => {}
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}

/// A speed that makes sense \[m/min\].
fn speed(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(speed) if f64::is_finite(speed) && speed > 0.0 => Ok(speed),
        _ => Err("say a number of m/min above 0"),
    }
}

impl Weld {
    /// Checks everything that can be checked without boards, then runs the job; prints the table and writes the
    /// report even if the job ended early.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let (program_file, part) = self.program_and_part(&machine)?;
        let program = read_program(&program_file, self.block_delete)?;
        let seam = self.seam.as_deref().map(Deviation::read).transpose()?;
        let name = |path: &Path| path.display().to_string();
        let job = Job {
            machine: &machine,
            program: &program,
            part: part.as_ref(),
            speed_m_per_min: self.speed,
            seam: seam.map(Rc::new),
            seed: self.seed,
            names: Names {
                program: name(&program_file),
                machine: name(&self.machine),
                seam: self.seam.as_deref().map(name),
                boards: self.boards.name(),
            },
        };
        self.check(&job)?;
        report::prepare(&self.report)?;
        let interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupted);
        ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot watch for Ctrl-C")?;

        let (choice, wanted) = (self.boards.clone(), machine.motion.kinematics.name());
        let tracked = machine.tracking.is_some();
        let connect = move || choice.connect(wanted, tracked);
        let Some(mut boards) = unless_interrupted(connect, &interrupted)? else {
            eprintln!("host-link: stopped by the operator; the boards were not asked for anything");
            return Ok(ExitCode::from(INTERRUPTED));
        };
        let ended = run(boards.as_mut(), &job, &interrupted, &mut Terminal::new())?;
        if ended.began {
            report::write(&self.report, &ended.report, &ended.evaluation, &ended.plots)?;
            print!("{}", ended.report);
            println!("  report in {}", self.report.display());
        }
        match ended.error {
            None => match verdict(&ended.report) {
                None => Ok(ExitCode::SUCCESS),
                Some(outside) => {
                    eprintln!("host-link: {outside}");
                    Ok(ExitCode::from(OUTSIDE))
                }
            },
            Some(JobError::Interrupted) => {
                eprintln!("host-link: {}", JobError::Interrupted);
                Ok(ExitCode::from(INTERRUPTED))
            }
            Some(error) => Err(error.into()),
        }
    }

    /// The program to run, planned if the job is a part, and the part to judge it by.
    fn program_and_part(&self, machine: &MachineFile) -> anyhow::Result<(PathBuf, Option<PartFile>)> {
        let told = self.part.as_deref().map(PartFile::read).transpose()?;
        if self.job.extension().is_none_or(|extension| extension != "toml") {
            let part = match told {
                Some(part) => Some(part),
                None => PartFile::of_program(&self.job)?,
            };
            return Ok((self.job.clone(), part));
        }
        let part = PartFile::read(&self.job)?;
        let title = self.job.file_stem().unwrap_or_default().to_string_lossy();
        let plan = part
            .plan(machine, &title)
            .with_context(|| format!("part {}", self.job.display()))?;
        report::prepare(&self.report)?;
        let file = self.report.join("program.ngc");
        std::fs::write(&file, &plan.program).with_context(|| format!("cannot write {}", file.display()))?;
        println!("{}:", file.display());
        for note in &plan.notes {
            println!("  {note}");
        }
        Ok((file, Some(told.unwrap_or(part))))
    }

    /// Whether the machine can run the program and the slides reach the seam, from the park position. The boards
    /// are asked to move only if so.
    fn check(&self, job: &Job) -> anyhow::Result<()> {
        let planner = Planner::build(job.machine)
            .with_context(|| format!("machine file {}", self.machine.display()))?;
        let planned = job.plan(&planner, &job.machine.planning.park_axes());
        let owner = match (&planned, &self.seam) {
            (Err(JobError::Seam(SeamError::TooShort { .. } | SeamError::Reach { .. })), Some(seam)) => {
                format!("seam {}", seam.display())
            }
            _ => format!("program {}", job.names.program),
        };
        planned.map(drop).context(owner)
    }
}

/// What is outside its limits, if anything is.
fn verdict(report: &Report) -> Option<String> {
    let exceeded: Vec<String> = report.exceeded().map(report::sentence).collect();
    (!exceeded.is_empty()).then(|| format!("the weld is outside its limits: {}", exceeded.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_are_chosen_by_word_or_by_address() {
        assert_eq!("emulated".parse(), Ok(BoardChoice::Emulated));
        assert_eq!("simulated".parse(), Ok(BoardChoice::Simulated));
        let two = "192.168.7.10,192.168.7.11".parse::<BoardChoice>().unwrap();
        assert_eq!(two.name(), "192.168.7.10,192.168.7.11");
        let one = "192.168.7.10".parse::<BoardChoice>().unwrap();
        assert_eq!(one.name(), "192.168.7.10");
        for wrong in ["", "192.168.7.10,", ",x"] {
            assert!(wrong.parse::<BoardChoice>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_weld_outside_its_limits_is_told_with_figure_and_limit() {
        let mut report = crate::report::tests::without_tracker();
        assert_eq!(
            verdict(&report).as_deref(),
            Some("the weld is outside its limits: height of the torch 0.2500 mm (may be 0.2000 mm)")
        );
        report.figures.remove(1);
        assert_eq!(verdict(&report), None);
    }

    #[test]
    fn speeds_are_positive_numbers() {
        assert_eq!(speed("7.5"), Ok(7.5));
        for wrong in ["0", "-1", "fast", "NaN", "inf"] {
            assert!(speed(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_silent_board_is_not_waited_for_once_the_operator_gives_up() {
        let (_never, silent) = channel::<()>();
        let connect = move || {
            let _ = silent.recv();
            Ok(())
        };
        assert!(matches!(
            unless_interrupted(connect, &AtomicBool::new(true)),
            Ok(None)
        ));
        let quick = unless_interrupted(|| Ok(7), &AtomicBool::new(false));
        assert!(matches!(quick, Ok(Some(7))));
    }
}
