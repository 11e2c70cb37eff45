//! What happened, in a file that outlives the screen: a line as it happens, in English, written by a thread of its own, so that a
//! slow disk delays nothing.

use crate::access::Level;
use crate::live::{Earlier, Entry, Severity};
use crate::texts::{Language, Words};
use anyhow::{Context, anyhow};
use jiff::ZonedDateTime;
use std::collections::VecDeque;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::time::{Duration, Instant};

/// The file in the folder of the reports.
const NEWEST: &str = "record.tsv";
/// What it becomes when it is full.
const BEFORE: &str = "record.1.tsv";
/// Size at which it is full \[bytes\].
const FULL: u64 = 5_000_000;
/// Lines that may wait to be written.
const WAITING: usize = 1024;
/// Entries that are read back.
const READ_BACK: usize = 1000;
/// What closing the screen waits for lines that are not written yet.
const PATIENCE: Duration = Duration::from_secs(2);

/// See the module.
#[derive(Debug)]
pub struct Record {
    lines: Option<SyncSender<String>>,
    /// Why lines could not be written.
    failed: Receiver<anyhow::Error>,
    too_slow: bool,
    /// It has been told that lines could not be written.
    told: bool,
}

impl Record {
    /// The record in `folder`, which is made with the first entry.
    pub fn new(folder: PathBuf) -> Self {
        let (lines, waiting) = sync_channel::<String>(WAITING);
        let (fails, failed) = channel();
        std::thread::spawn(move || {
            for line in waiting {
                if let Err(error) = append(&folder, &line) {
                    // Nobody listens any more to a screen that is closed.
                    let _ = fails.send(error);
                }
            }
        });
        Self {
            lines: Some(lines),
            failed,
            too_slow: false,
            told: false,
        }
    }

    /// Adds `entry`, of now, at `level`.
    pub fn add(&mut self, entry: &Entry, level: Level) {
        let english = Words(Language::English);
        let time = ZonedDateTime::now().strftime("%Y-%m-%dT%H:%M:%S%:z");
        let text = one_line(&english.happened(&entry.what));
        let line = format!("{time}\t{}\t{level}\t{text}\n", name(entry.severity));
        if let Some(lines) = &self.lines {
            self.too_slow |= matches!(lines.try_send(line), Err(TrySendError::Full(_)));
        }
    }

    /// Why an entry could not be written; said once.
    pub fn trouble(&mut self) -> Option<anyhow::Error> {
        let failed = self.failed.try_iter().last();
        let slow = self.too_slow.then(|| anyhow!("the disk is too slow for it"));
        let trouble = failed.or(slow).filter(|_| !self.told)?;
        self.told = true;
        Some(trouble)
    }
}

/// What is not written yet is waited for, not for ever.
impl Drop for Record {
    fn drop(&mut self) {
        self.lines = None;
        let end = Instant::now() + PATIENCE;
        // The thread ends with its last line, and its end of this with it.
        while let Some(left) = end.checked_duration_since(Instant::now())
            && self.failed.recv_timeout(left).is_ok()
        {}
    }
}

/// The newest entries in `folder`, oldest first; a line that is none is passed over.
pub fn earlier(folder: &Path) -> Vec<Earlier> {
    let mut newest = VecDeque::with_capacity(READ_BACK);
    for name in [BEFORE, NEWEST] {
        let Ok(file) = File::open(folder.join(name)) else {
            continue;
        };
        // What is no text is a line that is none.
        let lines = BufReader::new(file.take(2 * FULL))
            .split(b'\n')
            .map_while(Result::ok);
        for entry in lines.filter_map(|line| read(str::from_utf8(&line).ok()?)) {
            if newest.len() == READ_BACK {
                newest.pop_front();
            }
            newest.push_back(entry);
        }
    }
    newest.into()
}

fn read(line: &str) -> Option<Earlier> {
    let mut fields = line.splitn(4, '\t');
    let (time, severity, level, text) = (fields.next()?, fields.next()?, fields.next()?, fields.next()?);
    let severities = [Severity::Note, Severity::Waits, Severity::Alarm];
    Some(Earlier {
        time: time.to_owned(),
        severity: severities.into_iter().find(|is| name(*is) == severity)?,
        level: level.to_owned(),
        text: text.to_owned(),
    })
}

fn name(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Waits => "waits",
        Severity::Alarm => "alarm",
    }
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r', '\t'], " ")
}

fn append(folder: &Path, line: &str) -> anyhow::Result<()> {
    let path = folder.join(NEWEST);
    let cannot = || format!("cannot write {}", path.display());
    std::fs::create_dir_all(folder).with_context(cannot)?;
    if path.metadata().is_ok_and(|file| file.len() >= FULL) {
        std::fs::rename(&path, folder.join(BEFORE)).with_context(cannot)?;
    }
    let write = || {
        let mut options = OpenOptions::new();
        let mut file = options.read(true).append(true).create(true).open(&path)?;
        // A line that was cut by a loss of power ends here.
        let cut = if ends_a_line(&mut file)? { "" } else { "\n" };
        file.write_all(format!("{cut}{line}").as_bytes())?;
        file.sync_data()
    };
    write().with_context(cannot)
}

fn ends_a_line(file: &mut File) -> std::io::Result<bool> {
    if file.metadata()?.len() == 0 {
        return Ok(true);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}

#[cfg(test)]
mod tests;
