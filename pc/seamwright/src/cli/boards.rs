//! Which boards a command uses, how it connects to them, and what it returns after its job.

use crate::console::errln;
use crate::terminal::{Operator, Terminal};
use anyhow::{Context, bail};
use clap::Args;
use config::machine::MachineFile;
use emulator::{SESSION_VARIABLE, Session};
use host_link::boards::{Boards, Endpoint, NetworkBoards, Timeouts};
use host_link::events::Interest;
use host_link::{Command, control};
use job::{Job, JobError, Names, Work, run};
use plant_file::{CameraMount, PlantChoice, PlantFileError};
use report::{Ended, LogColumns, LogWriter, ended};
use shared::io::SIDES;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use world::Surroundings;
use world::emulated;
use world::emulated::BoardsError;
use world::simulated::SimulatedBoards;

/// Exit code after Ctrl-C, as shells have it; after SIGTERM and SIGHUP, which are treated alike, too.
const INTERRUPTED: u8 = 130;
/// How often Ctrl-C is looked for while the boards are connected.
const POLL: Duration = Duration::from_millis(20);

/// Events that wait for the disk: more than half a minute of both boards.
const LOGGED: usize = 1 << 14;
/// Largest number of wrong letters in a misspelt word.
const NEAR: usize = 2;

/// Which boards, and the machine that simulated and emulated ones are wired to.
#[derive(Clone, Debug, Args)]
pub struct BoardArgs {
    /// emulated, simulated, or the addresses of real boards: MOTION,TRACKER, or MOTION without a tracker
    #[arg(long = "boards", default_value = "emulated")]
    pub choice: BoardChoice,
    /// What is true of a simulated machine: a plant file, or draw:usual:SEED or draw:poor:SEED for one drawn at random
    /// [default: as shipped, without errors]
    #[arg(long)]
    plant: Option<PlantChoice>,
}

/// Which boards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BoardChoice {
    /// Of `cargo xtask emulate` or `cargo xtask weld`.
    Emulated,
    /// In this program.
    Simulated,
    /// In the network.
    At {
        /// Address of the motion board.
        motion: String,
        /// Address of the tracker board, if there is one.
        tracker: Option<String>,
    },
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
            _ if motion.is_empty() || tracker == Some("") || is_meant(text) => {
                Err("must be emulated, simulated, or the addresses MOTION,TRACKER (MOTION without a tracker)")
            }
            _ => Ok(Self::At {
                motion: motion.to_owned(),
                tracker: tracker.map(str::to_owned),
            }),
        }
    }
}

/// Whether it is nearly one of the words, and no board's name.
fn is_meant(text: &str) -> bool {
    let text = text.to_lowercase();
    let near = |word| strsim::damerau_levenshtein(&text, word) <= NEAR;
    ["emulated", "simulated"].into_iter().any(near)
}

impl BoardArgs {
    /// Whether these are the boards that the machine needs.
    pub fn check(&self, machine: &MachineFile) -> anyhow::Result<()> {
        if let (BoardChoice::At { .. }, Some(plant)) = (&self.choice, &self.plant) {
            bail!(
                "--plant {plant} is for a simulated machine: real boards have their own; leave it out, or use --boards simulated"
            )
        }
        match (&self.choice, &machine.tracking) {
            (BoardChoice::At { tracker: None, .. }, Some(_)) => {
                bail!(
                    "this machine has a tracker: give the addresses of both boards, --boards MOTION,TRACKER"
                )
            }
            (BoardChoice::At { tracker: Some(_), .. }, None) => {
                bail!(
                    "this machine has no tracker: give the address of the motion board only, --boards MOTION"
                )
            }
            _ => Ok(()),
        }
    }

    /// Connects and does `job` with an `operator` at the terminal, while Ctrl-C, SIGTERM and SIGHUP are watched, which stop the
    /// machine and never this program, however often they come; the exit code if that was before anything was asked of the
    /// boards. The telemetry of the motion board is written to the folder `log` as it comes.
    pub fn run(
        &self,
        job: &Job,
        operator: Operator,
        log: Option<&Path>,
    ) -> anyhow::Result<Result<Ended, ExitCode>> {
        let (remote, mut control) = control();
        let stopped = remote.clone();
        // A stop needs no room.
        ctrlc::set_handler(move || _ = stopped.send(Command::Stop)).context("cannot watch for Ctrl-C")?;
        let (choice, wanted) = (self.choice.clone(), job.machine.motion.kinematics.name());
        let plant = self.plant();
        let tracked = job.machine.tracking.is_some();
        let stop = remote.stop_flag();
        let connect = move || choice.connect(wanted, &plant, tracked, stop);
        let Some(mut boards) = unless_interrupted(connect, &remote.stop_flag())? else {
            errln!("seamwright: stopped by the operator; nothing was sent to the boards");
            return Ok(Err(ExitCode::from(INTERRUPTED)));
        };
        let log = log.map(|folder| {
            let events = remote.subscribe(Interest::Samples, LOGGED);
            let columns = LogColumns::of(job.machine);
            LogWriter::start(folder, columns, events)
                .with_context(|| format!("cannot write the log in {}", folder.display()))
        });
        let log = log.transpose()?;
        let terminal = Terminal::new(operator, &remote);
        let record = std::thread::scope(|scope| {
            let job = scope.spawn(move || run(boards.as_mut(), job, &mut control));
            terminal.show();
            job.join()
        });
        let record = record.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        match log.map(LogWriter::end) {
            None | Some(Ok(0)) => {}
            Some(Ok(lost)) => {
                errln!("seamwright: writing the log was too slow: {lost} events are missing")
            }
            // The log is rewritten with what is known after the evaluation.
            Some(Err(error)) => errln!("seamwright: cannot write the log while the job runs: {error}"),
        }
        Ok(Ok(ended(job, record)))
    }

    /// `work` of `machine`, which `file` is of, with nothing around it and no part to judge; reports call it `program`.
    pub fn bare_job<'a>(
        &self,
        (machine, file): (&'a MachineFile, &Path),
        work: Work<'a>,
        program: String,
    ) -> Job<'a> {
        Job {
            machine,
            work,
            part: None,
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings::default().into(),
            spooling: Default::default(),
            names: Names {
                program,
                machine: file.display().to_string(),
                seam: None,
                boards: self.name(),
            },
        }
    }

    /// What the report calls them.
    pub fn name(&self) -> String {
        match &self.plant {
            None => self.choice.name(),
            Some(plant) => format!("{}, {plant}", self.choice.name()),
        }
    }

    /// How the cameras of a simulated machine are mounted.
    pub fn mounts(&self, machine: &MachineFile) -> Result<[CameraMount; SIDES], PlantFileError> {
        match self.choice {
            BoardChoice::At { .. } => Ok(Default::default()),
            _ => Ok(self.plant().of(machine.motion.kinematics.name())?.cameras),
        }
    }

    fn plant(&self) -> PlantChoice {
        self.plant.clone().unwrap_or_default()
    }
}

impl BoardChoice {
    /// What the report calls it.
    pub fn name(&self) -> String {
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

    /// Connects; simulated boards become the machine whose kinematics are `wanted`, emulated ones must have been
    /// booted as it, and with the same `plant`. The tracker board is left alone unless the machine is `tracked`.
    /// `interrupted` stops the machine.
    fn connect(
        &self,
        wanted: &'static str,
        plant: &PlantChoice,
        tracked: bool,
        interrupted: Arc<AtomicBool>,
    ) -> Result<Box<dyn Boards + Send>, BoardsError> {
        let patience = Timeouts::default();
        match self {
            Self::Simulated => Ok(Box::new(SimulatedBoards::wired_to(&plant.of(wanted)?))),
            Self::At { motion, tracker } => {
                let motion = Endpoint::board(motion);
                let tracker = tracker.as_deref().map(Endpoint::board);
                let boards = NetworkBoards::connect(&motion, tracker.as_ref(), None, patience)?;
                Ok(Box::new(boards.stopped_by(interrupted)))
            }
            Self::Emulated if cfg!(not(target_os = "linux")) => Err(BoardsError::NeedsLinux),
            Self::Emulated => {
                let path = std::env::var_os(SESSION_VARIABLE).ok_or(BoardsError::NoEmulator)?;
                let session = Session::read(Path::new(&path))?;
                if session.machine != wanted {
                    let wired = session.machine;
                    return Err(BoardsError::WrongMachine { wired, wanted });
                }
                if session.plant != plant.to_string() {
                    return Err(BoardsError::WrongPlant {
                        wired: session.plant,
                        wanted: plant.to_string(),
                    });
                }
                let boards = emulated::connect(&session, tracked, patience)?;
                Ok(Box::new(boards.stopped_by(interrupted)))
            }
        }
    }
}

/// Does `connect`, which may wait for boards that are silent, unless the operator gives up before: `None`.
fn unless_interrupted<T: Send + 'static>(
    connect: impl FnOnce() -> Result<T, BoardsError> + Send + 'static,
    interrupted: &AtomicBool,
) -> Result<Option<T>, BoardsError> {
    let (sender, connected) = channel();
    // An attempt that is not waited for any more ends with this program.
    std::thread::spawn(move || sender.send(connect()));
    loop {
        match connected.recv_timeout(POLL) {
            Ok(boards) => return boards.map(Some),
            Err(RecvTimeoutError::Timeout) if !interrupted.load(Ordering::Relaxed) => {}
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}

/// What a command returns whose job ended with `error`, if with any.
pub fn exit_code(error: Option<JobError>) -> anyhow::Result<ExitCode> {
    match error {
        None => Ok(ExitCode::SUCCESS),
        Some(JobError::Interrupted) => {
            errln!("seamwright: {}", JobError::Interrupted);
            Ok(ExitCode::from(INTERRUPTED))
        }
        Some(error) => Err(error.into()),
    }
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
        for wrong in ["", "192.168.7.10,", ",x", "simulatd", "Simulated", "emulator"] {
            let said = wrong.parse::<BoardChoice>().unwrap_err();
            assert!(said.starts_with("must be emulated, simulated, or"), "{wrong}");
        }
        assert!("gantry-motion".parse::<BoardChoice>().is_ok());
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
