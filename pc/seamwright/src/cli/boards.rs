//! Which boards a command uses, how it connects to them, and what it returns after its job.

use crate::console::errln;
use crate::terminal::{Operator, Terminal};
use anyhow::{Context, bail};
use clap::Args;
use config::machine::MachineFile;
use emulator::PLANT_VARIABLE;
use host_link::events::Interest;
use host_link::{Command, Remote, control};
use job::{Job, JobError, Names, Work, run};
use plant_file::PlantChoice;
use report::{Ended, LogColumns, LogWriter, ended};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use world::{BoardChoice, BoardsError, Surroundings, TrueMachine};

/// Exit code after Ctrl-C, as shells have it; after SIGTERM and SIGHUP, which are treated alike, too.
const INTERRUPTED: u8 = 130;
/// How often Ctrl-C is looked for while the boards are connected.
const POLL: Duration = Duration::from_millis(20);

/// Events that wait for the disk: more than half a minute of both boards.
const LOGGED: usize = 1 << 14;

/// Which boards, and the machine that simulated and emulated ones are wired to.
#[derive(Clone, Debug, Args)]
pub struct BoardArgs {
    /// emulated, simulated, or the addresses of real boards: MOTION,TRACKER, or MOTION without a tracker
    #[arg(long = "boards", default_value = "emulated")]
    pub choice: BoardChoice,
    /// What is true of a simulated machine: a plant file, or draw:usual:SEED, draw:poor:SEED or draw:bad:SEED for one drawn at random
    /// [default: as shipped, without errors; with `cargo xtask weld` and no --machine draw:usual:401]
    #[arg(long, env = PLANT_VARIABLE, hide_env = true)]
    plant: Option<PlantChoice>,
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
        stopped_by_ctrl_c(&remote)?;
        let (choice, wanted) = (self.choice.clone(), job.machine.motion.kinematics.name());
        let plant = self.plant();
        let tracked = job.machine.tracking.is_some();
        let stop = remote.stop_flag();
        // Whoever holds to a machine does so in their own time.
        let pace = matches!(operator, Operator::Jogs(_)).then_some(1.0);
        let connect = move || choice.connect(wanted, &plant, tracked, pace, stop);
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

    /// How a simulated machine truly is, whatever its file says.
    pub fn truth(&self, machine: &MachineFile) -> anyhow::Result<TrueMachine> {
        match self.choice {
            BoardChoice::At { .. } => Ok(TrueMachine::default()),
            _ => {
                let plant = self.plant().of(machine.motion.kinematics.name())?;
                TrueMachine::new(&plant, machine).with_context(|| format!("plant file {}", self.plant()))
            }
        }
    }

    fn plant(&self) -> PlantChoice {
        self.plant.clone().unwrap_or_default()
    }
}

/// Has Ctrl-C stop the job of this `remote` from now on; at once if it came since the job before.
fn stopped_by_ctrl_c(remote: &Remote) -> anyhow::Result<()> {
    static JOB: Mutex<Option<Remote>> = Mutex::new(None);
    let job = || JOB.lock().unwrap_or_else(PoisonError::into_inner);
    let before = job().replace(remote.clone());
    if let Some(before) = before {
        if before.stop_flag().load(Ordering::Relaxed) {
            _ = remote.send(Command::Stop);
        }
        return Ok(());
    }
    let stop = move || {
        if let Some(remote) = &*job() {
            // A stop needs no room.
            _ = remote.send(Command::Stop);
        }
    };
    ctrlc::set_handler(stop).context("cannot watch for Ctrl-C")
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
