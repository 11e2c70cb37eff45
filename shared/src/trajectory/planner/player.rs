//! What the path tick does: plays the plan in force, evaluates path and kinematics there, and filters.
//!
//! Plans are made elsewhere ([`Planning`](super::Planning)), into the buffer that is not played, and taken whole at the
//! beginning of a tick.

use super::channels::POSE_CHANNELS;
use super::filter::Filter;
use super::limits::{Bounds, PlanLimits};
use super::plan::{Place, Plan};
use super::played::Played;
use super::track::{self, PushError, Track};
use super::{Output, Way};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};
use crate::trajectory::reference::at_unit_speed;
use crate::trajectory::{Element, PathSpace, SpeedState, Unreachable};

/// Highest feed override, and the lowest that is not a stop: with less a weld at 9 m/min would go 15 µm/s, and squares of
/// speeds would go out of what single precision holds.
const MOST_OVERRIDE: f64 = 2.0;
const LEAST_OVERRIDE: f64 = 1e-4;

/// The end of the planner that the path tick has: elements, the plan in force, and the output filter.
#[derive(Clone, Debug)]
pub struct Player<const ELEMENTS: usize, const NODES: usize> {
    pub(super) track: Track<ELEMENTS>,
    pub(super) bounds: Bounds,
    space: PathSpace,
    /// Counts the paths begun.
    path: u32,
    wish: Wish,
    /// So much behind the machine is kept, if it is no more than a quarter of the elements \[mm\].
    keep: f64,
    plans: [Plan<NODES>; 2],
    /// The plan in force.
    active: usize,
    /// The other one is whole, and its number.
    offered: Option<u32>,
    /// Number of the last plan taken.
    taken: u32,
    place: Place,
    /// Where the unfiltered references are.
    planned: SpeedState,
    axes: [f64; AXES],
    planned_hint: u32,
    output_hint: u32,
    filter: Filter,
    /// Ticks since the plan has come to rest.
    resting: u32,
    news: News,
    /// The turn of planning after the last tick has not ended.
    turn: bool,
    /// Turns that had not ended at the next tick.
    missed: u32,
    played: Played,
}

/// How planning reaches the player, which path ticks use too: on a board behind a lock, each time for no longer than it
/// takes to evaluate the path at one place.
pub trait PlayerAccess<const ELEMENTS: usize, const NODES: usize> {
    /// Calls `use_it` with the player; no path tick comes meanwhile.
    fn with<R>(&mut self, use_it: impl FnOnce(&mut Player<ELEMENTS, NODES>) -> R) -> R;
}

/// In step with the ticks there is nobody else.
impl<const ELEMENTS: usize, const NODES: usize> PlayerAccess<ELEMENTS, NODES> for Player<ELEMENTS, NODES> {
    fn with<R>(&mut self, use_it: impl FnOnce(&mut Self) -> R) -> R {
        use_it(self)
    }
}

/// What is asked of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wish {
    pub way: Way,
    /// Feed override.
    pub factor: f64,
}

impl Wish {
    /// Nothing but what is programmed.
    pub const NONE: Self = Self {
        way: Way::Forward,
        factor: 1.0,
    };

    /// To come to rest, and stay.
    pub fn stands(&self) -> bool {
        self.way == Way::Hold || self.factor <= 0.0
    }
}

/// Where the player is, as planning sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    /// Counts the paths begun.
    pub path: u32,
    pub space: PathSpace,
    pub wish: Wish,
    /// Number of the last plan taken.
    pub taken: u32,
    /// Last node of the plan in force.
    pub last: u32,
    pub place: Place,
    /// Path length there \[mm\], and where the axes are.
    pub s: f64,
    pub axes: [f64; AXES],
    /// The output has come to rest.
    pub rested: bool,
    /// The plan stands at the same place as at the tick before.
    pub stands: bool,
    /// Serial after the newest element.
    pub elements: u32,
}

/// What planning tells beside its plans, and what it knew then.
#[derive(Clone, Copy, Debug)]
pub(super) struct News {
    pub wish: Wish,
    pub elements: u32,
    /// No plan is being made.
    pub waiting: bool,
    /// Nothing is left to plan.
    pub done: bool,
    /// The machine is to continue, and the path leads here, where it cannot be.
    pub blocked: Option<Unreachable>,
}

impl News {
    const NONE: Self = Self {
        wish: Wish::NONE,
        elements: 0,
        waiting: false,
        done: false,
        blocked: None,
    };
}

impl<const ELEMENTS: usize, const NODES: usize> Player<ELEMENTS, NODES> {
    /// Without elements, at rest.
    pub const fn new() -> Self {
        Self {
            track: Track::new(),
            bounds: Bounds::NONE,
            space: PathSpace::Tool,
            path: 0,
            wish: Wish::NONE,
            keep: 0.0,
            plans: [const { Plan::NONE }; 2],
            active: 0,
            offered: None,
            taken: 0,
            place: Place::at(0),
            planned: SpeedState::at_rest(0.0),
            axes: [0.0; AXES],
            planned_hint: 0,
            output_hint: 0,
            filter: Filter::new(),
            resting: 0,
            news: News::NONE,
            turn: false,
            missed: 0,
            played: Played::from([0.0; AXES]),
        }
    }

    /// Forgets all elements; the next ones begin at path length `s` \[mm\], with the machine at rest and its
    /// axes at `axes`.
    pub fn start(&mut self, limits: &PlanLimits, space: PathSpace, s: f64, axes: &[f64; AXES]) {
        self.bounds = Bounds::build(limits);
        self.space = space;
        self.path = self.path.wrapping_add(1);
        self.track.clear(s);
        self.wish.way = Way::Forward;
        self.keep = 0.0;
        self.place = Place::at(NODES as u32);
        (self.active, self.offered) = (0, None);
        self.plans[0].rest_at(NODES as u32, s);
        self.planned = SpeedState::at_rest(s);
        self.axes = *axes;
        (self.planned_hint, self.output_hint) = (0, 0);
        let rest = AxisMotion::at_rest(axes);
        self.filter.settle(self.bounds.filter_ticks, &rest, &self.planned);
        self.resting = self.bounds.filter_ticks as u32;
        (self.news, self.turn) = (News::NONE, false);
        self.played = Played::from(*axes);
    }

    /// How many elements there is room for now.
    pub fn room(&self) -> usize {
        self.track.room()
    }

    /// Appends an element. The last one of a program has [`Join::Stop`](crate::trajectory::Join::Stop); before that one is
    /// there, the plan ends somewhat before the end of the last one known, because its corner is not.
    pub fn push(&mut self, element: Element) -> Result<(), PushError> {
        self.track.push(element)
    }

    /// Keeps `distance` \[mm\] of the path behind the machine from now on, so that it can go back so far whenever it
    /// comes to rest, as long as that is no more than a quarter of the elements.
    pub fn keep(&mut self, distance: f64) {
        self.keep = distance;
    }

    /// Goes another way from now on, inside all limits.
    pub fn go(&mut self, way: Way) {
        self.wish.way = way;
    }

    /// Feed override from now on: 0 to 2, and 1 for the programmed feed. What is not between these is taken as the
    /// nearest that is, and less than a ten-thousandth as 0.
    pub fn set_override(&mut self, factor: f64) {
        let factor = libm::fmin(factor, MOST_OVERRIDE);
        self.wish.factor = if factor >= LEAST_OVERRIDE { factor } else { 0.0 };
    }

    /// Where the path is before the output filter.
    pub fn planned(&self) -> SpeedState {
        self.planned
    }

    /// What was put out since [`Self::start`].
    pub fn played(&self) -> Played {
        self.played
    }

    /// The output has come to rest.
    pub fn rested(&self) -> bool {
        self.resting >= self.bounds.filter_ticks as u32
    }

    /// Counts the paths begun.
    pub fn path(&self) -> u32 {
        self.path
    }

    /// How often a turn of planning had not ended at the tick after the one that it followed. What it offers is taken
    /// later then.
    pub fn missed(&self) -> u32 {
        self.missed
    }

    /// One path tick: the next references. A turn of planning is due after it.
    ///
    /// # Errors
    /// A place ahead that the machine cannot be at, as soon as it is at rest before that and is to continue.
    pub fn tick(&mut self, kinematics: &Kinematics) -> Result<Output, Unreachable> {
        self.missed = self.missed.wrapping_add(u32::from(self.turn));
        self.turn = true;
        self.take();
        self.release();
        if let (Some(place), true) = (self.news.blocked, self.is_up_to_date()) {
            return Err(place);
        }
        self.place
            .step(&self.plans[self.active], self.bounds.filter_ticks as u32);
        let planned = self.place.state(&self.plans[self.active]);
        self.resting = if planned.s == self.planned.s {
            self.resting.saturating_add(1)
        } else {
            0
        };
        self.planned = planned;
        let axes = match self.space {
            PathSpace::Axes => self.planned_axes::<AXES>(kinematics),
            PathSpace::Tool => self.planned_axes::<POSE_CHANNELS>(kinematics),
        }?;
        self.axes = axes.position;
        self.filter.push(&axes, &self.planned);
        let along = self.filter.along();
        let piece = self.track.find(along.s, &mut self.output_hint);
        let axes = self.filter.axes();
        self.played.add(&axes.position);
        Ok(Output {
            axes,
            along,
            line: piece.map_or(0, |piece| piece.element.line),
            feed: piece.map_or(0.0, |piece| piece.element.feed),
            at_rest: self.rested() && self.stays(),
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

    /// Takes the plan that is offered, unless it comes too late: then it would change what has been played.
    fn take(&mut self) {
        let Some(number) = self.offered.take() else {
            return;
        };
        let next = 1 - self.active;
        let last = self.plans[self.active].last;
        let stands = self.place.node == last;
        if self.plans[next].fits(&mut self.place, stands) {
            (self.active, self.taken) = (next, number);
        }
    }

    /// What is asked for, and the elements, are what planning knew.
    fn is_up_to_date(&self) -> bool {
        self.news.wish == self.wish && self.news.elements == self.track.end
    }

    /// Nothing is left to do: where the machine comes to rest it stays.
    fn stays(&self) -> bool {
        let ended = self.place.node >= self.plans[self.active].last;
        let nothing = if self.wish.stands() {
            self.news.wish.stands()
        } else {
            self.is_up_to_date() && self.news.done
        };
        ended && self.news.waiting && nothing
    }

    /// Lets go of elements that lie behind.
    fn release(&mut self) {
        if self.wish.way != Way::Forward || self.place.leads_back(&self.plans[self.active]) {
            // All that is passed on the way to a stop may have to be gone back over; and where it leads back, on the way
            // to the stop before it leads forward again.
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

    /// For planning: where the player is.
    pub(super) fn progress(&self) -> Progress {
        Progress {
            path: self.path,
            space: self.space,
            wish: self.wish,
            taken: self.taken,
            last: self.plans[self.active].last,
            place: self.place,
            s: self.planned.s,
            axes: self.axes,
            rested: self.rested(),
            stands: self.resting > 0,
            elements: self.track.end,
        }
    }

    /// For planning: the plan that is not played.
    pub(super) fn next_plan(&mut self) -> &mut Plan<NODES> {
        &mut self.plans[1 - self.active]
    }

    /// From planning of `path`: the plan that is not played is whole, and has this `number`.
    pub(super) fn offer(&mut self, path: u32, number: u32) {
        if path == self.path {
            self.offered = Some(number);
        }
    }

    /// From planning of `path`, at the end of its turn.
    pub(super) fn tell(&mut self, path: u32, news: News) {
        if path == self.path {
            (self.news, self.turn) = (news, false);
        }
    }
}

impl<const ELEMENTS: usize, const NODES: usize> Default for Player<ELEMENTS, NODES> {
    fn default() -> Self {
        Self::new()
    }
}
