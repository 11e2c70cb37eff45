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
pub use track::{LONGEST as LONGEST_PATH, PushError};

use super::reference::at_unit_speed;
use super::{Element, PathSpace, SpeedState, Unreachable};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};
use channels::POSE_CHANNELS;
use filter::Filter;
use grid::{Grid, most_work};
use horizon::{Horizon, PlanRequest, WINDOW, WORK};
use limits::Bounds;
use node::Nodes;
use player::Player;
use sample::Ground;
use track::Track;

/// Highest feed override, and the lowest that is not a stop: with less a weld at 9 m/min would go 15 µm/s, and squares of
/// speeds would go out of what single precision holds.
const MOST_OVERRIDE: f64 = 2.0;
const LEAST_OVERRIDE: f64 = 1e-4;
/// Work to shape a corner, and to begin a plan.
const CORNER: u32 = 5;
const BEGIN: u32 = 40;
/// Work to split an interval for it.
const SPLIT: u32 = 45;

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
    way: Way,
    /// Feed override.
    factor: f64,
    filter: Filter,
    /// Where the unfiltered references are.
    planned: SpeedState,
    axes: [f64; AXES],
    planned_hint: u32,
    output_hint: u32,
    /// So much behind the machine is kept, if it is no more than a quarter of the elements \[mm\].
    keep: f64,
    /// Ticks since the plan has come to rest.
    resting: u32,
    /// There was nothing to plan at the last tick.
    idle: bool,
    /// No node could be appended, and since then no element came and no node was passed.
    laid: bool,
    /// Why no node follows the newest one: for the planner, the path ends there.
    blocked: Option<Unreachable>,
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
            space: PathSpace::Tool,
            bounds: Bounds::NONE,
            track: Track::new(),
            grid: Grid::NONE,
            nodes: Nodes::new(),
            horizon: Horizon::NONE,
            player: Player::NONE,
            way: Way::Forward,
            factor: 1.0,
            filter: Filter::new(),
            planned: SpeedState {
                s: 0.0,
                v: 0.0,
                a: 0.0,
            },
            axes: [0.0; AXES],
            planned_hint: 0,
            output_hint: 0,
            keep: 0.0,
            resting: 0,
            idle: false,
            laid: false,
            blocked: None,
        }
    }

    /// Forgets all elements; the next ones begin at path length `s` \[mm\], with the machine at rest and its
    /// axes at `axes`.
    pub fn start(&mut self, limits: &PlanLimits, space: PathSpace, s: f64, axes: &[f64; AXES]) {
        self.space = space;
        self.bounds = Bounds::build(limits);
        self.track.clear(s);
        (self.blocked, self.laid) = (None, false);
        self.grid.start(s, axes, &mut self.nodes);
        self.horizon = Horizon::at(self.nodes.first);
        self.player = Player::at(self.nodes.first);
        self.way = Way::Forward;
        self.keep = 0.0;
        self.planned = SpeedState { s, v: 0.0, a: 0.0 };
        self.axes = *axes;
        (self.planned_hint, self.output_hint) = (0, 0);
        let rest = AxisMotion::at_rest(axes);
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
        self.laid = false;
        self.track.push(element)
    }

    /// Keeps `distance` \[mm\] of the path behind the machine from now on, so that it can go back so far whenever it
    /// comes to rest, as long as that is no more than a quarter of the elements.
    pub fn keep(&mut self, distance: f64) {
        self.keep = distance;
    }

    /// Goes another way from now on, inside all limits.
    pub fn go(&mut self, way: Way) {
        self.way = way;
    }

    /// Feed override from now on: 0 to 2, and 1 for the programmed feed. What is not between these is taken as the
    /// nearest that is, and less than a ten-thousandth as 0.
    pub fn set_override(&mut self, factor: f64) {
        let factor = libm::fmin(factor, MOST_OVERRIDE);
        self.factor = if factor >= LEAST_OVERRIDE { factor } else { 0.0 };
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
    ///
    /// # Errors
    /// A place ahead that the machine cannot be at, as soon as it is at rest before that and is to continue.
    pub fn tick(&mut self, kinematics: &Kinematics) -> Result<Output, Unreachable> {
        self.plan(kinematics)?;
        self.play(kinematics)
    }

    /// A share of the planning: corners, then nodes, then passes over them.
    fn plan(&mut self, kinematics: &Kinematics) -> Result<(), Unreachable> {
        let mut work = WORK;
        self.idle = false;
        if !self.horizon.waiting() {
            self.horizon.obey(self.wanted());
        }
        // Not only when no more nodes can be had.
        if self.horizon.waiting() && self.nodes.end > self.horizon.in_force() + WINDOW {
            work = work.saturating_sub(self.begin());
        }
        loop {
            let cost = if !self.horizon.waiting() {
                let done = self.horizon.run(&mut self.nodes, &self.bounds, work);
                if !self.horizon.waiting() {
                    break;
                }
                done
            } else if work >= CORNER && !self.laid && self.track.decide(&self.bounds) {
                CORNER
            } else if work < most_work(self.space) {
                break;
            } else {
                if let extended @ 1.. = self.extend(kinematics) {
                    extended
                } else if work < BEGIN {
                    break;
                } else if let begun @ 1.. = self.begin() {
                    begun
                } else {
                    if let (Some(place), true) = (self.blocked, self.rests()) {
                        return Err(place);
                    }
                    self.idle = true;
                    break;
                }
            };
            work = work.saturating_sub(cost);
        }
        Ok(())
    }

    /// Appends a node, if there is room and the path is settled far enough; says how much work that was.
    fn extend(&mut self, kinematics: &Kinematics) -> u32 {
        if self.laid {
            return 0;
        }
        self.release();
        if self.blocked.is_some() {
            return 0;
        }
        let ground = Ground {
            track: &self.track,
            space: self.space,
            kinematics,
            bounds: &self.bounds,
        };
        let in_force = self.horizon.in_force();
        match self.grid.extend(&ground, &mut self.nodes, in_force) {
            Ok(work) => {
                self.laid = work == 0;
                work
            }
            Err(place) => {
                self.blocked = Some(place);
                0
            }
        }
    }

    /// The nodes lead in the direction in which the machine is to go.
    fn along(&self) -> bool {
        match self.way {
            Way::Forward => self.grid.direction() > 0.0,
            Way::Back => self.grid.direction() < 0.0,
            Way::Hold => false,
        }
    }

    /// What the plan is for now.
    fn wanted(&self) -> PlanRequest {
        let stop = !self.along() || self.factor <= 0.0;
        PlanRequest {
            stop,
            factor: if stop { 0.0 } else { self.factor },
        }
    }

    /// The output has come to rest.
    pub fn rested(&self) -> bool {
        self.resting >= self.bounds.filter_ticks as u32
    }

    /// At rest at the end of the plan in force, without a hold or stop.
    fn rests(&self) -> bool {
        let ended = self.player.node >= self.horizon.in_force();
        self.rested() && ended && self.way != Way::Hold && self.factor > 0.0
    }

    /// Begins a plan, or turns where the machine has come to rest and is to go the other way; says how much work
    /// it was: none if it did not.
    #[inline]
    fn begin(&mut self) -> u32 {
        let wanted = self.wanted();
        if self.horizon.early(&wanted) {
            return 0;
        }
        self.begin_for(wanted)
    }

    /// A call of its own: in most ticks it is too early for it.
    #[inline(never)]
    fn begin_for(&mut self, wanted: PlanRequest) -> u32 {
        let along = self.along();
        let last = self.horizon.in_force();
        let inside = last + 1 < self.nodes.end && self.nodes.at(last).limit > 0.0;
        if self.rests() && (inside || !along) {
            // From rest the nodes stand closer, and none of the old ones may be the next.
            let direction = if self.way == Way::Forward { 1.0 } else { -1.0 };
            self.grid.again(last, direction, &self.axes, &mut self.nodes);
            (self.blocked, self.laid) = (None, false);
            return BEGIN;
        }
        // At the end of the plan, not at a stop before it.
        let rested = self.rested() && self.player.node >= last;
        let node = self.player.node;
        let begun = self
            .horizon
            .begin(&mut self.nodes, &mut self.player, rested, wanted, &self.bounds);
        match (begun, self.player.node < node) {
            (_, true) => BEGIN + SPLIT,
            (true, false) => BEGIN,
            (false, false) => 0,
        }
    }

    /// Nothing is left to do: where the machine comes to rest it stays.
    fn stays(&self) -> bool {
        let last = self.horizon.in_force();
        let done = self.idle && last + 1 == self.nodes.end && self.along();
        let stopped = self.way == Way::Hold || self.factor <= 0.0;
        self.player.node >= last && self.horizon.waiting() && (done || stopped)
    }

    /// Lets go of what lies behind.
    fn release(&mut self) {
        // In one go for many of them.
        let behind = self.player.node - self.nodes.first;
        if self.nodes.room() == 0 && behind as usize > NODES / 4 {
            // The limit of jerk needs all that the output filter remembers, and more; at rest it remembers nothing.
            let mut time = if self.rested() { f64::INFINITY } else { 0.0 };
            let mut oldest = self.player.node;
            while oldest > self.nodes.first
                && (time < 2.0 * self.bounds.filter || oldest + NODES as u32 / 8 > self.player.node)
            {
                oldest -= 1;
                time += self.nodes.at(oldest).lasts;
            }
            self.nodes.first = oldest;
        }
        if self.way != Way::Forward {
            // All that is passed on the way to a stop may have to be gone back over.
            return;
        }
        // What lies further behind than this cannot be gone back to.
        let most = track::REACH + ELEMENTS as u32 / 4;
        let mut oldest = self.planned_hint.saturating_sub(most).max(self.track.first);
        if self.track.room() <= ELEMENTS / 2 {
            let newest = self.planned_hint.saturating_sub(track::REACH);
            let place = self.planned.s - self.keep;
            let beyond = |oldest: u32| self.track.ends_before(oldest + track::REACH, place);
            while oldest < newest && beyond(oldest) {
                oldest += 1;
            }
        }
        self.track.release(oldest);
    }

    fn play(&mut self, kinematics: &Kinematics) -> Result<Output, Unreachable> {
        let ticks = self.bounds.filter_ticks as u32;
        let last = self.horizon.in_force();
        let node = self.player.node;
        self.player.step(&self.nodes, last, ticks);
        self.horizon.watch(self.player.node);
        let planned = self.player.state(&self.nodes, last);
        self.resting = if planned.s == self.planned.s {
            self.resting.saturating_add(1)
        } else {
            0
        };
        self.laid &= self.player.node == node && self.resting == 0;
        self.planned = planned;
        let axes = match self.space {
            PathSpace::Axes => self.planned_axes::<AXES>(kinematics),
            PathSpace::Tool => self.planned_axes::<POSE_CHANNELS>(kinematics),
        }?;
        self.axes = axes.position;
        self.filter.push(&axes, &self.planned);
        let along = self.filter.along();
        let piece = self.track.find(along.s, &mut self.output_hint);
        Ok(Output {
            axes: self.filter.axes(),
            along,
            line: piece.map_or(0, |piece| piece.element.line),
            feed: piece.map_or(0.0, |piece| piece.element.feed),
            at_rest: self.resting >= ticks && self.stays(),
        })
    }

    /// The axes at the planned place, which takes the first `N` channels of the path.
    #[inline]
    fn planned_axes<const N: usize>(&mut self, kinematics: &Kinematics) -> Result<AxisMotion, Unreachable> {
        let SpeedState { s, v, a } = self.planned;
        let Some(point) = self.track.at::<N>(s, &mut self.planned_hint) else {
            return Ok(AxisMotion::at_rest(&self.axes));
        };
        match at_unit_speed(kinematics, &point, self.space, &self.axes) {
            Ok(axes) => Ok(axes.at_speed(v, a)),
            Err(source) => {
                let piece = self.track.get(self.planned_hint);
                let line = piece.map_or(0, |piece| piece.element.line);
                Err(Unreachable { line, s, source })
            }
        }
    }
}

impl<const ELEMENTS: usize, const NODES: usize> Default for Planner<ELEMENTS, NODES> {
    fn default() -> Self {
        Self::new()
    }
}
