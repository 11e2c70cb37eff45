//! Planning ahead: corners, then nodes, then passes over them, and plans handed to the player.
//!
//! It runs beside the path ticks, a turn after each of them, and knows of the player what that was at the tick. What it
//! offers in a turn is taken at the next tick: so the same plans are taken at the same ticks wherever turns end
//! before the next tick, whatever they were interrupted by.

use super::Way;
use super::grid::Grid;
use super::horizon::{Horizon, PlanRequest, VISIT, WINDOW, WORK};
use super::limits::Bounds;
use super::node::Nodes;
use super::plan::{Knot, Place};
use super::player::{News, PlayerAccess, Progress, Wish};
use super::sample::Ground;
use super::split::PutIn;
use crate::io::AXES;
use crate::kinematics::Kinematics;
use crate::trajectory::{PathSpace, Unreachable};

/// Work to begin a plan, and as much again to split intervals for it; every node put in is two visits more.
const BEGIN: u32 = 6 * VISIT;

/// The end of the planner that looks ahead.
#[derive(Clone, Debug)]
pub struct Planning<const NODES: usize> {
    bounds: Bounds,
    grid: Grid,
    nodes: Nodes<NODES>,
    horizon: Horizon,
    /// What was known of the player at the tick before this turn.
    progress: Progress,
    /// Counts the plans offered.
    offers: u32,
    /// What was offered, and the player has not looked at yet.
    offered: Option<Offer>,
    /// No node could be appended, and since then no element came and no node was passed.
    laid: bool,
    /// Why no node follows the newest one: for the planner, the path ends there.
    blocked: Option<Unreachable>,
}

/// What is offered to the player.
#[derive(Clone, Copy, Debug)]
enum Offer {
    /// A new plan.
    New,
    /// The plan in force, with more nodes or an earlier end.
    Changed,
}

impl<const NODES: usize> Planning<NODES> {
    /// Of no path.
    pub const fn new() -> Self {
        Self {
            bounds: Bounds::NONE,
            grid: Grid::NONE,
            nodes: Nodes::new(),
            horizon: Horizon::NONE,
            progress: Progress::NONE,
            offers: 0,
            offered: None,
            laid: false,
            blocked: None,
        }
    }

    /// Plans taken, and plans given up because they were not ready in time or not good enough.
    pub fn plans(&self) -> (u32, u32) {
        (self.horizon.taken, self.horizon.given_up)
    }

    /// One turn: a bounded share of the work, for the `player` as it was left by its last tick.
    pub fn turn<const ELEMENTS: usize>(
        &mut self,
        player: &mut impl PlayerAccess<ELEMENTS, NODES>,
        kinematics: &Kinematics,
    ) {
        self.follow(player);
        let idle = self.plan(player, kinematics);
        let last = self.horizon.in_force;
        let news = News {
            wish: self.progress.wish,
            elements: self.progress.elements,
            waiting: self.horizon.waiting(),
            done: idle && last + 1 == self.nodes.end && self.along(),
            blocked: self.blocked.filter(|_| idle && self.rests()),
        };
        player.with(|player| player.tell(self.progress.path, news));
    }

    /// Learns where the player is, and what became of the plan that was offered to it.
    fn follow<const ELEMENTS: usize>(&mut self, player: &mut impl PlayerAccess<ELEMENTS, NODES>) {
        let before = core::mem::replace(&mut self.progress, player.with(|player| player.progress()));
        let now = &self.progress;
        if now.path != before.path {
            self.bounds = player.with(|player| player.bounds);
            (self.offered, self.laid, self.blocked) = (None, false, None);
            self.grid.start(now.s, &now.axes, &mut self.nodes);
            self.horizon = Horizon::at(self.nodes.first);
            return;
        }
        let on = now.place.node == before.place.node && !now.stands;
        self.laid &= on && now.elements == before.elements;
        match self.offered.take() {
            Some(Offer::New) if now.taken == self.offers => self.horizon.take(&mut self.nodes, &self.bounds),
            Some(Offer::Changed) => self.horizon.come_to(now.last),
            Some(Offer::New) | None => {}
        }
        self.horizon.watch(&mut self.nodes, now.place.node);
    }

    /// A turn's work; says whether nothing is left to do.
    fn plan<const ELEMENTS: usize>(
        &mut self,
        player: &mut impl PlayerAccess<ELEMENTS, NODES>,
        kinematics: &Kinematics,
    ) -> bool {
        let mut work = WORK;
        let wanted = self.wanted();
        self.horizon.obey(&mut self.nodes, wanted);
        // Not only when no more nodes can be had.
        // A hold or another override may split the plan in force, which is the work of a turn. From rest it is better to know
        // more of the path first: a short plan ends before the next one is ready.
        let urgent = !self.horizon.goes_on(&wanted) && !self.rests();
        let many = self.nodes.end > self.horizon.in_force + WINDOW;
        if self.horizon.waiting() && (many || urgent && self.offered.is_none()) {
            work = work.saturating_sub(self.begin(player));
        }
        loop {
            if self.horizon.is_whole() && self.offered.is_none() {
                let last = self.horizon.last;
                self.offer(player, Offer::New, last);
                work = work.saturating_sub(last - self.progress.place.node);
            }
            let cost = if self.horizon.plans() {
                let done = self.horizon.run(&mut self.nodes, &self.bounds, work);
                if self.horizon.plans() {
                    return false;
                }
                done
            } else if !self.laid && player.with(|player| player.track.decide(&self.bounds)) {
                VISIT
            } else if let extended @ 1.. = self.extend(player, kinematics) {
                extended
            } else if self.offered.is_some() || urgent && work < WORK {
                return false;
            } else if let begun @ 1.. = self.begin(player) {
                begun
            } else {
                return true;
            };
            work = work.saturating_sub(cost);
            if work == 0 {
                return false;
            }
        }
    }

    /// Appends a node, if there is room and the path is settled far enough; says how much work that was.
    fn extend<const ELEMENTS: usize>(
        &mut self,
        player: &mut impl PlayerAccess<ELEMENTS, NODES>,
        kinematics: &Kinematics,
    ) -> u32 {
        if self.laid {
            return 0;
        }
        self.release();
        if self.blocked.is_some() {
            return 0;
        }
        let mut ground = Ground {
            player,
            space: self.progress.space,
            kinematics,
            bounds: &self.bounds,
        };
        let in_force = self.horizon.in_force;
        match self.grid.extend(&mut ground, &mut self.nodes, in_force) {
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
        match self.progress.wish.way {
            Way::Forward => self.grid.direction() > 0.0,
            Way::Back => self.grid.direction() < 0.0,
            Way::Hold => false,
        }
    }

    /// What the plan is for now.
    fn wanted(&self) -> PlanRequest {
        let factor = self.progress.wish.factor;
        let stop = !self.along() || factor <= 0.0;
        PlanRequest {
            stop,
            factor: if stop { 0.0 } else { factor },
        }
    }

    /// At rest at the end of the plan in force, without a hold or stop.
    fn rests(&self) -> bool {
        let ended = self.progress.place.node >= self.horizon.in_force;
        self.progress.rested && ended && !self.progress.wish.stands()
    }

    /// Begins a plan, or turns where the machine has come to rest and is to go the other way; says how much work
    /// it was: none if it did not.
    fn begin<const ELEMENTS: usize>(&mut self, player: &mut impl PlayerAccess<ELEMENTS, NODES>) -> u32 {
        let wanted = self.wanted();
        if self.horizon.early(&wanted) {
            return 0;
        }
        let along = self.along();
        let last = self.horizon.in_force;
        let inside = last + 1 < self.nodes.end && self.nodes.at(last).limit > 0.0;
        if self.rests() && (inside || !along) {
            // From rest the nodes stand closer, and none of the old ones may be the next.
            let back = self.progress.wish.way == Way::Back;
            let direction = if back { -1.0 } else { 1.0 };
            self.grid
                .again(last, direction, &self.progress.axes, &mut self.nodes);
            (self.blocked, self.laid) = (None, false);
            return BEGIN;
        }
        let node = self.progress.place.node;
        // At the end of the plan, not at a stop before it.
        let rested = self.progress.rested && node >= last;
        let begun = self.horizon.begin(
            &mut self.nodes,
            &mut self.progress.place,
            rested,
            wanted,
            &self.bounds,
        );
        let more = node - self.progress.place.node;
        if more > 0 || self.horizon.in_force < last {
            self.offer(player, Offer::Changed, last);
        }
        match (begun, more > 0) {
            (_, true) => 2 * BEGIN + 2 * VISIT * more + last - self.progress.place.node,
            (true, false) => BEGIN,
            (false, false) => 0,
        }
    }

    /// Offers a plan with the nodes up to `last`: the one that is whole, or the one in force again.
    fn offer<const ELEMENTS: usize>(
        &mut self,
        player: &mut impl PlayerAccess<ELEMENTS, NODES>,
        offer: Offer,
        last: u32,
    ) {
        for i in self.progress.place.node..=last {
            let node = self.nodes.at(i);
            let planned = match offer {
                Offer::New => self.horizon.whole(&self.nodes, i, &self.bounds),
                Offer::Changed => (node.x, node.lasts),
            };
            let knot = Knot::of(node, planned);
            player.with(|player| player.next_plan().set(i, knot));
        }
        let rest = self.horizon.in_force;
        let (rest, commit, put_in) = match offer {
            Offer::New => (None, Some(self.horizon.commit), PutIn::default()),
            Offer::Changed => (Some(rest).filter(|rest| *rest < last), None, self.horizon.put_in),
        };
        self.offers = self.offers.wrapping_add(1);
        self.offered = Some(offer);
        player.with(|player| {
            let plan = player.next_plan();
            (plan.last, plan.rest, plan.commit, plan.put_in) = (last, rest, commit, put_in);
            player.offer(self.progress.path, self.offers);
        });
    }

    /// Lets go of nodes that lie behind.
    fn release(&mut self) {
        // In one go for many of them.
        let player = self.progress.place.node;
        let behind = player - self.nodes.first;
        if !self.nodes.is_full() || behind as usize <= NODES / 4 {
            return;
        }
        // The limit of jerk needs all that the output filter remembers, and more; at rest it remembers nothing.
        let mut time = if self.progress.rested { f64::INFINITY } else { 0.0 };
        let mut oldest = player;
        while oldest > self.nodes.first
            && (time < self.bounds.remembered || oldest + NODES as u32 / 8 > player)
        {
            oldest -= 1;
            time += self.nodes.at(oldest).lasts;
        }
        self.nodes.first = oldest;
    }
}

impl<const NODES: usize> Default for Planning<NODES> {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    const NONE: Self = Self {
        path: 0,
        space: PathSpace::Tool,
        wish: Wish::NONE,
        taken: 0,
        last: 0,
        place: Place::at(0),
        s: 0.0,
        axes: [0.0; AXES],
        rested: false,
        stands: false,
        elements: 0,
    };
}
