//! How much of a program was run again, so that one without an end is told soon.

use std::collections::BTreeMap;

/// Most lines that are run again, besides each line once: a second of a common computer.
const MOST: u64 = 400_000;
/// A line of more bytes counts as several.
const BYTES: usize = 64;
/// So many motions of one line cost about as much as another line.
const MOTIONS: u64 = 4;

/// What was run for the first time, and again.
#[derive(Clone, Debug, Default)]
pub(super) struct Effort {
    /// The last line that was read of the program, and of other files.
    program: u32,
    files: BTreeMap<String, u32>,
    lines: u64,
    again: u64,
}

impl Effort {
    /// `line` of the program or of another file is read, of so many bytes, where lines `may_repeat`.
    pub(super) fn line(&mut self, file: Option<&str>, line: u32, bytes: usize, may_repeat: bool) {
        let last = match file {
            None => &mut self.program,
            Some(file) if self.files.contains_key(file) => self.files.get_mut(file).expect("it is there"),
            Some(file) => self.files.entry(file.to_owned()).or_default(),
        };
        if line > *last {
            *last = line;
            self.lines += 1;
        } else if may_repeat {
            self.again += 1 + (bytes / BYTES) as u64;
        }
    }

    /// The line made so many motions.
    pub(super) fn motions(&mut self, count: u64) {
        self.again += count / MOTIONS;
    }

    /// How many lines may be run again, if there were more.
    pub(super) fn exceeded(&self) -> Option<u64> {
        let most = MOST + self.lines;
        (self.again > most).then_some(most)
    }
}
