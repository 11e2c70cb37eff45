//! How paths reach the planner: as the PC gives them to the motion board, a request a millisecond.

use super::DryRunError;
use crate::path::{Leg, PathError, PlannedPath};
use shared::protocol::{LOAD_BATCH, LOAD_ELEMENTS, LOAD_EVENTS, TELEMETRY_BATCH};
use shared::trajectory::{BoardPlanner, Element};

/// Ticks that a request and its answer take.
const REQUEST: u32 = 1;
/// Ticks between two looks at a board that had no room.
const ASK: u32 = 10;
/// Ticks at rest that the board is on the path.
pub const ARRIVED: u32 = 2;
/// Ticks from there until the PC knows of it: one more, half a batch of telemetry, and a request for the state.
const KNOWN: u32 = 1 + (TELEMETRY_BATCH as u32).div_ceil(2) + REQUEST;

/// Ticks from the end of a path to the first one of `path`, whose start took `requests`.
pub fn ticks_between(path: &PlannedPath, requests: u32, tracker: bool) -> u64 {
    let knots = if tracker {
        1 + path.knots.len().div_ceil(LOAD_BATCH) as u32
    } else {
        0
    };
    dwell_ticks(path) + u64::from(KNOWN + REQUEST * (requests + knots))
}

/// Ticks that the PC waits before a path.
pub fn dwell_ticks(path: &PlannedPath) -> u64 {
    if path.dwell_before_s > 0.0 {
        // It asks for the time first, and telemetry comes in batches.
        (path.dwell_before_s * 1e3).ceil() as u64 + u64::from(REQUEST) + TELEMETRY_BATCH as u64 / 2
    } else {
        0
    }
}

/// A path on its way to the planner.
pub struct Stream<I> {
    legs: I,
    /// Elements that go next.
    batch: Vec<Element>,
    /// How many events on them have not gone yet.
    events: usize,
    /// Ticks until the next request.
    wait: u32,
}

impl<I: Iterator<Item = Result<Leg, PathError>>> Stream<I> {
    /// Of the legs that a path is given as.
    pub fn new(legs: I) -> Self {
        Self {
            legs,
            batch: Vec::new(),
            events: 0,
            wait: ASK,
        }
    }

    /// Those that have not gone yet.
    pub fn legs(&self) -> &I {
        &self.legs
    }

    /// Gives all that the planner has room for before the path begins; how many requests that and the beginning take.
    pub fn begin(
        &mut self,
        planner: &mut BoardPlanner,
        mut given: impl FnMut(&Element),
    ) -> Result<u32, DryRunError> {
        // To begin the path, to ask for room, to run it.
        let mut requests = 3;
        while self.send(planner, &mut given)? {
            requests += 1;
        }
        Ok(requests)
    }

    /// One tick while the path runs.
    pub fn tick(
        &mut self,
        planner: &mut BoardPlanner,
        mut given: impl FnMut(&Element),
    ) -> Result<(), DryRunError> {
        self.wait = self.wait.saturating_sub(1);
        if self.wait == 0 && !self.send(planner, &mut given)? {
            // The question itself is a request.
            self.wait = ASK + REQUEST;
        }
        Ok(())
    }

    /// One request, if there is something that the planner has room for.
    fn send(
        &mut self,
        planner: &mut BoardPlanner,
        given: &mut impl FnMut(&Element),
    ) -> Result<bool, DryRunError> {
        while self.batch.len() < LOAD_ELEMENTS
            && self.events < LOAD_EVENTS
            && let Some(leg) = self.legs.next()
        {
            let leg = leg?;
            self.events += leg.events.len();
            self.batch.push(leg.element);
        }
        // Events go before the elements that carry them.
        if self.events > 0 {
            self.events = self.events.saturating_sub(LOAD_EVENTS);
            return Ok(true);
        }
        if self.batch.is_empty() || self.batch.len() > planner.room() {
            return Ok(false);
        }
        for element in self.batch.drain(..) {
            given(&element);
            planner.push(element)?;
        }
        Ok(true)
    }
}
