//! Checks and tests: of everything, and of what needs neither emulated boards nor the Arm target.
//!
//! Every step runs, whatever became of the one before.
//!
//! All steps on the host select the whole workspace with the same features: cargo compiles a crate once for every set of
//! features of its dependencies, and these depend on what is selected.

use crate::bench;
use crate::browser;
use crate::cargo::{self, cargo, target_directory};
use crate::emulate;
use crate::firmware::{Board, Firmware, TARGET};
use crate::setup::{WASM, WINDOWS};
use crate::side_by_side;
use crate::size;
use crate::tally::Tally;
use crate::virtual_nucleo;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use emulator::{BOOT_VARIABLES, PROGRAM_VARIABLES};
use plant_file::{DEFAULT_MACHINE, PlantChoice};
use std::env;
use std::process::{Command, ExitCode};

/// The tests on boards that run the firmware: they run only where they are named.
const BOARDS: [&str; 2] = ["--test", "boards"];
/// The same with the operator's screen, on emulated ones.
const EMULATED: [&str; 4] = ["--test", "boards", "--test", "emulated"];

/// Feature of the PC that needs the library of real cameras; its tests take the simulated one that it comes with. One set of
/// features for everything: without it the PC's programs are linted for Windows, and tested by [`check`].
const CAMERAS: [&str; 2] = ["--features", "seamwright/aravis"];

/// Environment variable with the folder of the page for browsers.
const BROWSER_VARIABLE: &str = "SEAMWRIGHT_BROWSER";

/// Of the tests on emulated boards, the one that runs alone: the board has used up the elements that it holds in 0.6 s, and a PC that
/// gives it none for 0.3 s, being short of processor, shows in the time that its path takes.
const ALONE: &str = "welds::short_lines_at_6_m_per_min";

/// Of the tests on boards, the one that the suite runs on the model of the real one, too.
const ON_VIRTUAL_BOARDS: [&str; 1] = ["welds::the_shipped_job_at_5_m_per_min"];

/// Boards with tests that are not all part of the suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OtherBoards {
    /// The model of the real one.
    VirtualNucleo,
}

/// Checks the model of the real board and runs its tests, and those on boards, with the images as they are now.
pub fn virtual_nucleo() -> ExitCode {
    let mut tally = Tally::default();
    tally.check("format of the virtual board", || {
        cargo::run(&[&["fmt", "--check"], &virtual_nucleo::MANIFEST[..]].concat())
    });
    tally.check("lints of the virtual board", || {
        let mut command = virtual_nucleo::command(&["clippy", "--quiet", "--release", "--all-targets"])?;
        command.args(["--", "-D", "warnings"]);
        cargo::run_command(command, "cargo clippy")
    });
    tally.test("tests of the virtual board", virtual_nucleo::tests);
    tally.test("tests on virtual boards", || {
        virtual_nucleo::jobs(board_tests(&BOARDS, &[])?, &[])
    });
    tally.close()
}

/// Builds the page for browsers, and tests it in one.
pub fn browser() -> Result<ExitCode> {
    let folder = browser::build(None)?;
    let mut tally = Tally::default();
    tally.test("tests in a browser", || {
        let tests = ["--test", "screen", "--", "--ignored", "browser::"];
        let mut command = cargo(&[&["test", "--workspace"], &CAMERAS[..], &tests].concat())?;
        command.env(BROWSER_VARIABLE, folder);
        Ok(command)
    });
    Ok(tally.close())
}

/// Runs the tests on emulated boards that are too long for the suite.
pub fn extended() -> ExitCode {
    let mut tally = Tally::default();
    tally.test("long tests on emulated boards", || {
        let mut command = emulated_tests(&BOARDS)?;
        command.args(["--ignored", "--nocapture", "long::"]);
        Ok(command)
    });
    tally.close()
}

/// Runs what needs cargo only: format, lints, tests of the host, with whole jobs on simulated boards.
pub fn check() -> ExitCode {
    let mut tally = Tally::default();
    host(&mut tally, &[]);
    tally.close()
}

/// Runs everything.
pub fn run() -> ExitCode {
    let mut tally = Tally::default();
    host(&mut tally, &CAMERAS);
    tally.check("lints of the PC's programs on Windows", || {
        clippy(&[
            "--package",
            "seamwright",
            "--package",
            "host-link",
            "--target",
            WINDOWS,
        ])
    });
    tally.check("lints of the page for browsers", || {
        clippy(&["--package", "seamwright-browser", "--target", WASM])
    });
    let mut packages = vec!["--target", TARGET];
    for firmware in Firmware::ALL {
        packages.extend(["--package", firmware.package()]);
    }
    for board in Board::ALL {
        tally.check(&format!("lints of the firmwares on {board}"), || {
            clippy(&[&packages[..], &["--features", &board.to_string()]].concat())
        });
    }
    tally.check("lints of the benchmarks on mps2-an500", || {
        clippy(&["--package", bench::PACKAGE, "--target", TARGET])
    });
    tally.check("firmwares within their budgets", || match size::run()? {
        ExitCode::SUCCESS => Ok(()),
        _ => bail!("a firmware is outside its budget"),
    });
    tally.check("stack that runs over on mps2-an500", bench::stack_overflow);
    tally.test("tests on emulated boards", || {
        let mut command = emulated_tests(&EMULATED)?;
        command.args(["--skip", ALONE]);
        Ok(command)
    });
    tally.test("a test that has this PC for itself", || {
        let mut command = emulated_tests(&BOARDS)?;
        command.args(["--exact", ALONE]);
        Ok(command)
    });
    tally.test("weld on virtual boards", || {
        virtual_nucleo::jobs(board_tests(&BOARDS, &CAMERAS)?, &ON_VIRTUAL_BOARDS)
    });
    tally.close()
}

/// With these `features`, or with the default ones.
fn host(tally: &mut Tally, features: &[&str]) {
    tally.check("format", || cargo::run(&["fmt", "--all", "--check"]));
    tally.check("lints of the host", || {
        // Cargo leaves out what it does not run by default, and takes no name beside all targets.
        for targets in [&["--all-targets"][..], &EMULATED] {
            clippy(&[&["--workspace"], targets, features].concat())?;
        }
        Ok(())
    });
    tally.counted("tests of the host", || {
        side_by_side::run(&[&["--workspace"], features].concat())
    });
}

/// Lints of what `selection` selects, of which none is allowed.
fn clippy(selection: &[&str]) -> Result<()> {
    cargo::run(&[&["clippy", "--quiet"], selection, &["--", "-D", "warnings"]].concat())
}

fn emulated_tests(tests: &[&str]) -> Result<Command> {
    let logs = target_directory()?.join("emulated");
    let boot = emulate::build(logs, 1.0, DEFAULT_MACHINE.to_owned(), PlantChoice::Shipped)?;
    let mut command = board_tests(tests, &CAMERAS)?;
    let xtask = env::current_exe().context("cannot find this program's own file")?;
    command
        .args(["--skip", "on_model::"])
        .envs(
            BOOT_VARIABLES
                .into_iter()
                .zip([boot.motion, boot.tracker, boot.plugin]),
        )
        .env(PROGRAM_VARIABLES[1], xtask);
    Ok(command)
}

/// The tests on boards, three at a time: some run in real time and leave two cores idle now and then. Where a core is short, the
/// boards' time waits (docs/decisions/0005). seamwright is the one that the tests of the host have built.
fn board_tests(tests: &[&str], features: &[&str]) -> Result<Command> {
    let build = ["build", "--quiet", "--workspace", "--bin", "seamwright"];
    cargo::run(&[&build[..], features].concat())?;
    let seamwright = target_directory()?.join("debug").join("seamwright");
    let test = ["test", "--workspace", "--no-fail-fast"];
    let mut command = cargo(&[&test[..], features, tests, &["--", "--test-threads=3"]].concat())?;
    command.env(PROGRAM_VARIABLES[0], seamwright);
    Ok(command)
}
