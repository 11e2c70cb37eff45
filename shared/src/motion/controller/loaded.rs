//! The path that is loaded.

use crate::io::AXES;
use crate::motion::beams::EventQueue;
use crate::motion::overlap::Overlap;
use crate::motion::servo::InputState;
use crate::trajectory::{PathSpace, SpeedLimits};

/// The path that is loaded, and how far it has come; its elements are in the planner.
#[derive(Clone, Debug)]
pub(super) struct LoadedPath {
    /// Its number.
    pub id: u32,
    pub space: PathSpace,
    /// Limits along it, for run-ups, and the highest feed so far.
    pub limits: SpeedLimits,
    /// Where it begins: the planner was started there, and the axes have not moved since.
    pub start: Option<[f64; AXES]>,
    /// Elements taken.
    pub elements: u32,
    /// Path length where they end \[mm\].
    pub end_s: f64,
    /// No more come.
    pub complete: bool,
    pub events: EventQueue,
    /// Events taken.
    pub event_count: u32,
    /// Path length of the last one.
    pub last_event_s: f64,
    /// Line of the program, and the feed there \[mm/s\].
    pub line: u32,
    pub feed: f64,
    /// Ticks since the references came to rest.
    pub resting: u32,
    /// Beams that wait for their place after a hold.
    pub overlap: Option<Overlap>,
    pub resume: Resume,
    /// Tick after which it is given up, unless hold-to-run is asked for again; `None` of a path that runs by itself.
    pub held_until: Option<u64>,
    /// Input that ends it before its end.
    pub until: Option<InputState>,
}

/// How far a resume has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Resume {
    /// Not asked for.
    No,
    /// Asked for; the machine comes to rest first.
    Wanted,
    /// Going back to this path length \[mm\].
    Back(f64),
    /// Far enough back; coming to rest.
    Turning,
}

impl LoadedPath {
    pub const NONE: Self = Self {
        id: 0,
        space: PathSpace::Tool,
        limits: SpeedLimits {
            velocity: 0.0,
            acceleration: 1.0,
            jerk: 1.0,
        },
        start: None,
        elements: 0,
        end_s: 0.0,
        complete: false,
        events: EventQueue::new(),
        event_count: 0,
        last_event_s: f64::NEG_INFINITY,
        line: 0,
        feed: 0.0,
        resting: 0,
        overlap: None,
        resume: Resume::No,
        held_until: None,
        until: None,
    };

    /// The machine will not run it any more.
    pub fn forget(&mut self) {
        self.start = None;
        self.overlap = None;
        self.resume = Resume::No;
        self.held_until = None;
        self.until = None;
        self.events.clear();
    }
}
