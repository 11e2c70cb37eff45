//! NC programs through our interpreter and LinuxCNC's: a program of its own, built for speed.

use crate::cargo::{cargo, run_command, target_directory};
use anyhow::{Context, Result};
use std::path::Path;
use std::process::{Command, ExitCode};

/// The package that reads them, and its program.
const PACKAGE: &str = "seamwright-nc-peer";
const PROGRAM: &str = "nc-peer";
/// Folder of programs that fail, in the target folder.
const FAILURES: &str = "nc-failures";

/// Reads the programs of a folder, random or mutated ones, or those that LinuxCNC installs.
pub fn run(programs: Option<&Path>, random: Option<u64>, mutate: Option<u64>, seed: u64) -> Result<ExitCode> {
    eprintln!("building {PROGRAM}");
    let build = cargo(&["build", "--quiet", "--release", "--package", PACKAGE])?;
    run_command(build, &format!("building {PROGRAM}"))?;
    let target = target_directory()?;
    let mut command = Command::new(target.join("release").join(PROGRAM));
    command.arg("--failures").arg(target.join(FAILURES));
    command.args(["--seed", &seed.to_string()]);
    if let Some(folder) = programs {
        command.arg("--programs").arg(folder);
    }
    for (flag, count) in [("--random", random), ("--mutate", mutate)] {
        if let Some(count) = count {
            command.args([flag, &count.to_string()]);
        }
    }
    let status = command
        .status()
        .with_context(|| format!("cannot run {PROGRAM}"))?;
    Ok(if status.success() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
