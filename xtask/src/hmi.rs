//! `seamwright-hmi`, the operator's screen. Its options are checked by itself; this adds only the machine and the folder
//! of programs.

use crate::cargo::{self, target_directory};
use crate::weld::shipped;
use anyhow::{Context, Result};
use plant_file::DEFAULT_MACHINE;
use std::process::{Command, ExitCode};

/// Builds and runs it with `flags`; gives back its exit code.
pub fn run(flags: &[String]) -> Result<ExitCode> {
    eprintln!("building seamwright-hmi");
    cargo::run(&["build", "--quiet", "--package", "seamwright-hmi", "--release"])?;
    let program = target_directory()?.join("release").join("seamwright-hmi");
    let mut command = Command::new(program);
    let told = |name: &str| flags.iter().any(|flag| flag.split('=').next() == Some(name));
    if !told("--machine") {
        command.args(["--machine", &shipped(&format!("machines/{DEFAULT_MACHINE}.toml"))]);
    }
    if !told("--programs") {
        command.args(["--programs", &shipped("programs")]);
    }
    let status = command.args(flags).status();
    let code = status.context("cannot run seamwright-hmi")?.code();
    Ok(ExitCode::from(
        code.and_then(|code| u8::try_from(code).ok()).unwrap_or(1),
    ))
}
