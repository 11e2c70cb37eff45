//! From moves to blocks, and how each of them continues into the next.

use super::Moves;
use crate::path::block::Block;
use crate::path::exact::{Join as Turning, MAX_TURN};
use crate::path::feeds::Feeds;
use crate::path::short_blocks::ShortBlocks;
use crate::path::targets::RestState;
use crate::path::weld::WAIT_MM_S;
use crate::path::{PathError, Planner, TOLERANCE, Tip};
use nc::{Blend, Move, PathControl, Way};
use shared::geometry::angle;
use shared::protocol::{PathAction, PathEvent};
use shared::trajectory::{Element, Join, Tolerance};
use std::sync::Arc;

/// A block of a path, and how it continues.
pub(super) struct Step {
    pub(super) block: Block,
    /// Where it leads.
    pub(super) tip: Tip,
    /// A time at rest.
    pub(super) waits: bool,
    /// Programmed \[mm/s\].
    pub(super) programmed: f64,
    /// The same, or what the axes come to on the block, if that is less \[mm/s\].
    pub(super) speed: f64,
    /// What is switched from where it begins on: so far behind \[mm\].
    pub(super) actions: Vec<(f64, PathAction)>,
    control: PathControl,
    /// How it joins the next one.
    pub(super) join: Join,
    /// The corner at its end, if the machine stops for that \[rad\].
    pub(super) corner: Option<f64>,
    /// How its attitude goes over from the block before and into the next one.
    turns: [Option<Turning>; 2],
}

impl Step {
    /// The elements of the block, in order.
    pub(super) fn elements(&self, planner: &Planner) -> Result<Vec<Element>, PathError> {
        self.block.elements(planner, self.speed, self.join, &self.turns)
    }

    /// How far off it short lines may be smoothed at most \[mm\].
    pub(super) fn smoothing(&self) -> f64 {
        match self.control {
            PathControl::Blend(blend) => blend.smoothing.unwrap_or(f64::INFINITY),
            PathControl::ExactPath | PathControl::ExactStop => 0.0,
        }
    }

    /// By how much the rotary axes are off at its end, as their rates change there \[rad\].
    pub(super) fn slack(&self) -> f64 {
        self.turns[1].map_or(0.0, |turning| turning.slack)
    }

    /// What is switched where it begins, at `s` \[mm\].
    pub(super) fn events(&self, s: f64) -> Vec<PathEvent> {
        let event = |(after_mm, action): &(f64, PathAction)| PathEvent {
            s_mm: s + after_mm,
            action: *action,
        };
        self.actions.iter().map(event).collect()
    }

    /// Decides how it continues into `next`.
    fn go_on_to(&mut self, next: &mut Step, planner: &Planner) {
        let direction = self.block.direction(self.block.length);
        let turn = angle(&direction, &next.block.direction(0.0));
        // What the rotary axes do by themselves has no corner that could be rounded.
        if self.block.stands != next.block.stands || self.block.stands && turn > MAX_TURN {
            return;
        }
        let position = match (self.control, next.control) {
            (PathControl::ExactStop, _) => return,
            (PathControl::Blend(p), PathControl::Blend(q)) => tolerance(p).min(tolerance(q)),
            _ if turn <= MAX_TURN => TOLERANCE.position,
            _ => {
                self.corner = Some(turn);
                return;
            }
        };
        self.join = Join::Blend(Tolerance {
            position,
            ..TOLERANCE
        });
        if turn <= MAX_TURN && (self.block.turns() || next.block.turns()) {
            // At a corner the attitude is rounded with it; here the rotary axes need a length of their own.
            let (end, speed) = (self.block.length, self.speed.min(next.speed));
            let turning = planner.join(end, &self.block, &next.block, &self.tip, speed);
            let turning = turning.of_attitude();
            self.turns[1] = Some(turning);
            next.turns[0] = Some(turning.for_the_next());
        }
    }
}

/// The tolerance of G64, with or without a P \[mm\].
fn tolerance(blend: Blend) -> f64 {
    blend.tolerance.unwrap_or(TOLERANCE.position)
}

/// The blocks of a path, one ahead.
pub(super) struct Walk {
    planner: Arc<Planner>,
    moves: ShortBlocks<Moves>,
    feeds: Feeds,
    tip: Tip,
    /// What is on from before.
    on: Vec<PathAction>,
    ahead: Option<Step>,
}

impl Walk {
    pub(super) fn new(planner: Arc<Planner>, moves: Moves, from: &RestState, feeds: Feeds) -> Self {
        Self {
            moves: ShortBlocks::new(planner.clone(), moves, from),
            planner,
            feeds,
            tip: from.tip,
            on: from.switched.actions(),
            ahead: None,
        }
    }

    fn step(&mut self, from: Move) -> Result<Step, PathError> {
        let Move { target, events } = from;
        let planner = &self.planner;
        let tip = planner.next_tip(&target, &self.tip)?;
        let block = Block::build(planner, nc::Motion::Feed, &self.tip, &tip, &target)?;
        let waits = matches!(target.way, Way::Wait(_));
        let programmed = match waits {
            true => WAIT_MM_S,
            false => self.feeds.next(&target, block.length)?,
        };
        let speed = planner.reached_on(&block, &tip, programmed);
        let on = std::mem::take(&mut self.on)
            .into_iter()
            .map(|action| (0.0, action));
        let mut actions: Vec<(f64, PathAction)> = on.collect();
        for event in &events {
            let switched = planner.actions(event)?;
            actions.extend(switched.into_iter().map(|action| (event.after_mm, action)));
        }
        self.tip = tip;
        Ok(Step {
            block,
            tip,
            waits,
            programmed,
            speed,
            actions,
            control: target.control,
            join: Join::Stop,
            corner: None,
            turns: [None; 2],
        })
    }
}

impl Iterator for Walk {
    type Item = Result<Step, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let Some(next) = self.moves.next() else {
                return self.ahead.take().map(Ok);
            };
            let mut next = match next.and_then(|next| self.step(next)) {
                Ok(next) => next,
                Err(error) => return Some(Err(error)),
            };
            let before = self.ahead.take().map(|mut before| {
                before.go_on_to(&mut next, &self.planner);
                before
            });
            self.ahead = Some(next);
            if before.is_some() {
                return before.map(Ok);
            }
        }
    }
}
