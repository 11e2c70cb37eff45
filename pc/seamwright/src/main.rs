//! The command-line program of the PC.

use clap::Parser;
use config::sentence;
use seamwright::cli::Cli;
use seamwright::console;
use std::process::ExitCode;

fn main() -> ExitCode {
    let code = Cli::parse().run().unwrap_or_else(|error| {
        console::write_err(format_args!("seamwright: {}", sentence(error.as_ref())));
        ExitCode::FAILURE
    });
    console::exit(code)
}
