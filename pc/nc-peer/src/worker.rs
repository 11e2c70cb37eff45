//! Our interpreter in a process of its own, which can be ended: a hang or a crash there is a finding, not the end.

use crate::ours::{self, Outcome};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::panic;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Mutex;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Most memory of it \[KiB\].
const MEMORY_KIB: u64 = 4 << 20;

/// What came of a program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    Outcome(Outcome),
    /// What the panic says.
    Panic(String),
    /// It took too long.
    Hang,
    /// The process ended: stack or memory ran out.
    Crash,
}

/// What the process does: reads the programs that standard input names, a path to a line, and prints an answer to each.
pub fn serve() -> Result<()> {
    static LAST: Mutex<String> = Mutex::new(String::new());
    panic::set_hook(Box::new(|info| {
        if let Ok(mut last) = LAST.lock() {
            *last = info.to_string();
        }
    }));
    let mut out = io::stdout().lock();
    for line in io::stdin().lock().lines() {
        let file = PathBuf::from(line?);
        let answer = match panic::catch_unwind(|| ours::read(&file)) {
            Ok(outcome) => Answer::Outcome(outcome),
            Err(_) => Answer::Panic(LAST.lock().map(|last| last.clone()).unwrap_or_default()),
        };
        serde_json::to_writer(&mut out, &answer)?;
        out.write_all(b"\n")?;
        out.flush()?;
    }
    Ok(())
}

/// The process, as others see it.
pub struct Worker {
    limit: Duration,
    process: Option<Process>,
}

struct Process {
    child: Child,
    input: ChildStdin,
    answers: Receiver<String>,
}

impl Worker {
    /// One that takes no longer than `limit` for a program.
    pub fn new(limit: Duration) -> Self {
        Self { limit, process: None }
    }

    /// What our interpreter says of a program.
    pub fn read(&mut self, file: &Path) -> Result<Answer> {
        let mut process = match self.process.take() {
            Some(process) => process,
            None => Process::start()?,
        };
        let before = process.used();
        let asked = writeln!(process.input, "{}", file.display()).and_then(|()| process.input.flush());
        let answer = match asked {
            Ok(()) => process.answer(before, self.limit),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        };
        Ok(match answer {
            Ok(line) => {
                self.process = Some(process);
                serde_json::from_str(&line).context("an answer of the interpreter's process")?
            }
            Err(RecvTimeoutError::Timeout) => Answer::Hang,
            Err(RecvTimeoutError::Disconnected) => Answer::Crash,
        })
    }
}

impl Process {
    /// Its answer, for which it takes no longer than `limit` of the time of a processor from `before` on: how many others there
    /// are does not matter. One that waits without working has a hundred times as long.
    fn answer(&self, before: Duration, limit: Duration) -> Result<String, RecvTimeoutError> {
        for _ in 0..100 {
            match self.answers.recv_timeout(limit) {
                Err(RecvTimeoutError::Timeout) if self.used().saturating_sub(before) < limit => {}
                answer => return answer,
            }
        }
        Err(RecvTimeoutError::Timeout)
    }

    /// Time of a processor that it has used so far; none where the system does not tell.
    fn used(&self) -> Duration {
        let told = fs::read_to_string(format!("/proc/{}/schedstat", self.child.id()));
        let nanoseconds = told.ok().and_then(|told| told.split(' ').next()?.parse().ok());
        Duration::from_nanos(nanoseconds.unwrap_or_default())
    }

    fn start() -> Result<Self> {
        let limited = format!("ulimit -v {MEMORY_KIB} && exec \"$0\" worker");
        let child = Command::new("sh")
            .args(["-c", &limited])
            .arg(std::env::current_exe()?)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut child = child.context("cannot start the interpreter's process")?;
        let input = child.stdin.take().context("a process without input")?;
        let output = child.stdout.take().context("a process without output")?;
        let (sender, answers) = mpsc::channel();
        thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Ok(Self {
            child,
            input,
            answers,
        })
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
