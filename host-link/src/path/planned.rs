//! A planned path: what the boards are given.

use super::shape::Shape;
use super::{CAPACITY, MAX_EVENTS};
use crate::nc::Motion;
use shared::protocol::{Knot, PathAction, PathEvent};
use shared::trajectory::{Path, PathSpace, SpeedError, SpeedLimits, SpeedPlan, SpeedStep};

/// A path that the boards can run.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPath {
    /// Rapid, feed or none.
    pub motion: Motion,
    /// What the knots are: the tool in the frame of the work, or the axes.
    pub space: PathSpace,
    /// The machine stands for this long before the path begins \[s\] (G4).
    pub dwell_before_s: f64,
    /// The path begins at a corner of this much within a path of the program, which is too sharp to go on without
    /// a stop \[°\].
    pub corner_deg: Option<f64>,
    /// Value and slope of every channel, s from 0.
    pub knots: Vec<Knot>,
    /// Where the motion of each target of the program ends \[mm\], and its line; s not decreasing.
    pub lines: Vec<(f64, u32)>,
    /// What happens on the way, s not decreasing.
    pub events: Vec<PathEvent>,
    /// Changes of the programmed speed on the way, in order.
    pub steps: Vec<SpeedStep>,
    /// Speed, acceleration and jerk along the path; the speed until a step changes it.
    pub limits: SpeedLimits,
    /// What would not let it be faster, of a feed path.
    pub bound: Option<Bound>,
    /// Largest | |dP/ds| − 1 | of a feed path: how exact its speed is.
    pub speed_error: f64,
    /// Path length at which the machine begins \[mm\]: 0, unless the program is started at a line in the middle.
    pub start_s: f64,
    /// What is switched there besides, if that is not 0.
    pub start_actions: Vec<PathAction>,
}

/// The drive that allows the least speed along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// That speed \[mm/s\].
    pub largest_mm_s: f64,
    /// Name of the drive.
    pub axis: &'static str,
    /// Its "speed" or its "acceleration".
    pub quantity: &'static str,
    /// Where on the path \[mm\].
    pub s_mm: f64,
}

impl PlannedPath {
    /// A path without events and with no limits yet.
    pub(super) fn untimed(shape: &Shape, space: PathSpace, motion: Motion) -> Self {
        Self {
            motion,
            space,
            dwell_before_s: 0.0,
            corner_deg: None,
            knots: shape.knots.clone(),
            lines: shape
                .targets
                .iter()
                .map(|goal| (goal.s, goal.place.line))
                .collect(),
            events: Vec::new(),
            steps: Vec::new(),
            limits: SpeedLimits {
                velocity: f64::INFINITY,
                acceleration: f64::INFINITY,
                jerk: f64::INFINITY,
            },
            bound: None,
            speed_error: shape.speed_error,
            start_s: 0.0,
            start_actions: Vec::new(),
        }
    }

    /// Length \[mm\].
    pub fn length_mm(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.s_mm)
    }

    /// Line of the program whose motion is at `s` \[mm\], the later one where two meet; 0 for a path that no program
    /// asks for.
    pub fn line_at(&self, s: f64) -> u32 {
        let index = self.lines.partition_point(|(end, _)| *end <= s);
        let line = self.lines.get(index).or(self.lines.last());
        line.map_or(0, |(_, line)| *line)
    }

    /// Begins at `s` \[mm\], where an element does, with `actions`, and at once.
    pub(super) fn begin_at(&mut self, s: f64, actions: Vec<PathAction>) {
        (self.start_s, self.start_actions) = (s, actions);
        (self.dwell_before_s, self.corner_deg) = (0.0, None);
    }

    /// A rapid that takes `times` as long.
    pub fn slower(mut self, times: f64) -> Self {
        self.limits.velocity /= times;
        self.limits.acceleration /= times * times;
        self.limits.jerk /= times * times * times;
        self
    }

    /// Time from rest to rest \[s\].
    pub fn duration_s(&self) -> f64 {
        self.speed().map_or(0.0, |plan| plan.duration())
    }

    /// The speed along the path, as the motion board will plan it.
    pub fn speed(&self) -> Result<SpeedPlan<{ MAX_EVENTS + 1 }>, SpeedError> {
        let mut plan = SpeedPlan::new();
        plan.plan(0.0, self.length_mm(), &self.limits, self.steps.iter().copied())?;
        Ok(plan)
    }

    /// From where the first beam goes on to where the last one goes off \[mm\]; `None` without beams or motion.
    pub fn weld(&self) -> Option<(f64, f64)> {
        if self.motion == Motion::Stand {
            return None;
        }
        let places = |wanted: bool| {
            self.events
                .iter()
                .filter(move |event| matches!(event.action, PathAction::Beam { on, .. } if on == wanted))
                .map(|event| event.s_mm)
        };
        let start = places(true).next()?;
        Some((start, places(false).next_back().unwrap_or(self.length_mm())))
    }

    /// The path as the boards see it.
    pub fn path(&self) -> Box<Path<CAPACITY>> {
        let mut path = Box::new(Path::new());
        path.clear(0, self.space);
        for knot in &self.knots {
            path.push(*knot).expect("planned knots are in order and fit");
        }
        path
    }
}
