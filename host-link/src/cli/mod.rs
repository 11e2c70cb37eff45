//! The command line: one file for each command.

mod check;

use clap::{Parser, Subcommand};

/// Plans, checks and welds with a seam-following machine.
#[derive(Debug, Parser)]
#[command(name = "host-link", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Check(check::Check),
}

impl Cli {
    /// Does what was asked; an error reads as one sentence.
    pub fn run(self) -> anyhow::Result<()> {
        match self.command {
            Command::Check(command) => command.run(),
        }
    }
}
