//! The model of the real board: built in its own workspace, into one folder of its own, and run as a program.

use crate::cargo::{cargo, run_command, target_directory};
use crate::firmware::{self, Board, Firmware};
use anyhow::{Context, Result, bail};
use emulator::bound_to_parent;
use plant_file::PlantChoice;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Stdio};

/// Its manifest.
pub const MANIFEST: [&str; 2] = ["--manifest-path", "virtual-nucleo/Cargo.toml"];
/// Variables by which tests find the images and the program.
const IMAGES: &str = "SEAMWRIGHT_NUCLEO_IMAGES";
const PROGRAM: &str = "SEAMWRIGHT_VIRTUAL_NUCLEO";
/// How the line begins in which it tells where its boards are to be found.
const SESSION: &str = "session: ";

/// A cargo command in its workspace. Unicorn takes some minutes to build, so it has a folder that nothing else uses.
pub fn command(arguments: &[&str]) -> Result<Command> {
    let mut command = cargo(&[arguments, &MANIFEST].concat())?;
    command.env("CARGO_TARGET_DIR", folder()?);
    Ok(command)
}

/// Its tests, with both images built.
pub fn tests() -> Result<Command> {
    let [motion, _] = firmware::build(Firmware::ALL, Board::NucleoH723zg)?;
    let images = motion.parent().context("an image lies in no folder")?;
    let mut command = command(&["test", "--release", "--no-fail-fast"])?;
    command.env(IMAGES, images);
    Ok(command)
}

/// Those of the `tests` on boards that it can run, with all that they need built; `selection` as `cargo test` has it.
pub fn jobs(mut tests: Command, selection: &[&str]) -> Result<Command> {
    let [motion, _] = firmware::build(Firmware::ALL, Board::NucleoH723zg)?;
    let images = motion.parent().context("an image lies in no folder")?;
    tests
        .args(selection)
        .args(["--skip", "on_qemu::"])
        .env(IMAGES, images)
        .env(PROGRAM, build()?);
    Ok(tests)
}

/// Builds the program; returns it.
fn build() -> Result<PathBuf> {
    eprintln!("building virtual-nucleo");
    let build = ["build", "--quiet", "--release"];
    run_command(command(&build)?, "building virtual-nucleo")?;
    Ok(folder()?.join("release").join("virtual-nucleo"))
}

fn folder() -> Result<PathBuf> {
    Ok(target_directory()?.join("virtual-nucleo"))
}

/// Boards that run.
pub struct Running {
    child: Child,
    output: BufReader<ChildStdout>,
    folder: PathBuf,
    /// Where it is written how they are reached.
    pub session_file: PathBuf,
}

/// Builds program and images, and runs both boards.
pub fn boot(rate: f64, machine: &str, plant: &PlantChoice) -> Result<Running> {
    let images = firmware::build(Firmware::ALL, Board::NucleoH723zg)?;
    let program = build()?;
    let run = folder()?.join("boards").join(std::process::id().to_string());
    let mut program = bound_to_parent(program);
    program.args(images).args(["--machine", machine]);
    if *plant != PlantChoice::Shipped {
        program.args(["--plant", &plant.to_string()]);
    }
    let mut child = program
        .args(["--rate", &rate.to_string()])
        .arg("--folder")
        .arg(&run)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .context("cannot run virtual-nucleo")?;
    let mut output = BufReader::new(child.stdout.take().context("virtual-nucleo has no output")?);
    loop {
        let mut line = String::new();
        if output.read_line(&mut line)? == 0 {
            bail!("virtual-nucleo has ended before its boards were on the net");
        }
        match line.trim_end().strip_prefix(SESSION) {
            Some(file) => {
                return Ok(Running {
                    child,
                    output,
                    folder: run,
                    session_file: file.into(),
                });
            }
            None => print!("{line}"),
        }
    }
}

impl Running {
    /// Whether they still run.
    pub fn check(&mut self) -> Result<()> {
        match self.child.try_wait()? {
            Some(status) => bail!("virtual-nucleo has ended ({status})"),
            None => Ok(()),
        }
    }

    /// Ends them, and prints what they tell: times, and what was found.
    pub fn end(mut self) -> Result<()> {
        drop(self.child.stdin.take());
        let mut told = String::new();
        self.output.read_to_string(&mut told)?;
        // It fails if anything was found, which has been said.
        self.child.wait()?;
        println!("\nVirtual boards");
        for line in told.lines() {
            println!("  {line}");
        }
        fs::remove_dir_all(&self.folder).with_context(|| format!("cannot remove {}", self.folder.display()))
    }
}
