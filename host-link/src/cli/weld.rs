//! `host-link weld`: the job.

use super::read_program;
use crate::boards::simulated::SimulatedBoards;
use crate::boards::{Boards, Endpoint, LinkError, NetworkBoards, Patience};
use crate::machine::MachineFile;
use crate::nc::Program;
use crate::path::Planner;
use crate::report;
use crate::seam::Deviation;
use crate::weld::{Job, JobError, Names, Terminal, run};
use anyhow::Context;
use clap::Args;
use emulator::{SESSION_VARIABLE, Session};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code after Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;

/// Weld: run a program on two boards while the tracker follows the seam
#[derive(Debug, Args)]
pub struct Weld {
    /// NC program
    program: PathBuf,
    /// Machine file
    #[arg(long)]
    machine: PathBuf,
    /// Deviation of the real seams (CSV)
    #[arg(long)]
    seam: PathBuf,
    /// Speed of the weld in place of the programmed feed [m/min]
    #[arg(long, value_name = "M_PER_MIN", value_parser = speed, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// emulated, simulated, or the addresses MOTION,TRACKER of real boards
    #[arg(long, default_value = "emulated")]
    boards: BoardChoice,
    /// Where report.json, log.csv and the plots go
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
    At { motion: String, tracker: String },
}

impl FromStr for BoardChoice {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match (text, text.split_once(',')) {
            ("emulated", _) => Ok(Self::Emulated),
            ("simulated", _) => Ok(Self::Simulated),
            (_, Some((motion, tracker))) if !motion.is_empty() && !tracker.is_empty() => Ok(Self::At {
                motion: motion.to_owned(),
                tracker: tracker.to_owned(),
            }),
            _ => Err("say emulated, simulated, or two addresses MOTION,TRACKER"),
        }
    }
}

impl BoardChoice {
    fn name(&self) -> String {
        match self {
            Self::Emulated => "emulated".to_owned(),
            Self::Simulated => "simulated".to_owned(),
            Self::At { motion, tracker } => format!("{motion},{tracker}"),
        }
    }

    /// Connects; simulated boards become the `machine` of the file, emulated ones must have been booted as it.
    fn connect(&self, machine: &MachineFile) -> Result<Box<dyn Boards>, LinkError> {
        let wanted = machine.motion.kinematics.name();
        let patience = Patience::default();
        match self {
            Self::Simulated => Ok(Box::new(SimulatedBoards::new(wanted)?)),
            Self::At { motion, tracker } => {
                let (motion, tracker) = (Endpoint::board(motion), Endpoint::board(tracker));
                let boards = NetworkBoards::connect(&motion, &tracker, None, patience)?;
                Ok(Box::new(boards))
            }
            Self::Emulated => {
                let path = std::env::var_os(SESSION_VARIABLE).ok_or(LinkError::NoEmulator)?;
                let session = Session::read(Path::new(&path))?;
                if session.machine != wanted {
                    let wired = session.machine;
                    return Err(LinkError::WrongMachine { wired, wanted });
                }
                Ok(Box::new(NetworkBoards::emulated(&session, patience)?))
            }
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
        let program = read_program(&self.program, self.block_delete)?;
        let seam = Deviation::read(&self.seam)?;
        self.check(&machine, &program, &seam)?;
        report::prepare(&self.report)?;
        let interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupted);
        ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot watch for Ctrl-C")?;

        let mut boards = self.boards.connect(&machine)?;
        let job = Job {
            machine: &machine,
            program: &program,
            speed_m_per_min: self.speed,
            seam: Rc::new(seam),
            seed: self.seed,
            names: Names {
                program: self.program.display().to_string(),
                machine: self.machine.display().to_string(),
                seam: self.seam.display().to_string(),
                boards: self.boards.name(),
            },
        };
        let ended = run(boards.as_mut(), &job, &interrupted, &mut Terminal::new())?;
        if ended.began {
            report::write(&self.report, &ended.report, &ended.evaluation)?;
            print!("{}", ended.report);
            println!("  report in {}", self.report.display());
        }
        match ended.error {
            None => Ok(ExitCode::SUCCESS),
            Some(JobError::Interrupted) => {
                eprintln!("host-link: {}", JobError::Interrupted);
                Ok(ExitCode::from(INTERRUPTED))
            }
            Some(error) => Err(error.into()),
        }
    }

    /// Whether the machine can run the program and the slides reach the seam, from the park position. The boards
    /// are asked to move only if so.
    fn check(&self, machine: &MachineFile, program: &Program, seam: &Deviation) -> anyhow::Result<()> {
        let planner =
            Planner::build(machine).with_context(|| format!("machine file {}", self.machine.display()))?;
        let from = machine.planning.park_axes();
        let speed = self.speed.map(|speed| speed * shared::units::MM_S_PER_M_MIN);
        let paths = planner
            .program(program, &from, speed)
            .with_context(|| format!("program {}", self.program.display()))?;
        for path in paths.iter().filter(|path| path.weld().is_some()) {
            seam.check(path, machine)
                .with_context(|| format!("seam {}", self.seam.display()))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_are_chosen_by_word_or_by_two_addresses() {
        assert_eq!("emulated".parse(), Ok(BoardChoice::Emulated));
        assert_eq!("simulated".parse(), Ok(BoardChoice::Simulated));
        let two = "192.168.7.10,192.168.7.11".parse::<BoardChoice>().unwrap();
        assert_eq!(two.name(), "192.168.7.10,192.168.7.11");
        for wrong in ["", "emulate", "192.168.7.10", "192.168.7.10,", ",x"] {
            assert!(wrong.parse::<BoardChoice>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn speeds_are_positive_numbers() {
        assert_eq!(speed("7.5"), Ok(7.5));
        for wrong in ["0", "-1", "fast", "NaN", "inf"] {
            assert!(speed(wrong).is_err(), "{wrong}");
        }
    }
}
