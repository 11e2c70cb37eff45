//! Random programs with hands at the controls, through the planner: a test of its own, built for speed.

use crate::cargo::{cargo, run_command};
use anyhow::Result;
use std::process::ExitCode;

/// The test that runs them, and tells each that fails.
const TEST: &str = "hands::many";
/// How it is told how many, and the first seed.
const PROGRAMS: &str = "HANDS_PROGRAMS";
const SEED: &str = "HANDS_SEED";

/// Runs so many programs, from a seed on.
pub fn run(programs: u64, seed: u64) -> Result<ExitCode> {
    let mut command = cargo(&[
        "test",
        "--release",
        "--package",
        "seamwright-shared",
        "--test",
        "planner",
        "--",
        TEST,
        "--exact",
        "--ignored",
        "--nocapture",
    ])?;
    command
        .env(PROGRAMS, programs.to_string())
        .env(SEED, seed.to_string());
    run_command(command, "the programs with hands at the controls")?;
    Ok(ExitCode::SUCCESS)
}
