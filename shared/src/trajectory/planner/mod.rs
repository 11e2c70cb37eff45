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
mod rate;
mod rounding;
mod scan;
mod track;

pub use limits::PlanLimits;

use super::reference::at_unit_speed;
use super::{Element, PathSpace, ReferenceError, SpeedState};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};
use crate::motion::PATH_PERIOD_S;
use filter::Filter;
use grid::{Grid, Ground};
use horizon::Horizon;
use limits::{ACCELERATION_RESERVE, Bounds, JERK_RESERVE, PATH_ROW, ROWS};
use node::Nodes;
use player::Player;
use rate::{Gentle, Rate};
use thiserror::Error;
use track::Track;

/// Highest feed override.
const MOST_OVERRIDE: f64 = 2.0;
/// Work of one tick, in visits of nodes.
const WORK: u32 = 16;
/// Work to append a node, in the same unit.
const APPEND: u32 = 3;
/// Nodes behind the machine that are kept, to run backwards along; fewer where elements are short.
const KEPT: u32 = 64;
/// Nodes behind the machine that are always kept: more than an output filter is long.
const NEEDED: u32 = 32;

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
    rate: Rate,
    way: Way,
    /// Feed override.
    factor: f64,
    filter: Filter,
    /// Where the unfiltered references are.
    planned: SpeedState,
    axes: [f64; AXES],
    planned_hint: u32,
    output_hint: u32,
    kept_hint: u32,
    /// Node that the machine can go back to.
    oldest: u32,
    /// Ticks since the plan has come to rest.
    resting: u32,
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
            rate: Rate::FORWARD,
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
            kept_hint: 0,
            oldest: 0,
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
        self.rate = Rate::FORWARD;
        self.way = Way::Forward;
        self.planned = SpeedState { s, v: 0.0, a: 0.0 };
        self.axes = *axes;
        (self.planned_hint, self.output_hint, self.kept_hint, self.oldest) = (0, 0, 0, 0);
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

    /// Goes another way, gently, from now on.
    pub fn go(&mut self, way: Way) {
        self.way = way;
    }

    /// Feed override from now on: 0 to 2, and 1 for the programmed feed. What is not between these is taken as the
    /// nearest that is.
    pub fn set_override(&mut self, factor: f64) {
        self.factor = libm::fmin(libm::fmax(factor, 0.0), MOST_OVERRIDE);
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
        let mut work = WORK;
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
                libm::fmax(self.factor, 1.0),
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
        let nodes = if self.nodes.room() > NODES / 2 {
            KEPT
        } else {
            NEEDED
        };
        self.nodes.first = self.nodes.first.max(self.player.node.saturating_sub(nodes));
        // Nodes remember accelerations, for which elements are not needed: those of short lines go first.
        let element = if self.track.room() > ELEMENTS / 2 {
            self.track
                .find(self.nodes.at(self.nodes.first).s, &mut self.kept_hint);
            self.kept_hint
        } else {
            self.planned_hint
        };
        self.track.release(element.saturating_sub(track::REACH));
        let from = self.track.kept_s();
        self.oldest = self.oldest.max(self.nodes.first);
        while self.oldest < self.player.node && self.nodes.at(self.oldest).s < from {
            self.oldest += 1;
        }
    }

    fn play(&mut self, kinematics: &Kinematics) -> Result<Output, ReferenceError> {
        let ticks = self.bounds.filter_ticks as u32;
        let last = self.horizon.in_force();
        let time = self.rate.pass();
        self.player.step(time, &self.nodes, [self.oldest, last], ticks);
        self.horizon.watch(self.player.node);
        let plan = self.player.state(&self.nodes, last);
        self.resting = if plan.s == self.planned.s {
            self.resting.saturating_add(1)
        } else {
            0
        };
        let unit = match self.track.at(plan.s, &mut self.planned_hint) {
            Some(point) => at_unit_speed(kinematics, &point, self.space, &self.axes)?,
            None => AxisMotion {
                position: self.axes,
                velocity: [0.0; AXES],
                acceleration: [0.0; AXES],
            },
        };
        self.change_rate(&plan, &unit);
        let Rate { value, change } = self.rate;
        self.planned = SpeedState {
            s: plan.s,
            v: value * plan.v,
            a: value * value * plan.a + change * plan.v,
        };
        let axes = unit.at_speed(self.planned.v, self.planned.a);
        self.axes = axes.position;
        let (axes, along) = self.filter.push(&axes, &self.planned);
        let line = self
            .track
            .find(along.s, &mut self.output_hint)
            .map_or(0, |piece| piece.element.line);
        let stands = match self.way {
            Way::Forward => self.player.node >= last && self.horizon.waiting(),
            Way::Hold => value == 0.0,
            Way::Back => value == 0.0 || self.player.node == self.oldest,
        };
        Ok(Output {
            axes,
            along,
            line,
            at_rest: stands && self.resting >= ticks,
        })
    }

    /// Brings the rate nearer to what is wanted, where the plan is at `plan` and the axes move by `unit` over s.
    fn change_rate(&mut self, plan: &SpeedState, unit: &AxisMotion) {
        let last = self.horizon.in_force();
        let planned_for = self.nodes.at(self.player.node).factor;
        let forward = libm::fmin(self.factor / planned_for, 1.0);
        let wanted = match self.way {
            Way::Forward => forward,
            Way::Hold => 0.0,
            Way::Back => -forward,
        };
        let Rate { value, change } = self.rate;
        if value == wanted && change == 0.0 && wanted >= 0.0 {
            return;
        }
        let axes = unit.at_speed(plan.v, plan.a);
        let rows = |path: f64, axes: &[f64; AXES]| {
            let mut rows = [0.0; ROWS];
            rows[PATH_ROW] = path;
            rows[PATH_ROW + 1..=AXES].copy_from_slice(axes);
            rows
        };
        let speed = rows(plan.v, &axes.velocity);
        let gentle = Gentle::at(&speed, &self.player, &self.nodes, last, &self.bounds);
        let wanted = if wanted < 0.0 && self.ends_behind(&gentle) {
            0.0
        } else {
            wanted
        };
        // What the output filter forgets with this tick decides how much the accelerations may be.
        let (old_axes, old) = self.filter.oldest();
        let old = rows(old.a, &old_axes.acceleration);
        let planned = rows(plan.a, &axes.acceleration);
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        for row in 0..ROWS {
            let most = f64::from(self.bounds.acceleration[row]) / ACCELERATION_RESERVE;
            let swing = f64::from(self.bounds.swing[row]) / JERK_RESERVE;
            let now = value * value * planned[row];
            let low = (libm::fmax(-most, old[row] - swing) - now) / speed[row];
            let high = (libm::fmin(most, old[row] + swing) - now) / speed[row];
            if speed[row] != 0.0 {
                range[0] = libm::fmax(range[0], libm::fmin(low, high));
                range[1] = libm::fmin(range[1], libm::fmax(low, high));
            }
        }
        self.rate.step(wanted, &gentle, range);
    }

    /// Whether the machine, going back, has to slow down for the end of what is kept.
    fn ends_behind(&self, gentle: &Gentle) -> bool {
        let first = self.nodes.at(self.oldest);
        let rate = libm::fabs(self.rate.value);
        let needed = rate * (0.5 * rate / gentle.change + gentle.change / gentle.bend);
        first.x > 0.0 && self.player.gone(&self.nodes, self.oldest) <= needed + 4.0 * PATH_PERIOD_S
    }
}

impl<const ELEMENTS: usize, const NODES: usize> Default for Planner<ELEMENTS, NODES> {
    fn default() -> Self {
        Self::new()
    }
}
