//! The command-line program of the PC.

use clap::Parser;
use host_link::cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    match Cli::parse().run() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("host-link: {error:#}");
            ExitCode::FAILURE
        }
    }
}
