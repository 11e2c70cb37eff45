//! One block that a job asks for beside the line that our reader has found.

use crate::expected::{Block, Way};
use crate::found::{Line, Step};
use nc::ArcForm;

/// Feeds are written with three decimals \[mm/min\].
const FEED_ERROR: f64 = 0.0005 + 1e-9;

/// What of a line is not as it should be; lengths and angles have so many decimals.
pub fn difference(block: &Block, line: &Line, decimals: i32) -> Option<&'static str> {
    let near = Near(0.5 * 10f64.powi(-decimals) + 1e-9);
    let last = line.steps.last().expect("a motion");
    let ends = last.end.iter().zip(&block.end);
    if !ends.into_iter().all(|(a, b)| near.options(*a, *b)) {
        return Some("end");
    }
    let feeds = || line.steps.iter().filter(|step| step.feed.is_some());
    if feeds().next().is_some() != block.feed.is_some() {
        return Some("rapid or feed");
    }
    let feed_error = |step: &Step| step.feed.zip(block.feed).map(|(a, b)| (a - b).abs());
    if feeds().any(|step| feed_error(step) > Some(FEED_ERROR)) {
        return Some("feed");
    }
    if line.steps.iter().any(|step| step.tool != block.tool) {
        return Some("spindle or beam");
    }
    let rest: f64 = line.steps.iter().map(|step| step.dwell_s).sum();
    if rest != block.dwell_s {
        return Some("dwell");
    }
    let same = match &block.way {
        Way::Line => line.steps.len() == 1 && last.way == nc::Way::Line,
        arc @ Way::Arc { .. } => line.steps.len() == 1 && is_arc(arc, &last.way, near),
        Way::Hole { bottom } => {
            let over = |axis: usize| feeds().all(|step| near.options(step.end[axis], last.end[axis]));
            let levels = feeds().filter_map(|step| step.end[2]);
            let deepest = levels.fold(f64::INFINITY, f64::min);
            over(0) && over(1) && near.values(deepest, *bottom)
        }
    };
    (!same).then_some("way")
}

fn is_arc(wanted: &Way, found: &nc::Way, near: Near) -> bool {
    let (Way::Arc { plane, turn, centre }, nc::Way::Arc(arc)) = (wanted, found) else {
        return false;
    };
    let ArcForm::Centre(found) = arc.form else {
        return false;
    };
    let same_centre = (0..3).all(|i| near.values(found[i], centre[i]));
    same_centre && (arc.plane(), arc.turn, arc.more_turns) == (Some(*plane), *turn, 0)
}

/// Within so much of each other (mm, degrees).
#[derive(Clone, Copy)]
struct Near(f64);

impl Near {
    fn values(self, a: f64, b: f64) -> bool {
        (a - b).abs() <= self.0
    }

    /// Both are said, or none.
    fn options(self, a: Option<f64>, b: Option<f64>) -> bool {
        match (a, b) {
            (Some(a), Some(b)) => self.values(a, b),
            (a, b) => a == b,
        }
    }
}
