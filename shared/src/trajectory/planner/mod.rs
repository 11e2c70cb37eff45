//! The trajectory planner: elements in, references of the axes out, a millisecond a tick.
//!
//! It looks ahead over everything it holds and plans the fastest speed along the path that no limit forbids, down
//! to rest at the end of what it knows. Corners are rounded inside their tolerance.

mod chain;
mod corner;
mod filter;
mod grid;
mod horizon;
mod limits;
mod node;
mod player;
mod rounding;
mod scan;
mod track;

pub use limits::PlanLimits;

use super::reference::at_unit_speed;
use super::{Element, PathSpace, ReferenceError, SpeedState};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};
use filter::Filter;
use grid::{Grid, Ground};
use horizon::Horizon;
use limits::Bounds;
use node::Nodes;
use player::Player;
use thiserror::Error;
use track::Track;

/// Work of one tick, in visits of nodes.
const VISITS: u32 = 16;
/// Work to append a node, in the same unit.
const APPEND: u32 = 3;
/// Nodes behind the machine that are kept as long as there is room ahead.
const KEPT: u32 = 32;

/// Elements stream in at one end, and the references of the axes come out at the other.
///
/// It holds up to `ELEMENTS` elements and `NODES` places of the path at which speed is planned; both are powers
/// of two.
#[derive(Clone, Debug)]
pub struct Planner<const ELEMENTS: usize, const NODES: usize> {
    space: PathSpace,
    bounds: Bounds,
    track: Track<ELEMENTS>,
    grid: Grid,
    nodes: Nodes<NODES>,
    horizon: Horizon,
    player: Player,
    filter: Filter,
    /// Where the unfiltered references are.
    planned: SpeedState,
    axes: [f64; AXES],
    planned_hint: u32,
    output_hint: u32,
    /// Ticks since the plan has come to rest.
    resting: u32,
}

/// What the machine shall do at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// References of the axes.
    pub axes: AxisMotion,
    /// Where that is on the path, and how fast: published, and what events go by.
    pub along: SpeedState,
    /// Line of the program of the element there.
    pub line: u32,
    /// Nothing moves, and nothing will before another element comes or the rate is changed.
    pub at_rest: bool,
}

/// Why an element was not taken; the planner is as before.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PushError {
    /// No room for another element now; there will be when some have been passed.
    #[error("the planner holds all the elements it can; wait until it has room")]
    Full,
    /// Length or feed is not above zero, or a number is not finite.
    #[error("line {line}: the element has no length, no feed, or a number that is not finite")]
    Unsound {
        /// Line of the program.
        line: u32,
    },
    /// It does not begin where the one before it ends.
    #[error("line {line}: the element begins {distance} mm (or rad) away from the end of the one before it")]
    Gap {
        /// Line of the program.
        line: u32,
        /// Largest difference of a channel.
        distance: f32,
    },
}

impl<const ELEMENTS: usize, const NODES: usize> Planner<ELEMENTS, NODES> {
    /// Without elements, at rest.
    pub const fn new() -> Self {
        Self {
            space: PathSpace::Tool,
            bounds: Bounds::NONE,
            track: Track::new(),
            grid: Grid::NONE,
            nodes: Nodes::new(),
            horizon: Horizon::NONE,
            player: Player::NONE,
            filter: Filter::new(),
            planned: SpeedState {
                s: 0.0,
                v: 0.0,
                a: 0.0,
            },
            axes: [0.0; AXES],
            planned_hint: 0,
            output_hint: 0,
            resting: 0,
        }
    }

    /// Forgets all elements; the next ones begin at path length `s` \[mm\], with the machine at rest and its
    /// axes at `axes`.
    pub fn start(&mut self, limits: &PlanLimits, space: PathSpace, s: f64, axes: &[f64; AXES]) {
        self.space = space;
        self.bounds = Bounds::build(limits);
        self.track.clear(s);
        self.grid.start(s, axes, &mut self.nodes);
        self.horizon = Horizon::NONE;
        self.player = Player::NONE;
        self.planned = SpeedState { s, v: 0.0, a: 0.0 };
        self.axes = *axes;
        (self.planned_hint, self.output_hint) = (0, 0);
        let rest = AxisMotion {
            position: *axes,
            velocity: [0.0; AXES],
            acceleration: [0.0; AXES],
        };
        self.filter.settle(self.bounds.filter_ticks, &rest, &self.planned);
        self.resting = self.bounds.filter_ticks as u32;
    }

    /// How many elements there is room for now.
    pub fn room(&self) -> usize {
        self.track.room()
    }

    /// Appends an element. The last one of a program has [`Join::Stop`](super::Join::Stop); before that one is
    /// there, the plan ends somewhat before the end of the last one known, because its corner is not.
    pub fn push(&mut self, element: Element) -> Result<(), PushError> {
        self.track.push(element)
    }

    /// Where the path is before the output filter.
    pub fn planned(&self) -> SpeedState {
        self.planned
    }

    /// Plans taken, and plans given up because they were not ready in time or not good enough.
    pub fn plans(&self) -> (u32, u32) {
        (self.horizon.taken, self.horizon.given_up)
    }

    /// One path tick: a bounded share of the planning, and the next references.
    pub fn tick(&mut self, kinematics: &Kinematics) -> Result<Output, ReferenceError> {
        self.plan(kinematics)?;
        self.play(kinematics)
    }

    fn plan(&mut self, kinematics: &Kinematics) -> Result<(), ReferenceError> {
        let mut work = VISITS;
        while work > 0 {
            if !self.horizon.waiting() {
                self.horizon.step(&mut self.nodes, &self.bounds);
                work -= 1;
                continue;
            }
            self.release();
            while self.track.decide(&self.bounds) {}
            let ground = Ground {
                track: &self.track,
                space: self.space,
                kinematics,
                bounds: &self.bounds,
            };
            let mut grown = false;
            while work > 0 && self.grid.extend(&ground, &mut self.nodes)? {
                grown = true;
                work = work.saturating_sub(APPEND);
            }
            if grown && work == 0 {
                break;
            }
            let left = self.player.left(&self.nodes, self.horizon.in_force());
            let next = (self.player.node + 1).min(self.horizon.in_force());
            self.horizon.begin(
                &mut self.nodes,
                next,
                left,
                self.resting >= self.bounds.filter_ticks as u32,
                VISITS,
                &self.bounds,
            );
            if self.horizon.waiting() {
                break;
            }
        }
        Ok(())
    }

    /// Lets go of what lies behind.
    fn release(&mut self) {
        let node = self.player.node.saturating_sub(KEPT);
        self.nodes.first = self.nodes.first.max(node);
        let element = self
            .output_hint
            .saturating_sub(track::REACH + 1)
            .min(self.grid.needs());
        self.track.release(element);
    }

    fn play(&mut self, kinematics: &Kinematics) -> Result<Output, ReferenceError> {
        let ticks = self.bounds.filter_ticks as u32;
        let last = self.horizon.in_force();
        let planned = self.player.step(&self.nodes, last, ticks);
        self.horizon.watch(self.player.node);
        if planned.s == self.planned.s {
            self.resting = self.resting.saturating_add(1);
        } else {
            self.resting = 0;
        }
        self.planned = planned;
        let axes = match self.track.at(planned.s, &mut self.planned_hint) {
            Some(point) => {
                at_unit_speed(kinematics, &point, self.space, &self.axes)?.at_speed(planned.v, planned.a)
            }
            None => AxisMotion {
                position: self.axes,
                velocity: [0.0; AXES],
                acceleration: [0.0; AXES],
            },
        };
        self.axes = axes.position;
        let (axes, along) = self.filter.push(&axes, &planned);
        let line = self
            .track
            .find(along.s, &mut self.output_hint)
            .map_or(0, |piece| piece.element.line);
        Ok(Output {
            axes,
            along,
            line,
            at_rest: self.resting >= ticks && self.player.node >= last && self.horizon.waiting(),
        })
    }
}

impl<const ELEMENTS: usize, const NODES: usize> Default for Planner<ELEMENTS, NODES> {
    fn default() -> Self {
        Self::new()
    }
}
