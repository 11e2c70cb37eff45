//! `seamwright-hmi`, the operator's screen. Its options are checked by itself; this adds only the machine and the folder of programs.

use crate::browser;
use crate::cargo::{self, target_directory};
use crate::setup::Tool;
use crate::weld::{BoardFlags, shipped};
use anyhow::{Context, Result};
use plant_file::COMMISSIONED;
use std::process::{Command, ExitCode};

/// Kind of boards that the screen has of its own.
const BOARDS: &str = "simulated";

/// What it needs with `flags`.
pub fn wants(flags: &[String]) -> &'static [Tool] {
    let all = &[Tool::Screen, Tool::WasmTarget];
    if serves_browsers(flags) { all } else { &all[..1] }
}

/// Builds and runs it with `flags`; gives back its exit code.
pub fn run(flags: &[String]) -> Result<ExitCode> {
    if serves_browsers(flags) {
        browser::build(None)?;
    }
    eprintln!("building seamwright-hmi");
    cargo::run(&["build", "--quiet", "--package", "seamwright-hmi", "--release"])?;
    let program = target_directory()?.join("release").join("seamwright-hmi");
    let mut command = Command::new(program);
    command.args(defaults(flags)).args(flags);
    let status = command.status();
    let code = status.context("cannot run seamwright-hmi")?.code();
    Ok(ExitCode::from(
        code.and_then(|code| u8::try_from(code).ok()).unwrap_or(1),
    ))
}

/// Whether it takes the page for browsers that is built here.
fn serves_browsers(flags: &[String]) -> bool {
    is_told(flags, "--serve") && !is_told(flags, "--browser")
}

fn is_told(flags: &[String], name: &str) -> bool {
    flags.iter().any(|flag| flag.split('=').next() == Some(name))
}

/// What `flags` do not tell: the machine of `cargo xtask weld`, and the shipped programs.
fn defaults(flags: &[String]) -> Vec<String> {
    let told = BoardFlags::from(flags, BOARDS);
    let mut defaults = Vec::new();
    if told.machine.is_none() {
        defaults.extend(["--machine".to_owned(), told.default_machine()]);
    }
    if told.is_commissioned() {
        defaults.extend(["--plant".to_owned(), COMMISSIONED.to_string()]);
    }
    if !is_told(flags, "--programs") {
        defaults.extend(["--programs".to_owned(), shipped("programs")]);
    }
    defaults
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(flags: &[&str]) -> Vec<String> {
        let flags: Vec<String> = flags.iter().map(|flag| (*flag).to_owned()).collect();
        defaults(&flags)
    }

    #[test]
    fn what_is_told_is_not_told_again_and_a_machine_of_its_own_has_no_errors() {
        let all = of(&[]);
        assert!(all[1].ends_with("commissioned/dual-beam-gantry.toml"), "{all:?}");
        assert_eq!(all[2..4], ["--plant".to_owned(), COMMISSIONED.to_string()]);
        assert!(all[5].ends_with("programs"), "{all:?}");
        assert_eq!(of(&["--machine", "m.toml", "--programs=x"]), Vec::<String>::new());
        let real = of(&["--boards=192.168.7.10,192.168.7.11", "--programs=x"]);
        assert!(real[1].ends_with("machines/dual-beam-gantry.toml"), "{real:?}");
        assert_eq!(real.len(), 2);
    }

    #[test]
    fn the_page_for_browsers_is_built_where_it_is_served_and_not_brought() {
        let builds = |flags: &[&str]| {
            let flags: Vec<String> = flags.iter().map(|flag| (*flag).to_owned()).collect();
            wants(&flags).contains(&Tool::WasmTarget)
        };
        assert!(builds(&["--serve", "192.168.7.1:7443"]) && builds(&["--serve=192.168.7.1:7443"]));
        assert!(!builds(&["--serve=192.168.7.1:7443", "--browser", "x"]) && !builds(&[]));
    }
}
