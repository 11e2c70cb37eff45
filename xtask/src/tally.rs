//! What came of the steps of a suite: tests as their runners counted them, and one failure for each step that failed without
//! a count.

use crate::cargo::root;
use anyhow::{Context, Result};
use std::io::{BufRead, BufReader};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

/// Results so far.
#[derive(Default)]
pub struct Tally {
    counts: Counts,
    failures: Vec<String>,
    /// How long each step took.
    times: Vec<(String, Duration)>,
}

/// Tests, as their runners count them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub passed: u32,
    pub failed: u32,
}

impl Tally {
    /// Does a step that counts nothing.
    pub fn check(&mut self, what: &str, step: impl FnOnce() -> Result<()>) {
        eprintln!("\n=== {what}");
        let started = Instant::now();
        if let Err(error) = step() {
            self.failed(what, &error);
        }
        self.times.push((what.to_owned(), started.elapsed()));
    }

    /// Runs the tests of `command`, once it is `ready`.
    pub fn test(&mut self, what: &str, ready: impl FnOnce() -> Result<Command>) {
        self.counted(what, || ready().and_then(watch));
    }

    /// Does a step that counts tests, and says whether it ended well.
    pub fn counted(&mut self, what: &str, step: impl FnOnce() -> Result<(Counts, bool)>) {
        eprintln!("\n=== {what}");
        let started = Instant::now();
        match step() {
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
        self.times.push((what.to_owned(), started.elapsed()));
    }

    fn failed(&mut self, what: &str, error: &dyn std::fmt::Display) {
        eprintln!("error: {error:#}");
        self.counts.failed += 1;
        self.failures.push(format!("{what}: {error:#}"));
    }

    /// Tells how long each step took, what failed, and in the last line `N passed, N failed`.
    pub fn close(self) -> ExitCode {
        println!();
        for (what, time) in &self.times {
            println!("{:>6.0} s  {what}", time.as_secs_f64());
        }
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
    /// Adds what another runner counted.
    pub fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }

    /// Reads a line like `test result: ok. 7 passed; 0 failed; 0 ignored; …`; `None` for any other line.
    pub fn from_line(line: &str) -> Option<Self> {
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
pub fn watch(mut command: Command) -> Result<(Counts, bool)> {
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
        tally.test("a step", || {
            let mut command = Command::new("sh");
            command.args([
                "-c",
                "echo 'test result: ok. 3 passed; 0 failed; 0 ignored'; exit 1",
            ]);
            Ok(command)
        });
        assert_eq!(tally.counts, Counts { passed: 3, failed: 1 });
        tally.test("another", || anyhow::bail!("nothing to run"));
        assert_eq!(tally.counts, Counts { passed: 3, failed: 2 });
    }
}
