//! The command-line program of the PC.

use clap::Parser;
use host_link::cli::Cli;
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

/// The error and its causes in one line; a cause that its effect has already quoted is not said again.
fn sentence(error: &anyhow::Error) -> String {
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
    use host_link::machine::MachineFile;

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
