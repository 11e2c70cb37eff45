//! Blocks that feed, followed exactly from rest to rest: elements that are made when they are asked for.
//!
//! Nothing grows with the number of blocks. They are gone through once to check them, and again whenever the path is
//! given to a board or looked at.

mod check;
mod course;
mod elements;
mod walk;

pub use check::Summary;
pub use course::Course;
pub(crate) use elements::part_of_arc;

use super::ahead::Ahead;
use super::feeds::Feeds;
use super::targets::RestState;
use super::{PathError, PlannedPath, Planner};
use check::Check;
use nc::{Motion, Move};
use shared::protocol::PathEvent;
use shared::trajectory::{Element, PathSpace, SpeedLimits};
use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;
use walk::Walk;

/// Moves one after the other, as the program has them.
pub(super) type Moves = Box<dyn Iterator<Item = Result<Move, PathError>> + Send>;

/// An element, and what happens on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// In the order of their places.
    pub events: Vec<PathEvent>,
    /// The element.
    pub element: Element,
}

/// Blocks from rest to rest: how to come by them, and what was seen of them when they were checked.
#[derive(Clone)]
pub struct Blocks {
    planner: Arc<Planner>,
    moves: Arc<dyn Fn() -> Moves + Send + Sync>,
    from: RestState,
    feeds: Feeds,
    summary: Summary,
}

impl fmt::Debug for Blocks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Blocks")
            .field("from", &self.from)
            .field("summary", &self.summary)
            .finish_non_exhaustive()
    }
}

impl Planner {
    /// The path of the blocks that `moves` gives whenever it is called, which starts where the machine stands; that is
    /// then at its end. `speed_mm_s` replaces the programmed feed.
    pub(super) fn exact_path(
        &self,
        moves: Arc<dyn Fn() -> Moves + Send + Sync>,
        stand: &mut RestState,
        speed_mm_s: Option<f64>,
    ) -> Result<PlannedPath, PathError> {
        let planner = Arc::new(self.clone());
        let feeds = Feeds::replaced_by(speed_mm_s);
        let mut check = Check::new(&planner, stand);
        let read = Box::new(Ahead::new(moves()));
        for step in Walk::new(planner.clone(), read, stand, feeds) {
            check.step(&step?)?;
        }
        let from = *stand;
        let (summary, bound, too_fast) = check.finish(stand)?;
        Ok(PlannedPath {
            motion: Motion::Feed,
            space: PathSpace::Tool,
            waits_before: Vec::new(),
            dwell_before_s: 0.0,
            probe: None,
            fixed_feed: false,
            corner_deg: None,
            knots: Vec::new(),
            lines: vec![(summary.length_mm, summary.lines.1)],
            events: Vec::new(),
            steps: Vec::new(),
            limits: SpeedLimits {
                velocity: summary.speeds.first_mm_s,
                acceleration: self.planning.path_acceleration_mm_s2,
                jerk: self.planning.path_jerk_mm_s3,
            },
            bound,
            too_fast,
            speed_error: 0.0,
            start_s: 0.0,
            start_actions: Vec::new(),
            blocks: Some(Blocks {
                planner,
                moves,
                from,
                feeds,
                summary,
            }),
        })
    }
}

impl Blocks {
    /// What was seen of them.
    pub fn summary(&self) -> &Summary {
        &self.summary
    }

    /// The path as it is programmed.
    ///
    /// # Errors
    /// What the check would have found: the program is not the one that was checked.
    pub fn legs(&self) -> impl Iterator<Item = Result<Leg, PathError>> + use<> {
        self.smoothable().map(|leg| leg.map(|(leg, _)| leg))
    }

    /// The same, each leg with how far off it short lines may be smoothed at most \[mm\].
    pub(super) fn smoothable(&self) -> impl Iterator<Item = Result<(Leg, f64), PathError>> + use<> {
        let walk = Walk::new(self.planner.clone(), (self.moves)(), &self.from, self.feeds);
        Legs {
            planner: self.planner.clone(),
            walk,
            waiting: VecDeque::new(),
            s: 0.0,
            ended: false,
        }
    }
}

struct Legs {
    planner: Arc<Planner>,
    walk: Walk,
    waiting: VecDeque<(Leg, f64)>,
    /// Where the next leg begins \[mm\].
    s: f64,
    ended: bool,
}

impl Legs {
    /// The legs of the next block.
    fn more(&mut self) -> Option<Result<(), PathError>> {
        let step = match self.walk.next()? {
            Ok(step) => step,
            Err(error) => return Some(Err(error)),
        };
        let elements = match step.elements(&self.planner) {
            Ok(elements) => elements,
            Err(error) => return Some(Err(error)),
        };
        let (mut events, smoothing) = (step.events(self.s), step.smoothing());
        for element in elements {
            self.s += element.length;
            let events = std::mem::take(&mut events);
            self.waiting.push_back((Leg { events, element }, smoothing));
        }
        Some(Ok(()))
    }
}

impl Iterator for Legs {
    type Item = Result<(Leg, f64), PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.waiting.is_empty() && !self.ended {
            match self.more() {
                Some(Ok(())) => {}
                Some(Err(error)) => {
                    self.ended = true;
                    return Some(Err(error));
                }
                None => self.ended = true,
            }
        }
        self.waiting.pop_front().map(Ok)
    }
}
