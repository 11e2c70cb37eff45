//! Random and mutated requests and datagrams against both controllers, with overflow checks.

use crate::cargo;
use anyhow::Result;
use clap::Args;
use std::process::ExitCode;

/// How much of it.
#[derive(Args)]
pub struct Fuzz {
    /// Requests and datagrams in all
    #[arg(long, default_value_t = 10_000_000)]
    count: u64,
    /// Which of 2^64 runs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only this case of it, as a failure names it
    #[arg(long)]
    case: Option<u64>,
    /// Go on after a failure
    #[arg(long)]
    keep_going: bool,
}

/// Builds what runs them, and runs it.
pub fn run(fuzz: &Fuzz) -> Result<ExitCode> {
    let (count, seed) = (fuzz.count.to_string(), fuzz.seed.to_string());
    let mut arguments: Vec<&str> = vec![
        "run",
        "--profile",
        "fuzz",
        "-p",
        "system-tests",
        "--bin",
        "fuzz",
        "--",
    ];
    arguments.extend(["--count", &count, "--seed", &seed]);
    let case = fuzz.case.map(|case| case.to_string());
    if let Some(case) = &case {
        arguments.extend(["--case", case]);
    }
    if fuzz.keep_going {
        arguments.push("--keep-going");
    }
    cargo::run(&arguments)?;
    Ok(ExitCode::SUCCESS)
}
