//! Feeds that the axes do not allow everywhere. A feed is the most that a path goes with: the planner of the motion board
//! slows down where an axis needs it. Where the speed must be constant such a feed is refused.

use super::limits::TOO_FAST;
use super::{PathError, PlannedPath};
use nc::SourcePosition;
use shared::protocol::PathAction;
use thiserror::Error;

/// A feed, and the place where a drive allows the smallest part of it.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "{place}: the feed of {feed:.0} {unit} is too high, the {quantity} of {axis} allows {:.0} {unit}",
    (largest * TOO_FAST).floor()
)]
pub struct FeedTooHigh {
    /// Where in the program.
    pub place: SourcePosition,
    /// Wanted \[mm/min\], or °/min where the tip stands.
    pub feed: f64,
    /// Possible.
    pub largest: f64,
    /// Of both.
    pub unit: &'static str,
    /// Axis or V slide.
    pub axis: &'static str,
    /// Speed or acceleration.
    pub quantity: &'static str,
}

/// Unit of F on a block in which the tip `stands`, or of any other.
pub(super) fn unit(stands: bool) -> &'static str {
    if stands { "°/min" } else { "mm/min" }
}

impl FeedTooHigh {
    /// How many times as fast as possible.
    fn times(&self) -> f64 {
        self.feed / self.largest
    }
}

/// Where a path is programmed faster than its axes allow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TooFast {
    /// The worst place of all.
    pub anywhere: Option<FeedTooHigh>,
    /// The worst one with a beam on, or a spindle.
    pub beam_on: Option<FeedTooHigh>,
    /// The worst one of a V slide.
    slide: Option<FeedTooHigh>,
}

impl TooFast {
    /// Takes in what is found of an axis, where a beam is `on` or none is.
    pub(super) fn see_axis(&mut self, found: FeedTooHigh, on: bool) {
        if on {
            worse(&mut self.beam_on, &found);
        }
        worse(&mut self.anywhere, &found);
    }

    /// Takes in what is found of a V slide.
    pub(super) fn see_slide(&mut self, found: &FeedTooHigh) {
        worse(&mut self.slide, found);
    }

    /// All of it, if no slide is too slow: they are not in the plan of the motion board, which cannot slow down for them.
    pub(super) fn found(self) -> Result<Self, PathError> {
        self.slide
            .clone()
            .map_or(Ok(self), |found| Err(PathError::Slide(found)))
    }
}

fn worse(worst: &mut Option<FeedTooHigh>, found: &FeedTooHigh) {
    if worst.as_ref().is_none_or(|worst| found.times() > worst.times()) {
        *worst = Some(found.clone());
    }
}

/// Whether the feed can be kept with a beam on wherever the speed must be constant: on all of `paths` if a part is `judged` by
/// it, else on those that follow a seam.
///
/// # Errors
/// [`PathError::NotConstant`] of the first path on which it cannot.
pub fn check_constant_speed(paths: &[PlannedPath], judged: bool) -> Result<(), PathError> {
    let follows = |path: &PlannedPath| {
        let mut actions = path.events.iter().map(|event| event.action);
        actions.any(|action| action == PathAction::Tracking { on: true })
    };
    let constant = paths.iter().filter(|path| judged || follows(path));
    match constant.filter_map(|path| path.too_fast.beam_on.clone()).next() {
        Some(found) => Err(PathError::NotConstant(found)),
        None => Ok(()),
    }
}
