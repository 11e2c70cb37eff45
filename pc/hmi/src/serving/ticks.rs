//! Ticks of the boards, few of many.

use shared::io::SLIDES;
use shared::protocol::{MotionSample, TrackerSample};

/// At most `most` ticks for all of `ticks`, oldest first: the last of equal pieces, each with the largest following errors and the largest
/// skew of its piece.
pub(super) fn of_motion(ticks: &[MotionSample], most: usize) -> Vec<MotionSample> {
    let piece = ticks.len().div_ceil(most).max(1);
    ticks.chunks(piece).filter_map(largest).collect()
}

fn largest(piece: &[MotionSample]) -> Option<MotionSample> {
    let mut last = *piece.last()?;
    for tick in piece {
        for (error, of_tick) in last.following_error.iter_mut().zip(tick.following_error) {
            *error = error.max(of_tick);
        }
        last.skew_mm = last.skew_mm.max(tick.skew_mm);
    }
    // What only judges read.
    (last.truth, last.load) = (None, None);
    Some(last)
}

/// Those of `ticks` at which a slide is farthest to either side of its target, and the last: at most 2 each slide and one, oldest first.
pub(super) fn of_tracker(ticks: &[TrackerSample]) -> Vec<TrackerSample> {
    let error = |at: usize, slide: usize| ticks[at].slides_mm[slide] - ticks[at].target_mm[slide];
    let mut chosen: Vec<usize> = ticks.len().checked_sub(1).into_iter().collect();
    for slide in 0..SLIDES {
        let by_error = |a: &usize, b: &usize| error(*a, slide).total_cmp(&error(*b, slide));
        chosen.extend((0..ticks.len()).min_by(by_error));
        chosen.extend((0..ticks.len()).max_by(by_error));
    }
    chosen.sort_unstable();
    chosen.dedup();
    let tick = |at| TrackerSample {
        truth_mm: None,
        ..ticks[at]
    };
    chosen.into_iter().map(tick).collect()
}
