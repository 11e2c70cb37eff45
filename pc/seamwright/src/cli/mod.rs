//! The command line: one file for each command.

mod boards;
mod calibrate;
mod cameras;
mod check;
mod dry_run;
mod measure;
mod plan;
mod teach;
mod teach_seam;
mod weld;

use anyhow::{Context, bail};
use clap::{Parser, Subcommand};
use nc::{Options, Program, interpret_file};
use std::fs::File;
use std::path::Path;
use std::process::ExitCode;

/// Plans, checks and welds with a seam-following machine.
#[derive(Debug, Parser)]
#[command(name = "seamwright", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Calibrate(calibrate::Calibrate),
    Check(check::Check),
    DryRun(dry_run::DryRun),
    Measure(measure::Measure),
    Plan(plan::Plan),
    Teach(teach::Teach),
    Weld(weld::Weld),
}

impl Cli {
    /// Does what was asked; an error reads as one sentence.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self.command {
            Command::Calibrate(command) => command.run(),
            Command::Check(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::DryRun(command) => command.run(),
            Command::Measure(command) => command.run(),
            Command::Plan(command) => command.run().map(|()| ExitCode::SUCCESS),
            Command::Teach(command) => command.run(),
            Command::Weld(command) => command.run(),
        }
    }
}

/// Exit code of what is outside its limits.
const OUTSIDE: u8 = 3;

/// Reads the NC program in a file.
fn read_program(path: &Path, block_delete: bool) -> anyhow::Result<Program> {
    let name = path.display();
    if path.extension().is_some_and(|extension| extension == "toml") {
        bail!(
            "{name} is a part file, not a program: plan it with seamwright plan {name} --machine FILE -o PROGRAM.ngc"
        );
    }
    let file = File::open(path).with_context(|| format!("cannot read program {name}"))?;
    interpret_file(file, Options { block_delete }).with_context(|| format!("program {name}"))
}

/// The error and its causes in one line; a cause that its effect has already quoted is not said again.
pub fn sentence(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.contains(&cause) {
            continue;
        }
        if !text.is_empty() {
            text.push_str(": ");
        }
        text.push_str(&cause);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;
    use config::machine::MachineFile;

    #[test]
    fn a_cause_is_said_once() {
        let missing = std::path::Path::new("none.toml");
        let error = MachineFile::read(missing).context("weld").unwrap_err();
        let text = sentence(&error);
        assert!(
            text.starts_with("weld: cannot read machine file none.toml: "),
            "{text}"
        );
        assert_eq!(text.matches("os error").count(), 1, "{text}");
    }
}
