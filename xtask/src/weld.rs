//! `host-link weld` on two emulated boards. Whatever is told on the command line is host-link's to judge; this
//! adds only what is not told.

use crate::cargo::root;
use crate::emulate::{self, Running};
use crate::firmware::build_host_link;
use crate::interrupt::Interrupts;
use crate::machine;
use crate::setup::{self, Tool};
use anyhow::{Context, Result};
use emulator::{SESSION_VARIABLE, bound_to_parent};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use plant::DEFAULT_MACHINE;
use std::env;
use std::path::{Path, PathBuf};
use std::process::{Child, ExitCode, ExitStatus};
use std::thread;
use std::time::Duration;

const PROGRAM: &str = "programs/t-seam-400.ngc";
const MACHINE: &str = "machines/dual-beam-gantry.toml";
const SEAM: &str = "programs/t-seam-400-deviation.csv";
/// Flags of host-link that stand alone; all others take a value.
const SWITCHES: [&str; 3] = ["-h", "--help", "--block-delete"];

/// Runs host-link with `flags` and the defaults; gives back its exit code. `set_up` installs what is missing.
pub fn run(flags: &[String], rate: f64, set_up: impl Fn(&[Tool]) -> Result<()>) -> Result<ExitCode> {
    let told = Told::from(flags);
    let emulated = !told.help && told.boards.as_deref().is_none_or(|boards| boards == "emulated");
    if emulated {
        set_up(&setup::EMULATION)?;
    }
    let host_link = build_host_link()?;
    let interrupts = Interrupts::watch()?;
    let mut running = match told.machine_name() {
        Some(machine) if emulated => Some(emulate::boot(rate, machine)?),
        _ => None,
    };

    let mut command = bound_to_parent(host_link);
    command.arg("weld").args(flags).args(told.missing());
    if let Some(Running { session_file, .. }) = &running {
        command.env(SESSION_VARIABLE, session_file);
    }
    let mut child = command.spawn().context("cannot run host-link")?;
    let status = wait(&mut child, &interrupts, running.as_mut())?;
    if let Some(Running { boards, .. }) = &mut running {
        boards.check()?;
    }
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Waits for host-link, and passes every request to end on to it: it stops the machine, this ends the boards.
fn wait(child: &mut Child, interrupts: &Interrupts, mut running: Option<&mut Running>) -> Result<ExitStatus> {
    let pid = Pid::from_raw(i32::try_from(child.id()).context("a process number too large")?);
    let mut passed = 0;
    loop {
        if let Some(status) = child.try_wait().context("cannot wait for host-link")? {
            return Ok(status);
        }
        while passed < interrupts.count() {
            passed += 1;
            // An error means that it has just ended, which the next turn sees.
            let _ = kill(pid, Signal::SIGINT);
        }
        if let Some(error) = running.as_mut().and_then(|running| running.boards.check().err()) {
            // host-link finds the connection lost and ends in its own way; the reason is known here only.
            eprintln!("error: {error}");
            running = None;
        }
        thread::sleep(Duration::from_millis(20));
    }
}

/// What the command line says of the job.
#[derive(Debug, Default, PartialEq, Eq)]
struct Told {
    program: bool,
    machine: Option<String>,
    seam: bool,
    boards: Option<String>,
    help: bool,
}

impl Told {
    fn from(flags: &[String]) -> Self {
        let mut told = Self::default();
        let mut words = flags.iter();
        while let Some(word) = words.next() {
            if !word.starts_with('-') {
                told.program = true;
                continue;
            }
            if SWITCHES.contains(&word.as_str()) {
                told.help |= word == "-h" || word == "--help";
                continue;
            }
            let (flag, value) = match word.split_once('=') {
                Some((flag, value)) => (flag, Some(value.to_owned())),
                None => (word.as_str(), words.next().cloned()),
            };
            match flag {
                "--machine" => told.machine = value,
                "--seam" => told.seam = true,
                "--boards" => told.boards = value,
                _ => {}
            }
        }
        told
    }

    /// Name of the machine; of a file that does not tell it none, which host-link will refuse in its own words.
    fn machine_name(&self) -> Option<String> {
        match &self.machine {
            None => Some(DEFAULT_MACHINE.to_owned()),
            Some(file) => machine::name(Path::new(file)).ok(),
        }
    }

    /// The shipped job, where nothing else is told.
    fn missing(&self) -> Vec<String> {
        let mut flags = Vec::new();
        if self.help {
            return flags;
        }
        if self.machine.is_none() {
            flags.extend(["--machine".into(), shipped(MACHINE)]);
        }
        if !self.seam {
            flags.extend(["--seam".into(), shipped(SEAM)]);
        }
        if self.boards.is_none() {
            flags.extend(["--boards".into(), "emulated".into()]);
        }
        if !self.program {
            flags.push(shipped(PROGRAM));
        }
        flags
    }
}

/// A shipped file, by its short name where that is enough.
fn shipped(file: &str) -> String {
    if env::current_dir().is_ok_and(|directory| directory == root()) {
        return file.to_owned();
    }
    let path: PathBuf = root().join(file);
    path.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(line: &str) -> Told {
        let flags: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        Told::from(&flags)
    }

    #[test]
    fn nothing_told_is_the_shipped_job_on_emulated_boards() {
        let flags = told("--speed 9").missing();
        assert_eq!(flags.len(), 7);
        assert!(flags[1].ends_with(MACHINE) && flags[3].ends_with(SEAM) && flags[6].ends_with(PROGRAM));
        assert_eq!(flags[4..6], ["--boards", "emulated"]);
    }

    #[test]
    fn what_is_told_stays() {
        let told = told("my.ngc --machine=m.toml --seam s.csv --boards 10.0.0.1,10.0.0.2");
        assert_eq!(told.boards.as_deref(), Some("10.0.0.1,10.0.0.2"));
        assert_eq!(told.missing(), Vec::<String>::new());
        assert_eq!(told.machine.as_deref(), Some("m.toml"));
        assert_eq!(told.machine_name(), None, "there is no such file");
    }

    #[test]
    fn values_are_no_programs_and_switches_have_none() {
        assert!(!told("--report out --speed 5").program);
        assert!(told("--block-delete my.ngc").program);
        assert_eq!(told("--help").missing(), Vec::<String>::new());
    }
}
