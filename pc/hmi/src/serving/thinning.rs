//! Events of the job, and the stage, as messages that one viewer can take: changes only, few ticks of many with their extremes, small
//! pictures as often as the rest leaves room for.

use super::budget::Budget;
use super::stage::Taken;
use super::ticks;
use crate::drawn::Listing;
use crate::live::{Deviations, Journal, Live, Signals};
use crate::loaded::Loaded;
use crate::seen::Standing;
use crate::viewing::picture::SentPicture;
use crate::viewing::wire::{Message, Update};
use host_link::events::{Event, Phase, Question};
use shared::io::SIDES;
use shared::protocol::{MotionSample, TrackerSample};
use std::sync::Arc;
use std::time::Duration;

/// Time between two pictures of a camera.
const PICTURES: Duration = Duration::from_millis(200);
/// Ticks of the motion board in a message.
const TICKS: usize = 4;
/// A viewer that comes is told this much of the signals \[s\].
const SIGNALS_S: f64 = 5.0;
/// Ticks of the motion board in it.
const FIRST_TICKS: usize = 250;
/// Pieces of the ticks of the tracker board in it.
const FIRST_PIECES: usize = 30;
/// Lines of a program that are told.
const LINES: usize = 400;
/// They are told anew where fewer than these are left before or after the current one.
const LINES_LEFT: usize = 50;
/// Characters of a line that are told.
const CHARACTERS: usize = 200;
/// Ticks of a board that wait for a message: 4 s, more than the publisher ever leaves.
const WAITING: usize = 4096;

/// See the module.
#[derive(Debug, Default)]
pub(super) struct Thinner {
    live: Live,
    standing: Standing,
    program: Option<Arc<Loaded>>,
    is_of_program: bool,
    journal: Journal,
    /// How often the station's alarms were acknowledged.
    acknowledged: u64,
    motion: Vec<MotionSample>,
    tracker: Vec<TrackerSample>,
    /// What viewers know that were told all changes.
    told: Told,
    /// When the latest picture of each camera was sent.
    pictured: [Option<Duration>; SIDES],
    budget: Budget,
}

/// What was told.
#[derive(Debug, Default)]
struct Told {
    /// Jobs that have begun.
    begun: bool,
    standing: Option<Standing>,
    program: Option<Arc<Loaded>>,
    /// First of the lines of the program that were told, and how many.
    lines: Option<(usize, usize)>,
    doing: Option<Doing>,
    /// The state of the boards is told as it was read.
    status: bool,
    deviations: Deviations,
    happened: u64,
    /// How often alarms were acknowledged.
    acknowledged: u64,
    /// Captures of the pictures.
    pictures: [Option<u32>; SIDES],
}

#[derive(Clone, Debug, PartialEq)]
struct Doing {
    phase: Option<Phase>,
    question: Option<Question>,
    told: Option<String>,
    has_ended: bool,
}

impl Thinner {
    /// Takes what the station shows.
    pub fn stage(&mut self, taken: Taken) {
        self.standing = taken.standing;
        self.program = taken.program;
        if self.acknowledged != taken.acknowledged {
            self.acknowledged = taken.acknowledged;
            self.journal.acknowledge();
        }
        taken
            .entries
            .into_iter()
            .for_each(|entry| self.journal.append(entry));
        if let Some(begun) = taken.begun {
            let program = self.program.as_ref().filter(|_| begun.is_of_program);
            let along = program.map(|loaded| loaded.drawn.way.along.clone());
            self.live = Live::new(along.unwrap_or_default(), Journal::default());
            self.live.signals = Signals::keeping(SIGNALS_S);
            self.is_of_program = begun.is_of_program;
            (self.told.begun, self.told.status) = (false, false);
            self.told.deviations = Deviations::default();
            self.motion.clear();
            self.tracker.clear();
        }
    }

    /// Takes an event of the job.
    pub fn take(&mut self, event: &Event, now: Duration) {
        self.live.take(event, now);
        match event {
            Event::MotionSamples(samples) => keep(&mut self.motion, samples),
            Event::TrackerSamples(samples) => keep(&mut self.tracker, samples),
            Event::Status { .. } => self.told.status = false,
            _ => {}
        }
    }

    /// What has changed since it was asked last, and after it everything, for those who know nothing yet.
    pub fn changes(&mut self, now: Duration) -> Message {
        self.budget.fill(now);
        let mut told = std::mem::take(&mut self.told);
        let mut updates = self.updates(&mut told);
        updates.extend(self.told_ticks(
            ticks::of_motion(&self.motion, TICKS),
            ticks::of_tracker(&self.tracker),
        ));
        self.motion.clear();
        self.tracker.clear();
        if self.budget.is_left() {
            let due = |side: &usize| {
                let before = self.pictured[*side];
                before.is_none_or(|before| now.saturating_sub(before) >= PICTURES)
            };
            let due: Vec<usize> = (0..SIDES).filter(due).collect();
            for side in due {
                let picture = self.picture(&mut told, side);
                if picture.is_some() {
                    self.pictured[side] = Some(now);
                }
                updates.extend(picture);
            }
        }
        self.told = told;
        self.message(false, now, updates)
    }

    /// Nobody watches: ticks that wait for a message are dropped. Who comes is told [`Self::all`].
    pub fn tell_nobody(&mut self) {
        self.motion.clear();
        self.tracker.clear();
    }

    /// All that there is.
    pub fn all(&self, now: Duration) -> Message {
        let mut told = Told::default();
        let mut updates = self.updates(&mut told);
        let (motion, tracker) = self.live.signals.newest(SIGNALS_S);
        let pieces = tracker.chunks(tracker.len().div_ceil(FIRST_PIECES).max(1));
        updates.extend(self.told_ticks(
            ticks::of_motion(&motion, FIRST_TICKS),
            pieces.flat_map(ticks::of_tracker).collect(),
        ));
        updates.extend((0..SIDES).filter_map(|side| self.picture(&mut told, side)));
        self.message(true, now, updates)
    }

    /// `bytes` have gone to each viewer.
    pub fn sent(&mut self, bytes: usize) {
        self.budget.spend(bytes);
    }

    fn message(&self, is_all: bool, now: Duration, updates: Vec<Update>) -> Message {
        Message {
            is_all,
            at: now,
            heard_before: self.live.heard().map(|heard| now.saturating_sub(heard)),
            updates,
        }
    }

    /// What is not `told` yet, but for ticks and pictures; it is then.
    fn updates(&self, told: &mut Told) -> Vec<Update> {
        let mut updates = Vec::new();
        let is_same = match (&told.program, &self.program) {
            (Some(told), Some(program)) => Arc::ptr_eq(told, program),
            (None, None) => true,
            _ => false,
        };
        if !is_same {
            let drawn = self
                .program
                .as_ref()
                .map(|loaded| Box::new(loaded.drawn.without_lines()));
            updates.push(Update::Program(drawn));
            (told.program, told.lines) = (self.program.clone(), None);
        }
        if !told.begun {
            updates.push(Update::Begins {
                is_of_program: self.is_of_program,
            });
            told.begun = true;
        }
        updates.extend(self.listing(told));
        if told.standing.as_ref() != Some(&self.standing) {
            updates.push(Update::Standing(self.standing.clone()));
            told.standing = Some(self.standing.clone());
        }
        let doing = Doing {
            phase: self.live.phase,
            question: self.live.question.clone(),
            told: self.live.told.clone(),
            has_ended: self.live.ended,
        };
        if told.doing.as_ref() != Some(&doing) {
            told.doing = Some(doing.clone());
            let Doing {
                phase,
                question,
                told,
                has_ended,
            } = doing;
            updates.push(Update::Doing {
                phase,
                question,
                told,
                has_ended,
            });
        }
        if let Some(motion) = self.live.motion.clone().filter(|_| !told.status) {
            let tracker = self.live.tracker.clone();
            updates.push(Update::Status { motion, tracker });
            told.status = true;
        }
        if let Some(changed) = self.live.deviations.since(&told.deviations) {
            updates.push(Update::Deviations(changed));
            told.deviations.clone_from(&self.live.deviations);
        }
        updates.extend(self.happened(told));
        updates
    }

    fn happened(&self, told: &mut Told) -> Option<Update> {
        let entries: Vec<_> = self.journal.since(told.happened).cloned().collect();
        let is_acknowledged = told.acknowledged != self.journal.acknowledged();
        (told.happened, told.acknowledged) = (self.journal.added(), self.journal.acknowledged());
        (is_acknowledged || !entries.is_empty()).then_some(Update::Happened {
            is_acknowledged,
            entries,
        })
    }

    /// Lines around the current one, where those that were told do not have it well inside.
    fn listing(&self, told: &mut Told) -> Option<Update> {
        let all = &self.program.as_ref()?.drawn.listing;
        let line = self.live.motion.as_ref().map_or(0, |motion| motion.line as usize);
        let line = line.min(all.count);
        let is_inside = |(first, count): (usize, usize)| {
            let end = first + count;
            (first == 0 || line >= first + LINES_LEFT) && (end == all.count || line + LINES_LEFT <= end)
        };
        if told.lines.is_some_and(is_inside) {
            return None;
        }
        let last = all.count.saturating_sub(LINES);
        let first = line.saturating_sub(LINES / 2).min(last);
        let end = (first + LINES).min(all.count);
        told.lines = Some((first, end - first));
        let short = |line: &str| line.chars().take(CHARACTERS).collect();
        Some(Update::Listing(Listing {
            count: all.count,
            first,
            lines: (first..end)
                .filter_map(|line| all.line(line))
                .map(short)
                .collect(),
        }))
    }

    fn told_ticks(
        &self,
        motion: Vec<MotionSample>,
        ticks: Vec<TrackerSample>,
    ) -> impl Iterator<Item = Update> + use<> {
        let ahead_us = self.live.signals.tracker_ahead_us();
        let motion = (!motion.is_empty()).then_some(Update::Motion(motion));
        let tracker = (!ticks.is_empty()).then_some(Update::Tracker { ticks, ahead_us });
        motion.into_iter().chain(tracker)
    }

    /// The latest picture of a camera, if it is not told yet.
    fn picture(&self, told: &mut Told, side: usize) -> Option<Update> {
        let picture = self.live.pictures[side].as_ref()?;
        if told.pictures[side] == Some(picture.capture) {
            return None;
        }
        told.pictures[side] = Some(picture.capture);
        SentPicture::of(picture).map(Update::Picture)
    }
}

/// Keeps the newest.
fn keep<T: Copy>(kept: &mut Vec<T>, new: &[T]) {
    kept.extend_from_slice(new);
    let excess = kept.len().saturating_sub(WAITING);
    kept.drain(..excess);
}

#[cfg(test)]
mod tests;
