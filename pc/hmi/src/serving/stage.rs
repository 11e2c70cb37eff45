//! What the station has the server show.

use crate::live::{Entry, Journal};
use crate::loaded::Loaded;
use crate::seen::Standing;
use host_link::events::Subscription;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// See the module. The station writes, the publisher takes.
#[derive(Clone, Debug, Default)]
pub struct Stage(Arc<Mutex<Shown>>);

/// What is shown.
#[derive(Debug, Default)]
struct Shown {
    standing: Standing,
    program: Option<Arc<Loaded>>,
    begun: Option<Begun>,
    /// Entries of the journal that were shown.
    added: u64,
    entries: Vec<Entry>,
    acknowledged: u64,
}

/// A job that begins.
#[derive(Debug)]
pub(super) struct Begun {
    /// Its events; none of a program that was only loaded.
    pub events: Option<Subscription>,
    /// It runs the program.
    pub is_of_program: bool,
}

/// What has changed since the publisher took it last.
#[derive(Debug)]
pub(super) struct Taken {
    pub standing: Standing,
    pub program: Option<Arc<Loaded>>,
    pub begun: Option<Begun>,
    pub entries: Vec<Entry>,
    /// How often open alarms were acknowledged, all those before `entries` too.
    pub acknowledged: u64,
}

impl Stage {
    /// How things stand at the station now.
    pub fn show(&self, standing: Standing, program: Option<&Arc<Loaded>>, journal: &Journal) {
        let mut shown = self.shown();
        shown.standing = standing;
        shown.program = program.cloned();
        if shown.acknowledged != journal.acknowledged() {
            shown.acknowledged = journal.acknowledged();
            let before = &mut shown.entries;
            before.iter_mut().for_each(|entry| entry.acknowledged = true);
        }
        let new: Vec<Entry> = journal.since(shown.added).cloned().collect();
        shown.entries.extend(new);
        shown.added = journal.added();
    }

    /// A job begins, with these events, of the program or by hand; without events it waits for its start.
    pub fn begin(&self, events: Option<Subscription>, is_of_program: bool) {
        self.shown().begun = Some(Begun {
            events,
            is_of_program,
        });
    }

    pub(super) fn take(&self) -> Taken {
        let mut shown = self.shown();
        Taken {
            standing: shown.standing.clone(),
            program: shown.program.clone(),
            begun: shown.begun.take(),
            entries: std::mem::take(&mut shown.entries),
            acknowledged: shown.acknowledged,
        }
    }

    fn shown(&self) -> MutexGuard<'_, Shown> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
