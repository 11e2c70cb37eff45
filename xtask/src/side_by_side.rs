//! Test programs side by side: cargo runs them one after the other, and one long test at the end of a program leaves all other
//! cores idle.

use crate::cargo::{cargo, root};
use crate::tally::{Counts, watch};
use anyhow::{Context, Result, ensure};
use emulator::bound_to_parent;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Mutex;
use std::thread;

/// A program with tests.
struct Program {
    file: PathBuf,
    /// Where its tests look for their files.
    package: PathBuf,
}

/// Runs the tests that `cargo test` has with this `selection`, as many programs at a time as there are cores, then those in the
/// documentation; what they counted, and whether all ended well.
pub fn run(selection: &[&str]) -> Result<(Counts, bool)> {
    let mut programs = built(selection)?;
    // Taken from its end, the queue gives the largest first: programs in which much is linked are those that run jobs.
    programs.sort_by_key(|program| program.file.metadata().map_or(0, |file| file.len()));
    let (queue, total) = (Mutex::new(programs), Mutex::new((Counts::default(), true)));
    let lanes = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        let lane = || -> Result<()> {
            loop {
                let next = queue.lock().expect("no lane panics").pop();
                let Some(program) = next else { return Ok(()) };
                let (counts, succeeded) = program.run()?;
                let mut total = total.lock().expect("no lane panics");
                total.0.add(counts);
                total.1 &= succeeded;
            }
        };
        let lanes: Vec<_> = (0..lanes).map(|_| scope.spawn(lane)).collect();
        lanes
            .into_iter()
            .try_for_each(|lane| lane.join().expect("no lane panics"))
    })?;
    let (mut counts, succeeded) = total.into_inner().expect("no lane panics");
    let (documented, also) = watch(cargo(&[&["test", "--doc"], selection].concat())?)?;
    counts.add(documented);
    Ok((counts, succeeded && also))
}

/// Builds the test programs.
fn built(selection: &[&str]) -> Result<Vec<Program>> {
    let build = ["test", "--no-run", "--message-format=json-render-diagnostics"];
    let output = cargo(&[&build[..], selection].concat())?
        .stderr(Stdio::inherit())
        .output()
        .context("cannot run cargo test")?;
    ensure!(output.status.success(), "the tests do not build");
    let messages = String::from_utf8_lossy(&output.stdout);
    Ok(messages.lines().filter_map(Program::from_message).collect())
}

impl Program {
    /// That of a message of cargo; `None` if it tells of anything else.
    fn from_message(line: &str) -> Option<Self> {
        let message: Value = serde_json::from_str(line).ok()?;
        if message["profile"]["test"] != true {
            return None;
        }
        let manifest = Path::new(message["manifest_path"].as_str()?);
        Some(Self {
            file: message["executable"].as_str()?.into(),
            package: manifest.parent()?.to_owned(),
        })
    }

    /// Runs its tests one by one, and shows all that it printed at its end.
    fn run(&self) -> Result<(Counts, bool)> {
        let output = bound_to_parent(&self.file)
            .arg("--test-threads=1")
            .current_dir(&self.package)
            .env("CARGO_MANIFEST_DIR", &self.package)
            .output()
            .with_context(|| format!("cannot run {}", self.file.display()))?;
        let said = String::from_utf8_lossy(&output.stdout);
        let name = self.file.strip_prefix(root()).unwrap_or(&self.file).display();
        let errors = String::from_utf8_lossy(&output.stderr);
        print!("     Running {name}\n{said}{errors}");
        let mut counts = Counts::default();
        said.lines()
            .filter_map(Counts::from_line)
            .for_each(|more| counts.add(more));
        let succeeded = output.status.success();
        if !succeeded && counts.failed == 0 {
            // It died before it could count.
            counts.failed = 1;
        }
        Ok((counts, succeeded))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_those_with_tests() {
        let test = r#"{"reason":"compiler-artifact","manifest_path":"/a/b/Cargo.toml","profile":{"test":true},"executable":"/t/b-1"}"#;
        let program = Program::from_message(test).expect("a program");
        assert_eq!((program.file, program.package), ("/t/b-1".into(), "/a/b".into()));
        for other in [
            r#"{"reason":"compiler-artifact","manifest_path":"/a/Cargo.toml","profile":{"test":false},"executable":"/t/a"}"#,
            r#"{"reason":"compiler-artifact","manifest_path":"/a/Cargo.toml","profile":{"test":true},"executable":null}"#,
            r#"{"reason":"build-finished","success":true}"#,
            "no message",
        ] {
            assert!(Program::from_message(other).is_none(), "{other}");
        }
    }

    #[test]
    fn what_a_program_counts_is_added_up_and_one_that_dies_is_a_failure() {
        let folder = tempfile::tempdir().expect("a folder");
        let run = |script: &str| {
            let file = folder.path().join("program");
            std::fs::write(&file, format!("#!/bin/sh\n{script}")).expect("a file");
            let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
            std::fs::set_permissions(&file, mode).expect("a file");
            let program = Program {
                file,
                package: folder.path().to_owned(),
            };
            program.run().expect("it runs")
        };
        let (counts, succeeded) = run("echo 'test result: ok. 3 passed; 0 failed; 1 ignored'");
        assert_eq!((counts.passed, counts.failed, succeeded), (3, 0, true));
        let (counts, succeeded) = run("echo 'test one ... ok'; kill -9 $$");
        assert_eq!((counts.passed, counts.failed, succeeded), (0, 1, false));
    }
}
