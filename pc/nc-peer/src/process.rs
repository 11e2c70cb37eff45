//! Programs that are not waited for without end.

use anyhow::{Context, Result};
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// What a program says at most \[byte\].
const MOST: u64 = 256 << 20;

/// What came of a program that ended.
pub struct Ended {
    pub success: bool,
    pub out: String,
    pub err: String,
}

/// Runs it to its end; ends it after `limit`, and returns none then.
pub fn run(command: &mut Command, limit: Duration) -> Result<Option<Ended>> {
    let child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = child.with_context(|| format!("cannot run {}", command.get_program().display()))?;
    let out = child.stdout.take().map(listen);
    let err = child.stderr.take().map(listen);
    let Some(success) = wait(&mut child, limit)? else {
        return Ok(None);
    };
    let said = |listener: Option<thread::JoinHandle<String>>| {
        listener.and_then(|l| l.join().ok()).unwrap_or_default()
    };
    Ok(Some(Ended {
        success,
        out: said(out),
        err: said(err),
    }))
}

/// Whether it succeeded; none if it had to be ended.
fn wait(child: &mut Child, limit: Duration) -> Result<Option<bool>> {
    let end = Instant::now() + limit;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status.success()));
        }
        if Instant::now() > end {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(2));
    }
}

fn listen(from: impl Read + Send + 'static) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        // What was read before an error is what there is.
        let _ = from.take(MOST).read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_program_says_something_or_is_ended() {
        let mut shell = Command::new("sh");
        let ended = run(
            shell.args(["-c", "echo out; echo err >&2; exit 3"]),
            Duration::from_secs(60),
        );
        let Ended { success, out, err } = ended.expect("it runs").expect("it ends");
        assert_eq!((success, &out[..], &err[..]), (false, "out\n", "err\n"));
        let ended = run(Command::new("sleep").arg("600"), Duration::ZERO);
        assert!(ended.expect("it runs").is_none());
    }
}
