//! The command-line program of the PC.

use clap::Parser;
use host_link::cli::{Cli, sentence};
use std::process::ExitCode;

fn main() -> ExitCode {
    match Cli::parse().run() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("host-link: {}", sentence(&error));
            ExitCode::FAILURE
        }
    }
}
