//! The command-line program of the PC.

use clap::Parser;
use host_link::cli::{Cli, sentence};
use host_link::console;
use std::process::ExitCode;

fn main() -> ExitCode {
    let code = Cli::parse().run().unwrap_or_else(|error| {
        console::write_err(format_args!("host-link: {}", sentence(&error)));
        ExitCode::FAILURE
    });
    console::exit(code)
}
