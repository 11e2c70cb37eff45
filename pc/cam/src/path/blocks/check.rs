//! Checks all blocks of a path once, and sums them up.

use super::walk::Step;
use crate::path::limits::{CHECK_STEP, Demand, Worst, check_continuous};
use crate::path::shape::Goal;
use crate::path::targets::RestState;
use crate::path::too_fast::unit;
use crate::path::{Bound, MAX_EVENTS, PathError, Planner, Speeds, TooFast};
use shared::protocol::PathAction;
use shared::trajectory::{Element, Join, PathSpace};

/// What the blocks of a path come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Length \[mm\].
    pub length_mm: f64,
    /// Blocks.
    pub blocks: u64,
    /// Elements that they are made into.
    pub elements: u64,
    /// Lines of the program: of the first block and of the last one.
    pub lines: (u32, u32),
    /// Programmed speeds.
    pub speeds: Speeds,
    /// From where the first beam goes on to where the last one goes off \[mm\].
    pub weld_mm: Option<(f64, f64)>,
    /// Stops on the way, at corners and where the program says so.
    pub stops: u64,
    /// Those at corners, which G61 does not round.
    pub corners: u64,
    /// The sharpest of these \[rad\].
    pub sharpest: f64,
    /// Closest tolerance that a corner is rounded with \[mm\]; none without any.
    pub tolerance_mm: Option<f64>,
}

/// What is known of the blocks gone through.
pub(super) struct Check<'a> {
    planner: &'a Planner,
    stand: RestState,
    before: Option<Demand>,
    travel: Worst,
    too_fast: TooFast,
    bound: Option<Bound>,
    summary: Summary,
}

impl<'a> Check<'a> {
    /// Nothing yet of a path that begins where the machine stands.
    pub(super) fn new(planner: &'a Planner, stand: &RestState) -> Self {
        Self {
            planner,
            stand: *stand,
            before: None,
            travel: Worst::default(),
            too_fast: TooFast::default(),
            bound: None,
            summary: Summary::default(),
        }
    }

    /// Goes through one block.
    pub(super) fn step(&mut self, step: &Step) -> Result<(), PathError> {
        let events = step.actions.len();
        if events > MAX_EVENTS {
            let place = step.block.place;
            return Err(PathError::TooManyEvents { place, events });
        }
        let elements = step.elements(self.planner)?;
        self.count(step, &elements);
        for element in &elements {
            self.element(step, element)?;
        }
        let goal = Goal {
            slack: step.slack(),
            ..Goal::exact(self.summary.length_mm, step.block.place)
        };
        self.stand.tip = self.planner.settled(&step.tip, &self.stand.axes, &goal)?;
        Ok(())
    }

    /// Where the drives are and how they move along an element.
    fn element(&mut self, step: &Step, element: &Element) -> Result<(), PathError> {
        let (planner, place) = (self.planner, step.block.place);
        let count = (element.length / CHECK_STEP).ceil() as u32;
        for i in 0..=count {
            let along = element.length * f64::from(i) / f64::from(count);
            let s = self.summary.length_mm + along;
            let near = self.stand.axes;
            let (demand, axes) = planner.demand(s, &element.at(along), PathSpace::Tool, place, &near)?;
            if let Some(before) = &self.before {
                check_continuous(before, &demand, place)?;
            }
            planner.see_travel(&demand, place, &mut self.travel);
            let on = self.stand.switched.works();
            let feed = (step.programmed, unit(step.block.stands));
            planner.see_feed(&demand, feed, place, on, &mut self.too_fast);
            // That is a speed of the tip.
            let here = planner.bound_at(&demand).filter(|_| !step.block.stands);
            let bound = [self.bound, here].into_iter().flatten();
            self.bound = bound.min_by(|a, b| a.largest_mm_s.total_cmp(&b.largest_mm_s));
            self.stand.axes = axes;
            self.before = Some(demand);
        }
        self.summary.length_mm += element.length;
        Ok(())
    }

    fn count(&mut self, step: &Step, elements: &[Element]) {
        let summary = &mut self.summary;
        let (line, speed) = (step.block.place.line, step.speed);
        if summary.blocks == 0 {
            summary.lines.0 = line;
        }
        // A time at rest has no speed of the tip.
        if !step.waits {
            if summary.speeds == Speeds::default() {
                summary.speeds = Speeds::of(speed);
            }
            summary.speeds.change_to(speed);
        }
        summary.lines.1 = line;
        summary.blocks += 1;
        summary.elements += elements.len() as u64;
        for (after_mm, action) in &step.actions {
            self.stand.switched.switch(action);
            if let PathAction::Beam { on, .. } = action {
                let (s, before) = (summary.length_mm + after_mm, summary.weld_mm);
                summary.weld_mm = match (on, before) {
                    (true, None) => Some((s, f64::INFINITY)),
                    (true, Some((start, _))) => Some((start, f64::INFINITY)),
                    (false, Some((start, _))) => Some((start, s)),
                    _ => before,
                };
            }
        }
        if let Join::Blend(tolerance) = step.join {
            let closest = summary.tolerance_mm.unwrap_or(f64::INFINITY);
            summary.tolerance_mm = Some(closest.min(tolerance.position));
        }
        if let Some(corner) = step.corner {
            summary.corners += 1;
            summary.sharpest = summary.sharpest.max(corner);
        }
        summary.stops += u64::from(step.join == Join::Stop);
    }

    /// The sum of it, the drive that allows the least speed, and where the feed is too high; the machine then stands at
    /// the end.
    pub(super) fn finish(
        self,
        stand: &mut RestState,
    ) -> Result<(Summary, Option<Bound>, TooFast), PathError> {
        self.travel.found()?;
        let mut summary = self.summary;
        // The last one is the end.
        summary.stops = summary.stops.saturating_sub(1);
        if let Some((_, end)) = &mut summary.weld_mm {
            *end = end.min(summary.length_mm);
        }
        *stand = self.stand;
        Ok((summary, self.bound, self.too_fast.found()?))
    }
}
