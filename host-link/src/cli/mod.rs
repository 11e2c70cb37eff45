//! The command line: one file for each command.

mod boards;
mod calibrate;
mod check;
mod dry_run;
mod plan;
mod teach;
mod teach_seam;
mod weld;

use crate::nc::{Options, Program, interpret_file};
use anyhow::Context;
use clap::{Parser, Subcommand};
use std::fs::File;
use std::path::Path;
use std::process::ExitCode;

/// Plans, checks and welds with a seam-following machine.
#[derive(Debug, Parser)]
#[command(name = "host-link", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Calibrate(calibrate::Calibrate),
    Check(check::Check),
    DryRun(dry_run::DryRun),
    Plan(plan::Plan),
    Teach(teach::Teach),
    Weld(weld::Weld),
}

impl Cli {
    /// Does what was asked; an error reads as one sentence.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self.command {
            Command::Calibrate(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::Check(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::DryRun(command) => command.run(),
            Command::Plan(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::Teach(command) => command.run(),
            Command::Weld(command) => command.run(),
        }
    }
}

/// Reads the NC program in a file.
fn read_program(path: &Path, block_delete: bool) -> anyhow::Result<Program> {
    let name = path.display();
    let file = File::open(path).with_context(|| format!("cannot read program {name}"))?;
    interpret_file(file, Options { block_delete }).with_context(|| format!("program {name}"))
}
