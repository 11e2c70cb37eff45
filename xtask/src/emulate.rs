//! The two emulated boards: built, booted, described in a session file.

use crate::cargo::target_directory;
use crate::firmware::{self, Board, Firmware};
use crate::interrupt::Interrupts;
use anyhow::{Result, bail};
use emulator::{Boards, BootError, Options, SESSION_VARIABLE};
use plant_file::PlantChoice;
use std::path::PathBuf;
use std::process::ExitCode;
use std::thread;
use std::time::Duration;

/// Pairs of boards that may run at a time.
const PAIRS: u32 = 8;

/// Boards that run, and where that is written.
pub struct Running {
    pub boards: Boards,
    pub session_file: PathBuf,
}

/// What the boards boot from, built. `log_directory` is where the logs go; `machine` is what the boards are wired to,
/// `plant` what is true of it.
pub fn build(log_directory: PathBuf, rate: f64, machine: String, plant: PlantChoice) -> Result<Options> {
    let [motion, tracker] = firmware::build(Firmware::ALL, Board::Mps2An500)?;
    Ok(Options {
        motion,
        tracker,
        plugin: firmware::build_pace()?,
        log_directory,
        rate,
        machine,
        plant,
    })
}

/// Builds and boots both boards. Each pair that runs at the same time has a folder of its own.
pub fn boot(rate: f64, machine: String, plant: PlantChoice) -> Result<Running> {
    let folder = target_directory()?.join("emulated");
    let mut options = build(folder.clone(), rate, machine, plant)?;
    for pair in 0..PAIRS {
        options.log_directory = folder.join(pair.to_string());
        match Boards::boot(&options) {
            Err(BootError::InUse { .. }) => continue,
            booted => {
                let boards = booted?;
                let session_file = options.log_directory.join("session.toml");
                boards.session().write(&session_file)?;
                return Ok(Running { boards, session_file });
            }
        }
    }
    bail!("{PAIRS} pairs of emulated boards are running already")
}

/// Boots both boards and keeps them until Ctrl-C, or until one ends.
pub fn run(rate: f64, machine: String, plant: PlantChoice) -> Result<ExitCode> {
    let Running {
        mut boards,
        session_file,
    } = boot(rate, machine, plant)?;
    let interrupts = Interrupts::watch()?;
    let session = boards.session();
    println!("machine:       {}, {}", session.machine, session.plant);
    println!(
        "motion board:  requests {}, datagrams {}",
        session.motion.requests(),
        session.motion.datagrams()
    );
    println!(
        "tracker board: requests {}, datagrams {}",
        session.tracker.requests(),
        session.tracker.datagrams()
    );
    println!("for seamwright in another terminal:");
    println!("    export {SESSION_VARIABLE}={}", session_file.display());
    println!("Ctrl-C ends them.");
    while interrupts.count() == 0 {
        boards.check()?;
        thread::sleep(Duration::from_millis(100));
    }
    Ok(ExitCode::SUCCESS)
}
