//! A planned path, as it is sent to the boards.

use super::blocks::{Blocks, Course, Leg};
use super::shape::Shape;
use super::{CAPACITY, PathError, TooFast};
use nc::{Motion, Probe, Wait};
use shared::protocol::{PathAction, PathEvent};
use shared::trajectory::{Knot, Path, PathSpace, SpeedLimits};

/// A path that the boards can run.
#[derive(Clone, Debug)]
pub struct PlannedPath {
    /// Rapid, feed or none.
    pub motion: Motion,
    /// What the knots are: the tool in the frame of the work, or the axes.
    pub space: PathSpace,
    /// The machine waits for these before the path, one after the other; then it stands.
    pub waits_before: Vec<Wait>,
    /// The machine stands for this long before the path begins \[s\] (G4).
    pub dwell_before_s: f64,
    /// An input ends it before its end.
    pub probe: Option<Probe>,
    /// It runs without the feed override.
    pub fixed_feed: bool,
    /// The path begins at a corner of this much within a path of the program, which is too sharp to continue
    /// without a stop \[°\].
    pub corner_deg: Option<f64>,
    /// Value and slope of every channel, s from 0; none of blocks that are followed exactly.
    pub knots: Vec<Knot>,
    /// Where the motion of each target of the program ends \[mm\], and its line; s not decreasing. Of blocks that
    /// are followed exactly only the last.
    pub lines: Vec<(f64, u32)>,
    /// What happens on the way, s not decreasing; of blocks that are followed exactly they are in
    /// [`PlannedPath::legs`].
    pub events: Vec<PathEvent>,
    /// Changes of the programmed speed on the way, in order; of blocks that are followed exactly the elements tell
    /// them.
    pub steps: Vec<SpeedStep>,
    /// Speed, acceleration and jerk along the path; the speed until it changes.
    pub limits: SpeedLimits,
    /// What would not let it be faster, of a feed path.
    pub bound: Option<Bound>,
    /// Where the feed is more than the axes allow.
    pub too_fast: TooFast,
    /// Largest | |dP/ds| − 1 | of a feed path: how exact its speed is.
    pub speed_error: f64,
    /// Path length at which the machine begins \[mm\]: 0, unless the program is started at a line in the middle.
    pub start_s: f64,
    /// What is switched there besides, if that is not 0.
    pub start_actions: Vec<PathAction>,
    /// The blocks, where they are followed exactly.
    pub blocks: Option<Blocks>,
}

/// Programmed speeds along a path \[mm/s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speeds {
    /// That it begins with.
    pub first_mm_s: f64,
    /// The lowest.
    pub slowest_mm_s: f64,
    /// The highest.
    pub fastest_mm_s: f64,
    /// How often it changes.
    pub changes: u64,
    last_mm_s: f64,
}

impl Speeds {
    /// One speed.
    pub(super) fn of(speed: f64) -> Self {
        Self {
            first_mm_s: speed,
            slowest_mm_s: speed,
            fastest_mm_s: speed,
            changes: 0,
            last_mm_s: speed,
        }
    }

    /// Goes on at `speed`.
    pub(super) fn change_to(&mut self, speed: f64) {
        self.changes += u64::from(speed != self.last_mm_s);
        self.slowest_mm_s = self.slowest_mm_s.min(speed);
        self.fastest_mm_s = self.fastest_mm_s.max(speed);
        self.last_mm_s = speed;
    }
}

/// From a path length on, this speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedStep {
    /// Path length \[mm\].
    pub s: f64,
    /// Speed \[mm/s\].
    pub velocity: f64,
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
            waits_before: Vec::new(),
            dwell_before_s: 0.0,
            probe: None,
            fixed_feed: false,
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
            too_fast: TooFast::default(),
            speed_error: shape.speed_error,
            start_s: 0.0,
            start_actions: Vec::new(),
            blocks: None,
        }
    }

    /// Length \[mm\].
    pub fn length_mm(&self) -> f64 {
        match &self.blocks {
            Some(blocks) => blocks.summary().length_mm,
            None => self.knots.last().map_or(0.0, |knot| knot.s_mm),
        }
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
        self.waits_before.clear();
    }

    /// The programmed speeds, or those that a rapid is planned with.
    pub fn speeds(&self) -> Speeds {
        if let Some(blocks) = &self.blocks {
            return blocks.summary().speeds;
        }
        let steps = self.steps.iter().map(|step| step.velocity);
        let mut speeds = Speeds::of(self.limits.velocity);
        steps.for_each(|speed| speeds.change_to(speed));
        speeds
    }

    /// How many pieces it is made of: spans between knots, or elements.
    pub fn pieces(&self) -> u64 {
        match &self.blocks {
            Some(blocks) => blocks.summary().elements,
            None => self.knots.len().saturating_sub(1) as u64,
        }
    }

    /// A rapid that takes `times` as long.
    pub fn slower(mut self, times: f64) -> Self {
        self.limits.velocity /= times;
        self.limits.acceleration /= times * times;
        self.limits.jerk /= times * times * times;
        self
    }

    /// First and last line of the program that the machine runs of it; 0 for a path that no program asks for.
    pub fn first_and_last_line(&self) -> (u32, u32) {
        let (first, last) = match &self.blocks {
            Some(blocks) => blocks.summary().lines,
            None => (self.line_at(0.0), self.line_at(self.length_mm())),
        };
        let begins = |leg: Result<Leg, PathError>| leg.map_or(first, |leg| leg.element.line);
        (self.given_legs().next().map_or(first, begins), last)
    }

    /// From where the first beam goes on to where the last one goes off \[mm\]; `None` without beams or motion.
    pub fn weld(&self) -> Option<(f64, f64)> {
        if self.motion == Motion::Stand {
            return None;
        }
        if let Some(blocks) = &self.blocks {
            return blocks.summary().weld_mm;
        }
        let mut switchings = self.events.iter().filter_map(|event| match event.action {
            PathAction::Beam { on, .. } => Some((event.s_mm, on)),
            _ => None,
        });
        let (start, _) = switchings.clone().find(|(_, on)| *on)?;
        let end = match switchings.next_back() {
            Some((end, false)) => end,
            _ => self.length_mm(),
        };
        Some((start, end))
    }

    /// Where it is, by its length.
    pub fn path(&self) -> Course {
        match &self.blocks {
            Some(blocks) => Course::of(blocks),
            None => Course::Knots(self.knot_path()),
        }
    }

    /// The path as the tracker board sees it: by its knots.
    pub fn knot_path(&self) -> Box<Path<CAPACITY>> {
        let mut path = Box::new(Path::new());
        path.clear(0, self.space);
        for knot in &self.knots {
            path.push(*knot).expect("planned knots are in order and fit");
        }
        path
    }
}
