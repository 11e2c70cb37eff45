//! Checks and tests of everything, with one summary.
//!
//! Every step runs, whatever became of the one before. The last line is `N passed, N failed`: the tests as
//! their runners counted them, and one failure for each step that failed without a count.

use crate::bench;
use crate::cargo::{self, cargo, root, target_directory};
use crate::emulate;
use crate::firmware::{self, TARGET};
use crate::size;
use anyhow::{Context, Result, bail};
use emulator::{BOOT_VARIABLES, PROGRAM_VARIABLES};
use plant::DEFAULT_MACHINE;
use std::env;
use std::io::{BufRead, BufReader};
use std::process::{Command, ExitCode, Stdio};

/// Results so far.
#[derive(Default)]
struct Tally {
    counts: Counts,
    failures: Vec<String>,
}

/// Tests, as their runners count them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Counts {
    passed: u32,
    failed: u32,
}

/// Runs everything.
pub fn run() -> Result<ExitCode> {
    let mut tally = Tally::default();
    tally.check("format", || cargo::run(&["fmt", "--all", "--check"]));
    tally.check("lints of the host", || {
        cargo::run(&[
            "clippy",
            "--quiet",
            "--workspace",
            "--all-targets",
            "--features",
            EMULATED,
            "--",
            "-D",
            "warnings",
        ])
    });
    // The system tests follow at the end, with the emulated boards.
    let host = cargo(&[
        "test",
        "--workspace",
        "--exclude",
        "system-tests",
        "--no-fail-fast",
    ])?;
    tally.test("tests of the host", host);
    tally.check("lints with real cameras", || {
        let clippy = ["clippy", "--quiet", "--package", "seamwright", "--all-targets"];
        cargo::run(&[&clippy[..], &CAMERAS, &["--", "-D", "warnings"]].concat())
    });
    let cameras = [
        &["test", "--package", "seamwright", "--test", "aravis"][..],
        &CAMERAS,
    ]
    .concat();
    tally.test("tests of real cameras", cargo(&cameras)?);
    for (firmware, board) in firmware::ALL {
        let (package, board) = (firmware.package(), board.to_string());
        tally.check(&format!("lints of {package} on {board}"), || {
            cargo::run(&[
                "clippy",
                "--quiet",
                "--package",
                package,
                "--target",
                TARGET,
                "--features",
                &board,
                "--",
                "-D",
                "warnings",
            ])
        });
    }
    tally.check("lints of the benchmarks on mps2-an500", || {
        cargo::run(&[
            "clippy",
            "--quiet",
            "--package",
            bench::PACKAGE,
            "--target",
            TARGET,
            "--",
            "-D",
            "warnings",
        ])
    });
    tally.check("firmwares within their budgets", || match size::run()? {
        ExitCode::SUCCESS => Ok(()),
        _ => bail!("a firmware is outside its budget"),
    });
    tally.check("stack that runs over on mps2-an500", bench::stack_overflow);
    match emulated_tests() {
        Ok(command) => tally.test("system tests", command),
        Err(error) => tally.failed("system tests", &error),
    }
    Ok(tally.close())
}

/// Feature of the PC that needs the library of real cameras; the tests take the simulated one that it comes with.
const CAMERAS: [&str; 2] = ["--features", "aravis"];

/// Feature of the tests that need emulated boards.
const EMULATED: &str = "system-tests/emulated";

fn emulated_tests() -> Result<Command> {
    let logs = target_directory()?.join("emulated");
    let boot = emulate::build(logs, 1.0, DEFAULT_MACHINE.to_owned())?;
    let mut command = cargo(&[
        "test",
        "--package",
        "system-tests",
        "--features",
        EMULATED,
        "--no-fail-fast",
        "--",
        "--test-threads=1",
    ])?;
    command.envs(
        BOOT_VARIABLES
            .into_iter()
            .zip([boot.motion, boot.tracker, boot.plugin]),
    );
    let xtask = env::current_exe().context("cannot find this program's own file")?;
    command.envs(
        PROGRAM_VARIABLES
            .into_iter()
            .zip([firmware::build_seamwright()?, xtask]),
    );
    Ok(command)
}

impl Tally {
    fn check(&mut self, what: &str, step: impl FnOnce() -> Result<()>) {
        eprintln!("\n=== {what}");
        if let Err(error) = step() {
            self.failed(what, &error);
        }
    }

    fn test(&mut self, what: &str, command: Command) {
        eprintln!("\n=== {what}");
        match watch(command) {
            Ok((counts, succeeded)) => {
                self.counts.add(counts);
                if !succeeded && counts.failed == 0 {
                    self.failed(what, &"ended before all tests were counted");
                } else if counts.failed > 0 {
                    self.failures.push(format!("{what}: {} failed", counts.failed));
                } else if counts.passed == 0 {
                    self.failed(what, &"no test was run");
                }
            }
            Err(error) => self.failed(what, &format_args!("{error:#}")),
        }
    }

    fn failed(&mut self, what: &str, error: &dyn std::fmt::Display) {
        eprintln!("error: {error:#}");
        self.counts.failed += 1;
        self.failures.push(format!("{what}: {error:#}"));
    }

    fn close(self) -> ExitCode {
        println!();
        for failure in &self.failures {
            println!("FAILED {failure}");
        }
        println!("{} passed, {} failed", self.counts.passed, self.counts.failed);
        if self.counts.failed == 0 {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        }
    }
}

impl Counts {
    fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }

    /// Reads a line like `test result: ok. 7 passed; 0 failed; 0 ignored; …`; `None` for any other line.
    fn from_line(line: &str) -> Option<Self> {
        let (_, numbers) = line.strip_prefix("test result: ")?.split_once(". ")?;
        let number = |name: &str| -> Option<u32> {
            numbers
                .split("; ")
                .find_map(|part| part.strip_suffix(name)?.trim().parse().ok())
        };
        Some(Self {
            passed: number("passed")?,
            failed: number("failed")?,
        })
    }
}

/// Runs a test runner, shows what it prints, and adds up what it counts; also whether it succeeded.
fn watch(mut command: Command) -> Result<(Counts, bool)> {
    let mut child = command
        .current_dir(root())
        .stdout(Stdio::piped())
        .spawn()
        .context("cannot run cargo test")?;
    let output = child.stdout.take().context("cargo test has no output")?;
    let mut counts = Counts::default();
    for line in BufReader::new(output).lines() {
        let line = line.context("cannot read what cargo test prints")?;
        println!("{line}");
        if let Some(more) = Counts::from_line(&line) {
            counts.add(more);
        }
    }
    Ok((
        counts,
        child.wait().context("cannot wait for cargo test")?.success(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_from_the_runners_own_summary() {
        let line = "test result: FAILED. 41 passed; 2 failed; 1 ignored; 0 measured; 3 filtered out; finished in 0.10s";
        assert_eq!(
            Counts::from_line(line),
            Some(Counts {
                passed: 41,
                failed: 2
            })
        );
        assert_eq!(
            Counts::from_line("test nc::lexer::tests::7 passed; 0 failed ... ok"),
            None
        );
    }

    #[test]
    fn a_runner_that_dies_uncounted_is_a_failure() {
        let mut tally = Tally::default();
        let mut command = Command::new("sh");
        command.args([
            "-c",
            "echo 'test result: ok. 3 passed; 0 failed; 0 ignored'; exit 1",
        ]);
        tally.test("a step", command);
        assert_eq!(tally.counts, Counts { passed: 3, failed: 1 });
    }
}
