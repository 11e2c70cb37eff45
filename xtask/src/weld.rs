//! `seamwright weld` on two emulated boards, or on two models of the real one. Options on the command line are checked by seamwright; this
//! adds only the missing ones.

use crate::cargo::root;
use crate::emulate;
use crate::firmware::build_seamwright;
use crate::interrupt::Interrupts;
use crate::machine;
use crate::setup::{self, Tool};
use crate::virtual_nucleo;
use anyhow::{Context, Error, Result};
use emulator::{
    JOB_VARIABLE, MACHINE_VARIABLE, PLANT_VARIABLE, SEAM_VARIABLE, SESSION_VARIABLE, bound_to_parent,
};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use plant_file::{COMMISSIONED, DEFAULT_MACHINE, PlantChoice};
use std::env;
use std::path::{Path, PathBuf};
use std::process::{Child, ExitCode, ExitStatus};
use std::thread;
use std::time::Duration;

/// The shipped job of each machine, by the name of its kinematics.
const JOBS: [(&str, &str); 5] = [
    ("dual-beam-gantry", "programs/t-seam-400.ngc"),
    ("pipe-welder", "programs/saddle-320-80.ngc"),
    ("ac-head", "programs/panel.toml"),
    ("wire-arc", "programs/leaf.ngc"),
    ("stir-gantry", "programs/stir-contour.ngc"),
];
/// The real seams of the dual-beam gantry's job.
pub const SEAM: &str = "programs/t-seam-400-deviation.csv";

/// The machine file that was commissioned on [`COMMISSIONED`].
const COMMISSIONED_FILE: &str = "machines/commissioned/dual-beam-gantry.toml";

/// The shipped job of a machine.
pub fn job_of(machine: &str) -> Option<&'static str> {
    JOBS.iter()
        .find(|(name, _)| *name == machine)
        .map(|(_, job)| *job)
}

/// Boards that run beside seamwright.
enum Running {
    Emulated(Box<emulate::Running>),
    Virtual(virtual_nucleo::Running),
}

impl Running {
    fn session_file(&self) -> &Path {
        match self {
            Self::Emulated(running) => &running.session_file,
            Self::Virtual(running) => &running.session_file,
        }
    }

    fn check(&mut self) -> Result<()> {
        match self {
            Self::Emulated(running) => Ok(running.boards.check()?),
            Self::Virtual(running) => running.check(),
        }
    }

    fn end(self) -> Result<()> {
        match self {
            Self::Emulated(_) => Ok(()),
            Self::Virtual(running) => running.end(),
        }
    }
}

/// Kinds of boards that are started here; others run already, or are seamwright's own.
const EMULATED: &str = "emulated";
const VIRTUAL: &str = "virtual-nucleo";
const SIMULATED: &str = "simulated";

/// Runs seamwright with `flags` and the defaults; gives back its exit code. `set_up` installs what is missing.
pub fn run(flags: &[String], rate: f64, set_up: impl Fn(&[Tool]) -> Result<()>) -> Result<ExitCode> {
    let told = BoardFlags::from(flags, EMULATED);
    let is = |boards: &str| told.boards == boards && !told.help;
    let (emulated, modelled) = (is(EMULATED), is(VIRTUAL));
    if emulated {
        set_up(&setup::EMULATION)?;
    }
    if modelled {
        set_up(&setup::VIRTUAL)?;
    }
    let seamwright = build_seamwright()?;
    let interrupts = Interrupts::watch()?;
    let mut running = match told.machine_name() {
        Some(machine) if emulated => {
            let running = emulate::boot(rate, machine, told.plant()?)?;
            Some(Running::Emulated(Box::new(running)))
        }
        Some(machine) if modelled => {
            let running = virtual_nucleo::boot(rate, &machine, &told.plant()?)?;
            Some(Running::Virtual(running))
        }
        _ => None,
    };

    let mut command = bound_to_parent(seamwright);
    command
        .arg("weld")
        .args(for_seamwright(flags))
        .envs(told.defaults());
    if let Some(running) = &running {
        command.env(SESSION_VARIABLE, running.session_file());
    }
    let mut child = command.spawn().context("cannot run seamwright")?;
    let status = wait(&mut child, &interrupts, running.as_mut())?;
    if let Some(mut running) = running {
        running.check()?;
        running.end()?;
    }
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}

/// To seamwright boards on the model are emulated ones: it finds both by a session file.
fn for_seamwright(flags: &[String]) -> Vec<String> {
    let mut boards = false;
    let told = flags.iter().map(|flag| {
        let value = std::mem::replace(&mut boards, flag == "--boards");
        match flag.as_str() {
            VIRTUAL if value => EMULATED.to_owned(),
            _ => match flag.strip_prefix("--boards=") {
                Some(VIRTUAL) => format!("--boards={EMULATED}"),
                _ => flag.clone(),
            },
        }
    });
    told.collect()
}

/// Waits for seamwright, and passes every request to end on to it: it stops the machine, this ends the boards.
fn wait(child: &mut Child, interrupts: &Interrupts, mut running: Option<&mut Running>) -> Result<ExitStatus> {
    let pid = Pid::from_raw(i32::try_from(child.id()).context("a process number too large")?);
    let mut passed = 0;
    loop {
        if let Some(status) = child.try_wait().context("cannot wait for seamwright")? {
            return Ok(status);
        }
        while passed < interrupts.count() {
            passed += 1;
            // An error means that it has just ended, which the next turn sees.
            let _ = kill(pid, Signal::SIGINT);
        }
        if let Some(error) = running.as_mut().and_then(|running| running.check().err()) {
            // seamwright finds the connection lost and ends in its own way; the reason is known here only.
            eprintln!("error: {error}");
            running = None;
        }
        thread::sleep(Duration::from_millis(20));
    }
}

/// What the command line says of the boards and their machine.
#[derive(Debug, PartialEq, Eq)]
pub struct BoardFlags {
    /// The machine file, if one is told.
    pub machine: Option<String>,
    plant: Option<String>,
    boards: String,
    help: bool,
}

impl BoardFlags {
    /// Of `flags` of a program whose boards are `default_boards` unless they are told.
    pub fn from(flags: &[String], default_boards: &str) -> Self {
        let value = |flag: &str| {
            let place = flags
                .iter()
                .position(|word| word.split('=').next() == Some(flag))?;
            match flags[place].split_once('=') {
                Some((_, value)) => Some(value.to_owned()),
                None => flags.get(place + 1).cloned(),
            }
        };
        Self {
            machine: value("--machine"),
            plant: value("--plant"),
            boards: value("--boards").unwrap_or_else(|| default_boards.to_owned()),
            help: flags.iter().any(|word| word == "-h" || word == "--help"),
        }
    }

    /// Name of the machine; `None` if the file does not say it, which seamwright reports.
    fn machine_name(&self) -> Option<String> {
        match &self.machine {
            None => Some(DEFAULT_MACHINE.to_owned()),
            Some(file) => machine::name(Path::new(file)).ok(),
        }
    }

    /// Whether the machine is the commissioned one: where it is simulated, and neither its file nor what is true of it is told.
    pub fn is_commissioned(&self) -> bool {
        [EMULATED, VIRTUAL, SIMULATED].contains(&self.boards.as_str())
            && self.machine.is_none()
            && self.plant.is_none()
    }

    /// What is true of the machine.
    fn plant(&self) -> Result<PlantChoice> {
        match &self.plant {
            Some(plant) => plant.parse().map_err(Error::msg).context("--plant"),
            None if self.is_commissioned() => Ok(COMMISSIONED),
            None => Ok(PlantChoice::Shipped),
        }
    }

    /// The machine file where none is told.
    pub fn default_machine(&self) -> String {
        if self.is_commissioned() {
            shipped(COMMISSIONED_FILE)
        } else {
            shipped(&format!("machines/{DEFAULT_MACHINE}.toml"))
        }
    }

    /// Defaults of seamwright's command line: the machine, its plant if it is the commissioned one, and job and seam of that
    /// machine.
    fn defaults(&self) -> Vec<(&'static str, String)> {
        let machine = self.machine_name().unwrap_or_else(|| DEFAULT_MACHINE.to_owned());
        let mut defaults = Vec::new();
        defaults.push((MACHINE_VARIABLE, self.default_machine()));
        if self.is_commissioned() {
            defaults.push((PLANT_VARIABLE, COMMISSIONED.to_string()));
        }
        if let Some(job) = job_of(&machine) {
            defaults.push((JOB_VARIABLE, shipped(job)));
        }
        if machine == DEFAULT_MACHINE {
            defaults.push((SEAM_VARIABLE, shipped(SEAM)));
        }
        defaults
    }
}

/// A shipped file, by its short name where that is enough.
pub fn shipped(file: &str) -> String {
    if env::current_dir().is_ok_and(|directory| directory == root()) {
        return file.to_owned();
    }
    let path: PathBuf = root().join(file);
    path.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(line: &str) -> BoardFlags {
        let flags: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        BoardFlags::from(&flags, EMULATED)
    }

    #[test]
    fn nothing_told_is_the_shipped_job_on_the_commissioned_gantry_with_its_seam() {
        for line in ["--speed 9", "--boards simulated", "--boards=virtual-nucleo"] {
            let told = told(line);
            assert!(!told.help);
            assert_eq!(told.plant().expect("a plant"), COMMISSIONED);
            let plant = COMMISSIONED.to_string();
            assert_defaults(line, &[COMMISSIONED_FILE, &plant, JOBS[0].1, SEAM]);
        }
    }

    #[test]
    fn what_is_told_of_the_machine_and_real_boards_have_the_shipped_gantry_without_errors() {
        let file = format!("machines/{DEFAULT_MACHINE}.toml");
        let told_file = format!("--machine {}", root().join(&file).display());
        for line in [&told_file, "--plant draw:poor:7", "--boards 10.0.0.1,10.0.0.2"] {
            assert_defaults(line, &[&file, JOBS[0].1, SEAM]);
        }
        assert_eq!(told(&told_file).plant().expect("a plant"), PlantChoice::Shipped);
        let poor = told("--plant draw:poor:7").plant().expect("a plant");
        assert_eq!(poor.to_string(), "draw:poor:7");
    }

    fn assert_defaults(line: &str, ends: &[&str]) {
        let defaults = told(line).defaults();
        assert_eq!(defaults.len(), ends.len(), "{line}: {defaults:?}");
        for ((_, value), end) in defaults.iter().zip(ends) {
            assert!(value.ends_with(end), "{line}: {value}");
        }
    }

    #[test]
    fn every_machine_has_a_job_and_only_the_gantry_a_seam() {
        let names: Vec<&str> = JOBS.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, plant_file::names().collect::<Vec<_>>());
        let pipe = root().join("machines/pipe-welder.toml");
        let defaults = told(&format!("--machine {}", pipe.display())).defaults();
        assert_eq!(defaults.len(), 2);
        assert!(defaults[1].1.ends_with("programs/saddle-320-80.ngc"));
    }

    #[test]
    fn boards_on_the_model_are_emulated_ones_to_seamwright_and_nothing_else_changes() {
        let line = |line: &str| -> Vec<String> { line.split_whitespace().map(str::to_owned).collect() };
        for (told, given) in [
            ("a.ngc --boards virtual-nucleo", "a.ngc --boards emulated"),
            ("--boards=virtual-nucleo --speed 9", "--boards=emulated --speed 9"),
            (
                "--report virtual-nucleo --boards simulated",
                "--report virtual-nucleo --boards simulated",
            ),
        ] {
            assert_eq!(for_seamwright(&line(told)), line(given));
        }
    }

    #[test]
    fn what_is_told_is_found_wherever_it_stands() {
        let told = told("my.ngc --machine=m.toml --seam s.csv --boards 10.0.0.1,10.0.0.2 -h");
        assert_eq!(told.boards, "10.0.0.1,10.0.0.2");
        assert_eq!(told.machine.as_deref(), Some("m.toml"));
        assert_eq!(told.machine_name(), None, "there is no such file");
        assert!(told.help);
    }
}
