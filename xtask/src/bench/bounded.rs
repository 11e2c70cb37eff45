//! A program that is not waited for without end.

use anyhow::{Context, Result, bail};
use emulator::bound_to_parent;
use std::fs::{self, File};
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

/// Runs `program` in `folder` to its end, or ends it after `limit`. What it says is returned, and stays in the file
/// `console` of the folder.
pub fn run(
    program: &str,
    arguments: &[String],
    folder: &Path,
    console: &str,
    limit: Duration,
) -> Result<String> {
    watched(program, arguments, folder, console, limit, |_| {})
}

/// The same, and says to standard error what the program says, when it does.
pub fn run_aloud(
    program: &str,
    arguments: &[String],
    folder: &Path,
    console: &str,
    limit: Duration,
) -> Result<String> {
    let mut said = 0;
    watched(program, arguments, folder, console, limit, |console| {
        // What cannot be read now, in the middle of a letter perhaps, is read later.
        let all = fs::read_to_string(console).unwrap_or_default();
        if let Some((lines, _)) = all.get(said..).and_then(|new| new.rsplit_once('\n')) {
            eprintln!("{lines}");
            said += lines.len() + 1;
        }
    })
}

/// Runs a program; calls `watch` with the file of what it says from time to time, and at its end.
fn watched(
    program: &str,
    arguments: &[String],
    folder: &Path,
    console: &str,
    limit: Duration,
    mut watch: impl FnMut(&Path),
) -> Result<String> {
    let console = folder.join(console);
    let output = File::create(&console).with_context(|| format!("cannot write {}", console.display()))?;
    let mut child = bound_to_parent(program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(output.try_clone()?)
        .stderr(output)
        .spawn()
        .with_context(|| format!("cannot run {program}"))?;
    let end = Instant::now() + limit;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if Instant::now() > end {
            child.kill()?;
            child.wait()?;
            bail!(
                "{program} was ended after {} s; see {}",
                limit.as_secs(),
                console.display()
            );
        }
        watch(&console);
        thread::sleep(Duration::from_millis(20));
    };
    let said = fs::read_to_string(&console).with_context(|| format!("cannot read {}", console.display()))?;
    watch(&console);
    if !status.success() {
        bail!("{program} failed ({status}):\n{said}");
    }
    Ok(said)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str, limit: Duration) -> Result<String> {
        let folder = tempfile::tempdir().expect("a folder");
        run(
            "sh",
            &["-c".into(), script.into()],
            folder.path(),
            "console",
            limit,
        )
    }

    #[test]
    fn what_is_said_comes_back_or_tells_why_not() {
        let minute = Duration::from_secs(60);
        assert_eq!(
            shell("echo out; echo err >&2", minute).expect("it runs"),
            "out\nerr\n"
        );
        let error = shell("echo why; exit 3", minute).unwrap_err().to_string();
        assert!(error.contains("why"), "{error}");
    }

    #[test]
    fn a_program_that_does_not_end_is_ended() {
        let error = shell("exec sleep 600", Duration::ZERO).unwrap_err().to_string();
        assert!(error.contains("was ended"), "{error}");
    }
}
