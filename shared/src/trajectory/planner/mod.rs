//! The trajectory planner: elements in, references of the axes out, a millisecond a tick.
//!
//! It looks ahead over everything it holds and plans the fastest speed along the path that no limit forbids, down
//! to rest at the end of what it knows. Corners are rounded inside their tolerance.

mod accuracy;
mod braking;
mod breaks;
mod chain;
mod channels;
mod corner;
mod filter;
mod grid;
mod horizon;
mod jerk_limit;
mod limits;
mod node;
mod plan;
mod planning;
mod played;
mod player;
mod room;
mod rounding;
mod rounds;
mod sample;
mod scan;
mod split;
#[cfg(test)]
mod tests;
mod track;

pub use limits::PlanLimits;
pub use planning::Planning;
pub use played::Played;
pub use player::{Player, PlayerAccess};
pub use track::{LONGEST as LONGEST_PATH, PushError};

use super::{Element, PathSpace, SpeedState, Unreachable};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};

/// Elements stream in at one end, and the references of the axes come out at the other: the two halves of the planner in
/// step, a tick of the [`Player`] and then a turn of [`Planning`].
///
/// It holds up to `ELEMENTS` elements and `NODES` places of the path at which speed is planned; both are powers
/// of two.
#[derive(Clone, Debug, Default)]
pub struct Planner<const ELEMENTS: usize, const NODES: usize> {
    player: Player<ELEMENTS, NODES>,
    planning: Planning<NODES>,
}

/// Which way the machine goes along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// On to the end.
    #[default]
    Forward,
    /// To a stop, as soon as the limits allow, and stay.
    Hold,
    /// Back along what was passed, as far as it is kept.
    Back,
}

/// References of the machine at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// References of the axes.
    pub axes: AxisMotion,
    /// Where that is on the path, and how fast: published, and what events go by.
    pub along: SpeedState,
    /// Line of the program of the element there.
    pub line: u32,
    /// Its programmed feed \[mm/s\].
    pub feed: f64,
    /// Nothing moves, and nothing will before another element comes, or another way or override is asked for.
    pub at_rest: bool,
}

impl<const ELEMENTS: usize, const NODES: usize> Planner<ELEMENTS, NODES> {
    /// Without elements, at rest.
    pub const fn new() -> Self {
        Self {
            player: Player::new(),
            planning: Planning::new(),
        }
    }

    /// See [`Player::start`].
    pub fn start(&mut self, limits: &PlanLimits, space: PathSpace, s: f64, axes: &[f64; AXES]) {
        self.player.start(limits, space, s, axes);
    }

    /// See [`Player::room`].
    pub fn room(&self) -> usize {
        self.player.room()
    }

    /// See [`Player::push`].
    pub fn push(&mut self, element: Element) -> Result<(), PushError> {
        self.player.push(element)
    }

    /// See [`Player::keep`].
    pub fn keep(&mut self, distance: f64) {
        self.player.keep(distance);
    }

    /// See [`Player::go`].
    pub fn go(&mut self, way: Way) {
        self.player.go(way);
    }

    /// See [`Player::set_override`].
    pub fn set_override(&mut self, factor: f64) {
        self.player.set_override(factor);
    }

    /// See [`Player::planned`].
    pub fn planned(&self) -> SpeedState {
        self.player.planned()
    }

    /// See [`Player::played`].
    pub fn played(&self) -> Played {
        self.player.played()
    }

    /// See [`Player::rested`].
    pub fn rested(&self) -> bool {
        self.player.rested()
    }

    /// See [`Planning::plans`].
    pub fn plans(&self) -> (u32, u32) {
        self.planning.plans()
    }

    /// One path tick, and the turn of planning after it.
    ///
    /// # Errors
    /// As [`Player::tick`].
    pub fn tick(&mut self, kinematics: &Kinematics) -> Result<Output, Unreachable> {
        let output = self.player.tick(kinematics);
        self.planning.turn(&mut self.player, kinematics);
        output
    }
}
