//! `seamwright probe`: the first look at a board that has been flashed.

use super::OUTSIDE;

use crate::console::{errln, outln};
use anyhow::{Context, bail};
use clap::Args;
use config::machine::MachineFile;
use host_link::boards::{Boards, Endpoint, NetworkBoards, Timeouts, role_name};
use job::fresh_board::{BoardProtocol, Hands, Progress, Step, Verdict, look_at};
use plant_file::DEFAULT_MACHINE;
use shared::protocol::Role;
use std::fmt::Write as _;
use std::io::BufRead;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Duration;
use world::BoardChoice;
use world::simulated::SimulatedBoards;

/// Between two looks of a person at work.
const LOOK: Duration = Duration::from_millis(20);

/// Looks at a board that has been flashed, step by step: how it answers, its converters, its clocks and its network; then, with
/// your hands, emergency stop, encoders, marks, limit switches and ready loops. Nothing is enabled.
#[derive(Debug, Args)]
pub struct Probe {
    /// Address of a board, or of both, with a comma between them; simulated to try it
    #[arg(value_name = "ADDRESS")]
    boards: BoardChoice,
    /// Machine file: only what the machine has is asked for, and directions are compared with it
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// Only what a board does by itself
    #[arg(long)]
    no_hands: bool,
    /// Where the protocol goes as text [default: it is only shown]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Probe {
    /// Looks at one board after the other.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = self.machine.as_deref().map(MachineFile::read).transpose()?;
        let mut hands: Box<dyn Hands> = if self.no_hands {
            Box::new(NoHands)
        } else {
            Box::new(AtTerminal::start())
        };
        let mut text = String::new();
        let mut bad = 0;
        for (mut boards, role) in self.connect()? {
            let mut shown = false;
            let name = role_name(role);
            let told = |step: &Step| {
                if !std::mem::replace(&mut shown, true) {
                    outln!("{name} board");
                }
                outln!("{}", line(step));
            };
            let found = look_at(boards.as_mut(), role, machine.as_ref(), hands.as_mut(), told)?;
            bad += found
                .steps
                .iter()
                .filter(|step| step.verdict == Verdict::Bad)
                .count();
            let _ = write!(text, "{}", as_text(&found));
        }
        if let Some(output) = &self.output {
            std::fs::write(output, text).with_context(|| format!("cannot write {}", output.display()))?;
        }
        if bad > 0 {
            errln!(
                "seamwright: {bad} of the steps are not as they should be: mend the first of them, and look again"
            );
            return Ok(ExitCode::from(OUTSIDE));
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Each board in a session.
    fn connect(&self) -> anyhow::Result<Vec<(Box<dyn Boards>, Role)>> {
        let at = |host: &str| -> anyhow::Result<(Box<dyn Boards>, Role)> {
            let (boards, role) = NetworkBoards::connect_one(&Endpoint::board(host), Timeouts::default())?;
            Ok((Box::new(boards), role))
        };
        match &self.boards {
            BoardChoice::At { motion, tracker } => [Some(motion), tracker.as_ref()]
                .into_iter()
                .flatten()
                .map(|host| at(host))
                .collect(),
            BoardChoice::Simulated => {
                let board = |role| -> anyhow::Result<(Box<dyn Boards>, Role)> {
                    Ok((Box::new(SimulatedBoards::new(DEFAULT_MACHINE)?), role))
                };
                [Role::Motion, Role::Tracker].into_iter().map(board).collect()
            }
            BoardChoice::Emulated => {
                bail!(
                    "emulated boards have no connectors: give the address of a board, or simulated to try it"
                )
            }
        }
    }
}

/// A step as a person reads it.
fn line(step: &Step) -> String {
    let verdict = match step.verdict {
        Verdict::Good => "good",
        Verdict::Bad => "BAD",
        Verdict::NotDone => "-",
    };
    format!("  {verdict:<5} {:<15} {}", step.what, step.found)
}

/// The protocol of a board.
fn as_text(found: &BoardProtocol) -> String {
    let identity = &found.identity;
    let mut text = format!(
        "{} board {}, firmware {}, protocol {:016x}\n",
        role_name(identity.role),
        identity.board,
        identity.firmware,
        identity.schema_hash
    );
    for step in &found.steps {
        let _ = writeln!(text, "{}", line(step));
    }
    text
}

/// Nobody is there.
struct NoHands;

impl Hands for NoHands {
    fn begin(&mut self, _: &str) {}

    fn progress(&mut self) -> Progress {
        Progress::NotDone
    }
}

/// A person at the terminal.
struct AtTerminal {
    lines: Receiver<String>,
}

impl AtTerminal {
    /// Reads lines on a thread of its own, which ends with the program.
    fn start() -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines() {
                if line.is_err() || line.is_ok_and(|line| sender.send(line).is_err()) {
                    return;
                }
            }
        });
        Self { lines }
    }
}

impl Hands for AtTerminal {
    fn begin(&mut self, task: &str) {
        errln!("{task}; then Enter, or s and Enter to leave it out");
    }

    fn progress(&mut self) -> Progress {
        match self.lines.try_recv() {
            Ok(line) if line.trim().eq_ignore_ascii_case("s") => Progress::NotDone,
            Ok(_) => Progress::Done,
            Err(TryRecvError::Empty) => {
                // A simulated board does not wait by itself.
                std::thread::sleep(LOOK);
                Progress::Doing
            }
            Err(TryRecvError::Disconnected) => Progress::NotDone,
        }
    }
}
