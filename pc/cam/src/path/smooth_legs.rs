//! Legs with their runs of short lines smoothed, as they come.

use super::PathError;
use super::blocks::Leg;
use super::elements::SAME;
use curves::smoothing::Smoother;
use shared::protocol::PathEvent;
use std::collections::VecDeque;

/// Smooths `legs`, each with how far off it that may be \[mm\]. What is switched at a path length is switched there, where
/// an element begins.
pub(super) struct SmoothLegs<I> {
    legs: I,
    smoother: Smoother,
    /// Of legs that have been read, and not been given yet.
    events: VecDeque<PathEvent>,
    /// Where the next one begins that is given \[mm\].
    s: f64,
    ended: bool,
    error: Option<PathError>,
}

impl<I: Iterator<Item = Result<(Leg, f64), PathError>>> SmoothLegs<I> {
    /// `legs` from `s` \[mm\] on, of a machine that goes round corners with an `acceleration` \[mm/s²\].
    pub(super) fn new(legs: I, s: f64, acceleration: f64) -> Self {
        Self {
            legs,
            smoother: Smoother::new(acceleration),
            events: VecDeque::new(),
            s,
            ended: false,
            error: None,
        }
    }

    fn read(&mut self) {
        match self.legs.next() {
            Some(Ok((Leg { events, element }, smoothing))) => {
                self.smoother.push(element, smoothing, !events.is_empty());
                self.events.extend(events);
            }
            Some(Err(error)) => (self.error, self.ended) = (Some(error), true),
            None => {
                self.smoother.finish();
                self.ended = true;
            }
        }
    }
}

impl<I: Iterator<Item = Result<(Leg, f64), PathError>>> Iterator for SmoothLegs<I> {
    type Item = Result<Leg, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(element) = self.smoother.pop() {
                self.s += element.length;
                let here = self.events.partition_point(|event| event.s_mm < self.s - SAME);
                let events = self.events.drain(..here).collect();
                return Some(Ok(Leg { events, element }));
            }
            if self.ended {
                return self.error.take().map(Err);
            }
            self.read();
        }
    }
}
