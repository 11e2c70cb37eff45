//! What happened, for the operator: newest last, the oldest forgotten beyond a bound.

use crate::access::Event;
use config::parameters::Change;
use host_link::events::{Phase, Question, STOPPED};
use serde::{Deserialize, Serialize};
use shared::protocol::Identity;
use shared::state::{Fault, TrackerFault};
use std::collections::VecDeque;
use std::time::Duration;

/// Entries that are kept.
const KEPT: usize = 1000;

/// How much an entry matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Severity {
    /// To be read back.
    Note,
    /// The machine waits for the operator.
    Waits,
    /// The machine has stopped by itself, or a job ended early.
    Alarm,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// When, by the screen's clock.
    pub at: Duration,
    /// How much it matters.
    pub severity: Severity,
    /// What.
    pub what: What,
    /// The operator has taken note of it.
    pub acknowledged: bool,
}

/// An entry of a day before, or of a screen before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Earlier {
    /// Wall time after RFC 3339.
    pub time: String,
    /// How much it mattered.
    pub severity: Severity,
    /// The level that somebody at the screen had.
    pub level: String,
    /// What, in English.
    pub text: String,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum What {
    /// A part of a job began.
    Phase(Phase),
    /// The machine waits.
    Question(Question),
    /// The boards are connected: their firmware.
    Connected(Vec<String>),
    /// A job came to its end.
    Finished,
    /// The motion board has stopped.
    MotionFault(Fault),
    /// The tracker board has stopped the weld.
    TrackerFault(TrackerFault),
    /// The operator has stopped the job.
    Stopped,
    /// A file was written that was not there before: its name.
    FileMade(String),
    /// A file was written: its name, and where what was there before is kept.
    FileWritten(String, String),
    /// With another value of a parameter.
    Parameter(Change),
    /// Another access level or PIN, or none.
    Access(Event),
    /// The record cannot be written, and why.
    RecordUnwritten(String),
    /// The settings of the screen cannot be read, and why.
    SettingsUnread(String),
    /// The settings of the screen cannot be written, and why.
    SettingsUnwritten(String),
    /// In words of the job or of the program, in English.
    Said(String),
}

impl What {
    /// In English, as the boards and the job say it.
    fn said(&self) -> Option<String> {
        match self {
            Self::MotionFault(fault) => Some(fault.to_string()),
            Self::TrackerFault(fault) => Some(fault.to_string()),
            Self::Said(text) => Some(text.clone()),
            _ => None,
        }
    }
}

/// All that happened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Journal {
    entries: VecDeque<Entry>,
    /// Those that nobody has put on record yet.
    unrecorded: VecDeque<Entry>,
    /// How many there ever were.
    added: u64,
    /// How often open alarms were acknowledged.
    acknowledged: u64,
}

impl Journal {
    fn add(&mut self, at: Duration, severity: Severity, what: What) {
        let entry = Entry {
            at,
            severity,
            what,
            acknowledged: severity < Severity::Alarm,
        };
        keep(&mut self.unrecorded, entry.clone());
        self.append(entry);
    }

    /// An entry that another screen has put on record.
    pub fn append(&mut self, entry: Entry) {
        keep(&mut self.entries, entry);
        self.added += 1;
    }

    /// How many entries there ever were.
    pub fn added(&self) -> u64 {
        self.added
    }

    /// How often open alarms were acknowledged.
    pub fn acknowledged(&self) -> u64 {
        self.acknowledged
    }

    /// Those that came after the first `added`, as far as they are kept, oldest first.
    pub fn since(&self, added: u64) -> impl Iterator<Item = &Entry> {
        let new = usize::try_from(self.added - added.min(self.added)).unwrap_or(usize::MAX);
        self.entries.range(self.entries.len().saturating_sub(new)..)
    }

    /// What is to be put on record, oldest first; once.
    pub fn take_unrecorded(&mut self) -> VecDeque<Entry> {
        std::mem::take(&mut self.unrecorded)
    }

    /// Another access level or PIN, or none.
    pub fn access(&mut self, at: Duration, event: Event) {
        self.add(at, Severity::Note, What::Access(event));
    }

    /// The record cannot be written.
    pub fn record_unwritten(&mut self, at: Duration, error: &str) {
        self.add(at, Severity::Note, What::RecordUnwritten(error.to_owned()));
    }

    /// The settings of the screen cannot be read.
    pub fn settings_unread(&mut self, at: Duration, error: &str) {
        self.add(at, Severity::Alarm, What::SettingsUnread(error.to_owned()));
    }

    /// The settings of the screen cannot be written.
    pub fn settings_unwritten(&mut self, at: Duration, error: &str) {
        self.add(at, Severity::Alarm, What::SettingsUnwritten(error.to_owned()));
    }

    pub(super) fn connected(&mut self, at: Duration, motion: Option<&Identity>, tracker: Option<&Identity>) {
        let named = motion.into_iter().chain(tracker);
        let firmware = named.map(|board| format!("{} {}", board.board, board.firmware));
        self.add(at, Severity::Note, What::Connected(firmware.collect()));
    }

    pub(super) fn phase(&mut self, at: Duration, phase: Phase) {
        self.add(at, Severity::Note, What::Phase(phase));
    }

    pub(super) fn question(&mut self, at: Duration, question: &Question) {
        self.add(at, Severity::Waits, What::Question(question.clone()));
    }

    /// Something in words of the job or of the program, in English.
    pub fn message(&mut self, at: Duration, text: &str) {
        self.add(at, Severity::Note, What::Said(text.to_owned()));
    }

    pub(super) fn motion_fault(&mut self, at: Duration, fault: Fault) {
        self.add(at, Severity::Alarm, What::MotionFault(fault));
    }

    pub(super) fn tracker_fault(&mut self, at: Duration, fault: TrackerFault) {
        self.add(at, Severity::Alarm, What::TrackerFault(fault));
    }

    /// Something is wrong that the operator has to know. What an open alarm says already is not said again.
    pub fn alarm(&mut self, at: Duration, text: &str) {
        let again = |entry: &Entry| entry.what.said().is_some_and(|said| text.ends_with(&said));
        if !self.open_alarms().any(again) {
            self.add(at, Severity::Alarm, What::Said(text.to_owned()));
        }
    }

    /// `file` was written with `changes`; what was there before, if anything, is in `version`.
    pub fn written(&mut self, at: Duration, file: String, version: Option<String>, changes: &[Change]) {
        let what = match version {
            Some(version) => What::FileWritten(file, version),
            None => What::FileMade(file),
        };
        self.add(at, Severity::Note, what);
        self.changed(at, changes);
    }

    /// Values are others now.
    pub fn changed(&mut self, at: Duration, changes: &[Change]) {
        for change in changes {
            self.add(at, Severity::Note, What::Parameter(change.clone()));
        }
    }

    pub(super) fn end(&mut self, at: Duration, error: Option<&str>) {
        match error {
            None => self.add(at, Severity::Note, What::Finished),
            Some(error) if error == STOPPED => {
                self.add(at, Severity::Alarm, What::Stopped);
            }
            // The job's sentence ends with the fault's, which is told already.
            Some(error) => self.alarm(at, error),
        }
    }

    /// All entries, oldest first.
    pub fn entries(&self) -> impl DoubleEndedIterator<Item = &Entry> {
        self.entries.iter()
    }

    /// Alarms that nobody has taken note of yet, oldest first.
    pub fn open_alarms(&self) -> impl DoubleEndedIterator<Item = &Entry> {
        self.entries().filter(|entry| !entry.acknowledged)
    }

    /// The operator has taken note of all alarms.
    pub fn acknowledge(&mut self) {
        let any_is_open = self.open_alarms().next().is_some();
        self.acknowledged += u64::from(any_is_open);
        self.entries
            .iter_mut()
            .for_each(|entry| entry.acknowledged = true);
    }
}

fn keep(entries: &mut VecDeque<Entry>, entry: Entry) {
    if entries.len() == KEPT {
        entries.pop_front();
    }
    entries.push_back(entry);
}
