//! Planning ahead, a little every tick: the plan in force stays as it is until a better one is whole.
//!
//! A pass back finds the speeds from which the machine can stop in time, a pass forward takes the highest of them,
//! both inside boxes for the acceleration of every row. The output filter makes the jerk at a time t the
//! difference of the accelerations at t and one filter length before, divided by that length; where that is too
//! much, the boxes are made smaller, and the passes repeated.

use super::WORK;
use super::limits::Bounds;
use super::node::{Lanes, Nodes, most};
use super::scan::{brake, reach};
use super::swing::{REST, pause};
use crate::motion::PATH_PERIOD_S;

/// Rounds of passes that a plan is given before it is given up.
const ROUNDS: u32 = 12;
/// Rounds in which boxes may also grow.
const RELAXED: u32 = 2;
/// A plan is good if no swing of the acceleration is above its limit by more than this share.
const GOOD: f32 = 0.025;
/// Time before the end's slowing that is planned anew, in lengths of the output filter.
const SLACK: f64 = 14.0;
/// Node visits of both passes and all rounds that a plan is expected to need for each node.
const VISITS: u32 = 16;

/// Work of a visit, of the search for a reach, and of each of its iterations.
const VISIT: u32 = 5;
const REACH: u32 = 2;
const ITERATION: u32 = 4;
/// Nodes taken over for a unit of work.
const TAKEN_FOR_ONE: u32 = 6;
/// Work that a visit usually is.
const USUAL: u32 = 7;
/// Most nodes that a plan goes beyond the one in force.
const WINDOW: u32 = 64;
/// Node visits that a plan to stop is expected to need.
const STOP_VISITS: u32 = 200;
/// Largest factor of the time that a plan is given.
const MOST_PATIENCE: u32 = 8;

/// What the planner does next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// Nothing is being planned.
    Waiting,
    /// The search for the lowest speeds that are possible has come to this node.
    Brake(u32),
    /// The pass back has come to this node.
    Back(u32),
    /// The pass forward has come to this node.
    Forward(u32),
    /// The making smaller of boxes, by itself, has come to this node.
    Repair(u32),
    /// The plan is whole and good.
    Take,
}

/// What a plan is for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    /// To come to rest as soon as possible, not at the end of what is known.
    pub stop: bool,
    /// Feed override, above 0.
    pub factor: f64,
}

/// A plan being made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horizon {
    phase: Phase,
    /// Oldest node whose acceleration matters.
    history: u32,
    /// First node whose speed may change.
    pub(super) commit: u32,
    /// Last node, at rest.
    pub(super) last: u32,
    /// Last node of the plan in force.
    in_force: u32,
    pub(super) round: u32,
    /// Rounds in which boxes may also grow: none after a plan was given up.
    pub(super) relaxed: u32,
    /// The boxes are those of an earlier plan.
    warm: bool,
    /// What the plan being made is for.
    wish: Wish,
    /// Speeds have to come down below those of the plan in force.
    braking: bool,
    /// The reach of the node looked at last is not as in the round before.
    reach_changed: bool,
    /// The plan being made was slowed down as a whole.
    pub(super) scaled: bool,
    /// The plan in force is one to stop.
    stopping: bool,
    /// Feed override of the plan in force.
    factor: f64,
    /// Longer time for a plan after others were given up: a factor.
    patience: u32,
    /// Largest swing above its limit, as a share.
    pub(super) excess: Lanes,
    /// Node before the time one filter length away.
    pub(super) away: u32,
    /// Work of this step.
    pub(super) work: u32,
    /// Plans given up, for display.
    pub given_up: u32,
    /// Plans taken.
    pub taken: u32,
}

impl Horizon {
    pub const NONE: Self = Self {
        phase: Phase::Waiting,
        history: 0,
        commit: 0,
        last: 0,
        in_force: 0,
        round: 0,
        relaxed: RELAXED,
        warm: false,
        wish: Wish {
            stop: false,
            factor: 1.0,
        },
        braking: false,
        scaled: false,
        reach_changed: false,
        stopping: false,
        factor: 1.0,
        patience: 1,
        excess: REST,
        away: 0,
        work: 0,
        given_up: 0,
        taken: 0,
    };

    pub fn waiting(&self) -> bool {
        self.phase == Phase::Waiting
    }

    /// Last node of the plan in force.
    pub fn in_force(&self) -> u32 {
        self.in_force
    }

    /// Begins a plan, if there is something new, and says so: the player is on the way to node `player`, reached in
    /// `left` \[s\].
    pub fn begin<const N: usize>(
        &mut self,
        nodes: &mut Nodes<N>,
        player: u32,
        left: f64,
        rested: bool,
        wish: Wish,
        bounds: &Bounds,
    ) -> bool {
        // A window that is long enough to stop in, and short enough to be planned before it is passed.
        let mut last = (nodes.end - 1).min(self.in_force.max(player) + WINDOW);
        // A single interval between two places at rest would last for ever.
        if last > nodes.first && nodes.at(last - 1).limit <= 0.0 {
            last -= 1;
        }
        let nothing = match wish.stop {
            true => self.stopping,
            false => last <= self.in_force && wish.factor == self.factor,
        };
        if nothing || last <= player {
            return false;
        }
        let mut slowing = player;
        if !wish.stop && wish.factor == self.factor {
            // What slows down only for the end of the plan in force is planned anew, and some time before it.
            slowing = self.in_force;
            while slowing > player && nodes.at(slowing - 1).x > nodes.at(slowing).x {
                slowing -= 1;
            }
            let mut before = 0.0;
            while slowing > player && before < SLACK * bounds.filter {
                slowing -= 1;
                before += nodes.at(slowing).lasts;
            }
        }
        // What will have been played before the plan can be ready stays.
        let visits = if wish.stop {
            STOP_VISITS
        } else {
            VISITS * (last - slowing)
        };
        let mut lead = f64::from(2 + self.patience * visits * USUAL / WORK) * PATH_PERIOD_S;
        let (mut commit, mut time) = (player, left);
        while commit < self.in_force && (time < lead || commit < slowing) {
            time += nodes.at(commit).lasts;
            commit += 1;
        }
        if commit == self.in_force && time < 1.6 * lead {
            // Little is left: there must be time to go on without a stop.
            lead = 0.6 * time;
            (commit, time) = (player, left);
            while commit < self.in_force && time < lead {
                time += nodes.at(commit).lasts;
                commit += 1;
            }
        }
        if wish.stop && nodes.at(commit).x <= 0.0 {
            // The machine comes to rest there anyway; now it stays.
            (self.in_force, self.stopping) = (commit, true);
            return false;
        }
        let (mut history, mut before) = (commit, 0.0);
        if nodes.at(commit).x <= 0.0 {
            // From rest: what came before is forgotten only when the output has come to rest too.
            if !rested {
                return false;
            }
            before = f64::INFINITY;
        }
        while history > nodes.first && before <= 1.5 * bounds.filter {
            history -= 1;
            before += nodes.at(history).lasts;
        }
        (self.history, self.commit, self.last) = (history, commit, last);
        (self.warm, self.excess) = (true, REST);
        // Times and accelerations up to the commit are as they are.
        nodes.at_mut(history).time = 0.0;
        for i in history..commit {
            let (from, to) = (*nodes.at(i), nodes.at(i + 1).x);
            let next = nodes.at_mut(i + 1);
            next.time = from.time + from.lasts + pause(next, bounds);
            let node = nodes.at_mut(i);
            node.trial = node.x;
            let a = ((to - from.x) / (2.0 * from.delta)) as f32;
            for side in &mut node.sides {
                side.allowed = side.accelerations(a, from.x as f32);
            }
        }
        let node = nodes.at_mut(commit);
        (node.trial, node.speed) = (node.x, libm::sqrt(node.x));
        for i in commit + 1..=last {
            let node = nodes.at_mut(i);
            (node.factor, node.brake) = (wish.factor, 0.0);
        }
        self.wish = wish;
        if wish.stop {
            self.last = commit + 1;
        }
        self.restart(nodes);
        true
    }

    /// Begins the first round: with a look at how slow the machine can be.
    fn restart<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        let node = nodes.at_mut(self.commit);
        node.brake = node.x;
        self.braking = self.wish.stop || node.x > node.cap_of_feed();
        self.round = 0;
        self.scaled = false;
        self.phase = Phase::Brake(self.commit);
    }

    /// Gives up the plan being made if the player has come to where it begins.
    pub fn watch(&mut self, player: u32) {
        let stands = player == self.commit && player == self.in_force;
        if self.phase != Phase::Waiting && player >= self.commit && !stands {
            self.give_up();
        }
    }

    fn give_up(&mut self) {
        self.given_up += 1;
        self.relaxed = 0;
        self.patience = (2 * self.patience).min(MOST_PATIENCE);
        self.phase = Phase::Waiting;
    }

    /// Work of the next step, as far as it is known before.
    pub fn least_work(&self) -> u32 {
        match self.phase {
            Phase::Take => (self.last - self.commit) / TAKEN_FOR_ONE + 1,
            _ => VISIT,
        }
    }

    /// One visit of one node, or the taking of a plan; says how much work that was.
    pub fn step<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) -> u32 {
        self.work = self.least_work();
        self.visit(nodes, bounds);
        self.work
    }

    fn visit<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        match self.phase {
            Phase::Waiting => {}
            Phase::Take => self.take(nodes, bounds),
            Phase::Brake(i) => self.brake(nodes, i),
            Phase::Back(i) if i > self.commit => {
                let repaired = self.round > 0 && !self.braking && self.repair(nodes, i - 1, bounds);
                // Most nodes stay as they were in the round before.
                if repaired || self.reach_changed || self.round == 0 || self.braking {
                    let next = nodes.at(i).reach;
                    let node = nodes.at_mut(i - 1);
                    let (x, iterations) = reach(node, next);
                    self.work += REACH + iterations * ITERATION;
                    self.reach_changed = x != node.reach;
                    node.reach = x;
                }
                self.phase = Phase::Back(i - 1);
            }
            Phase::Back(i) => {
                if self.round > 0 && !self.braking && self.is_good() {
                    self.phase = Phase::Take;
                } else if nodes.at(i).reach < nodes.at(i).x * (1.0 - 1e-6) {
                    self.too_fast(nodes, bounds);
                } else if self.round == ROUNDS {
                    self.last_resort(nodes);
                } else {
                    self.round += 1;
                    self.excess = REST;
                    self.away = self.history;
                    self.phase = Phase::Forward(i);
                }
            }
            Phase::Forward(i) if i < self.last => {
                self.forward(nodes, i, bounds);
                self.phase = Phase::Forward(i + 1);
            }
            Phase::Forward(i) => {
                self.away = i - 1;
                self.reach_changed = false;
                self.phase = if self.braking || self.scaled {
                    Phase::Repair(i)
                } else {
                    Phase::Back(i)
                };
            }
            Phase::Repair(i) if i > self.commit => {
                self.repair(nodes, i - 1, bounds);
                self.phase = Phase::Repair(i - 1);
            }
            Phase::Repair(i) => {
                if self.is_good() {
                    self.phase = Phase::Take;
                } else if self.scaled || self.round == ROUNDS {
                    self.last_resort(nodes);
                } else {
                    // The boxes have changed, and with them how slow the machine can be.
                    self.phase = Phase::Brake(i);
                }
            }
        }
    }

    /// The rounds have not led to a good plan. One from rest may be slower as a whole: accelerations go with x, and
    /// so do their swings. Otherwise the plan in force goes on, to rest.
    fn last_resort<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        if nodes.at(self.commit).x > 0.0 {
            self.give_up();
            return;
        }
        let excess = self.excess.into_iter().fold(0.0, most);
        let slower = 1.0 / (1.0 + 1.2 * f64::from(excess));
        for i in self.commit..=self.last {
            nodes.at_mut(i).trial *= slower;
        }
        self.scaled = true;
        self.excess = REST;
        self.away = self.history;
        self.work += (self.last - self.commit) / TAKEN_FOR_ONE;
        self.phase = Phase::Forward(self.commit);
    }

    /// No swing of the acceleration is too large.
    fn is_good(&self) -> bool {
        self.excess.iter().all(|excess| *excess <= GOOD)
    }

    /// The lowest speed at the node after `i`, until that is as low as it shall be.
    fn brake<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32) {
        let node = nodes.at(i);
        let enough = if self.wish.stop { 0.0 } else { node.cap_of_feed() };
        if node.brake <= enough || i + 1 == nodes.end {
            if self.wish.stop {
                self.last = self.last.max(i);
            }
            nodes.at_mut(self.last).reach = 0.0;
            self.phase = Phase::Back(self.last);
        } else {
            nodes.at_mut(i + 1).brake = brake(node, node.brake);
            self.phase = Phase::Brake(i + 1);
        }
    }

    /// The speed at the commit is given, and the boxes do not allow it: with full boxes it is possible.
    fn too_fast<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        if !self.warm {
            self.give_up();
            return;
        }
        self.warm = false;
        for i in self.commit..self.last {
            for side in &mut nodes.at_mut(i).sides {
                side.open(bounds);
            }
        }
        self.restart(nodes);
    }

    fn take<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        for i in self.commit..self.last {
            let next = nodes.at_mut(i + 1);
            next.x = next.trial;
            let end = next.time - pause(next, bounds);
            let node = nodes.at_mut(i);
            node.lasts = end - node.time;
        }
        self.in_force = self.last;
        self.taken += 1;
        self.relaxed = RELAXED;
        self.patience = 1;
        self.stopping = self.wish.stop;
        self.factor = self.wish.factor;
        self.phase = Phase::Waiting;
    }
}
