//! What simulated boards put out, tick by tick, and requests that take no time: for tests that judge every tick.

use super::SimulatedBoards;
use shared::io::{MOTORS, MotionCommand, SIDES, SLIDES, SlideCommand};
use shared::protocol::{Capture, MotionSample, PathState, Request, Response, Role, TrackerSample};
use shared::state::{State, TrackerState};

/// Outputs of the last ticks, and where the machine truly is after them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// Time since the boards were switched on \[µs\].
    pub now_us: u64,
    /// State of the motion board.
    pub state: State,
    /// To servo drives and beams, by the last servo tick.
    pub motion: MotionCommand,
    /// Positions of the motors' loads (mm, rad).
    pub motors: [f64; MOTORS],
    /// Beams that are on.
    pub beams: [bool; SIDES],
    /// Published by the last path tick.
    pub path: Option<(PathState, MotionSample)>,
    /// State of the tracker board.
    pub tracker_state: TrackerState,
    /// To the slide drives, by the last control tick.
    pub tracker: SlideCommand,
    /// Positions of the slides \[mm\].
    pub slides: [f64; SLIDES],
    /// Published by the last control tick.
    pub control: Option<(Option<Capture>, TrackerSample)>,
}

impl SimulatedBoards {
    /// What both boards put out now.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            now_us: self.now_us,
            state: self.motion.controller.state(),
            motion: self.motion.command,
            motors: self.motion.plant.truth(),
            beams: self.motion.plant.beams(),
            path: self.motion.published,
            tracker_state: self.tracker.controller.state(),
            tracker: self.tracker.command,
            slides: self.tracker.plant.truth(),
            control: self.tracker.published,
        }
    }

    /// Goes on to the next thing that happens, a tick or a datagram, if it is due by `end_us`; without one time is
    /// `end_us` afterwards. What the boards sent to the PC is thrown away.
    pub fn advance(&mut self, end_us: u64) -> bool {
        let happened = self.step(end_us);
        self.inbox.clear();
        happened
    }

    /// A request that is answered without time passing, as by a board that has several in its buffer.
    pub fn ask(&mut self, role: Role, request: &Request) -> Response {
        self.answer(role, request)
    }
}
