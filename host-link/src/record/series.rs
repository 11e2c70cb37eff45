//! Samples of one board by tick: the newest in memory, and those before them on their way into a spool.

use crate::spool::{Spool, Spooling, Writer};
use serde::Serialize;
use serde::de::DeserializeOwned;
use shared::protocol::{MotionSample, TrackerSample};
use std::collections::VecDeque;

/// Samples that a job finds at any time: 20 s, for the longest look back is that of teaching, 10 s. A datagram that is late has
/// been on its way for milliseconds; one of before that is no use any more.
pub(super) const NEWEST: usize = 20_000;
/// Samples that leave at once.
const BATCH: usize = 1000;

/// What a board tells each tick.
pub(super) trait Sample: Serialize + DeserializeOwned + Copy + Send + 'static {
    fn tick(&self) -> u32;
    fn time_us(&self) -> u64;
}

impl Sample for MotionSample {
    fn tick(&self) -> u32 {
        self.tick
    }

    fn time_us(&self) -> u64 {
        self.time_us
    }
}

impl Sample for TrackerSample {
    fn tick(&self) -> u32 {
        self.tick
    }

    fn time_us(&self) -> u64 {
        self.time_us
    }
}

#[derive(Debug)]
pub(super) struct Series<S> {
    newest: VecDeque<S>,
    /// Writes what has left `newest`.
    writer: Writer<S>,
    /// Ticks of the first and the last sample that have left.
    left: Option<(u32, u32)>,
}

impl<S: Sample> Series<S> {
    pub(super) fn new(spooling: Spooling) -> Self {
        Self {
            newest: VecDeque::new(),
            writer: Writer::new(spooling),
            left: None,
        }
    }

    pub(super) fn newest(&self) -> &VecDeque<S> {
        &self.newest
    }

    /// Puts `sample` at its place; the first of two with the same tick stays, and one that comes after those behind it have
    /// left is missing.
    pub(super) fn add(&mut self, sample: S) {
        let Some(last) = self.newest.back().map(S::tick) else {
            return self.newest.push_back(sample);
        };
        // Ticks begin anew after 49 days.
        let age = |tick: u32| i64::from(last.wrapping_sub(tick) as i32);
        if age(sample.tick()) < 0 {
            self.newest.push_back(sample);
            if self.newest.len() >= NEWEST + BATCH {
                self.hand_over();
            }
        } else if self.left.is_none_or(|(_, left)| age(sample.tick()) < age(left))
            && let Err(place) = self
                .newest
                .binary_search_by_key(&-age(sample.tick()), |s| -age(s.tick()))
        {
            self.newest.insert(place, sample);
        }
    }

    /// Gives the oldest to the writer.
    fn hand_over(&mut self) {
        let batch: Vec<S> = self.newest.drain(..BATCH).collect();
        let (first, last) = (batch[0].tick(), batch[BATCH - 1].tick());
        self.left = Some((self.left.map_or(first, |(first, _)| first), last));
        self.writer.hand_over(batch);
    }

    /// All samples, and how many ticks between the first and the last one are missing.
    pub(super) fn finish(self) -> (Spool<S>, u32) {
        let first = self.left.map(|(first, _)| first);
        let first = first.or(self.newest.front().map(S::tick));
        let last = self.newest.back().map(S::tick);
        let spool = self.writer.finish(self.newest);
        let ticks = first
            .zip(last)
            .map_or(0, |(first, last)| u64::from(last.wrapping_sub(first)) + 1);
        let missing = ticks.saturating_sub(spool.len());
        (spool, missing as u32)
    }
}
