//! The command-line program of the PC.

use clap::Parser;
use seamwright::cli::{Cli, sentence};
use seamwright::console;
use std::process::ExitCode;

fn main() -> ExitCode {
    let code = Cli::parse().run().unwrap_or_else(|error| {
        console::write_err(format_args!("seamwright: {}", sentence(&error)));
        ExitCode::FAILURE
    });
    console::exit(code)
}
