//! Planning ahead, a little every tick: the plan in force stays as it is until a better one is whole.
//!
//! A pass back finds the speeds from which the machine can stop in time, a pass forward takes the highest of them,
//! both inside boxes for the acceleration of every row. The output filter makes the jerk at a time t the
//! difference of the accelerations at t and one filter length before, divided by that length; where that is too
//! much, the boxes are made smaller, and the passes repeated.

use super::braking::Cut;
use super::limits::Bounds;
use super::node::{Lanes, Nodes, REST, pause};
use super::plan::Place;
use super::split::{PutIn, SPARE, STEPS, moved, split};
use crate::ticks::PATH_PERIOD_S;

/// Work of planning in one turn. Work is counted in looks at an interval, that is at its rows at both ends; the last step
/// of a turn may go beyond it. Twice as much is more than a board has time for; half as much slows dense programs down.
pub(super) const WORK: u32 = 190;
/// Work of a visit to a node, beside the intervals that it looks at.
pub(super) const VISIT: u32 = 6;
/// Rounds in which boxes may also grow.
const RELAXED: u32 = 2;
/// Most nodes that a plan goes beyond the one in force; half of them are the fewest, if it has them.
pub(super) const WINDOW: u32 = 64;
/// Time before the slowing at the end of the plan in force that may be planned again, in lengths of the
/// output filter,
const SLACK: f64 = 14.0;
/// A plan is not begun earlier than this many times the time it needs,
const EARLY: f64 = 3.0;
/// and whether it is time is looked at after a quarter of what is left;
/// it has to be ready in this many times that,
const MARGIN: f64 = 1.7;
/// and at least in this many.
const TIGHT: f64 = 1.2;
/// Work that a plan is expected to need for each node, as long as nothing else is known.
const WORK_OF_NODE: f64 = 105.0;
/// Work that a plan to stop is expected to need.
const WORK_OF_STOP: f64 = 800.0;
/// How fast what is expected goes to what was needed, if that was more; a quarter as fast, if less.
const RISE: f64 = 0.5;
/// Largest factor of the time that a plan is given.
const MOST_PATIENCE: u32 = 8;

/// What the planner does next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// Nothing is being planned.
    Waiting,
    /// The plan in force is being taken over as the start of the new one, and this node is next.
    Ready(u32),
    /// The search for the lowest speeds that are possible has come to this node.
    Brake(u32),
    /// It is tried to let go of the acceleration from this node on.
    Release(u32),
    /// The pass back has come to this node.
    Back(u32),
    /// The pass forward has come to this node.
    Forward(u32),
    /// The making smaller of boxes, by itself, has come to this node.
    Repair(u32),
    /// The plan is whole and good, and waits to be taken.
    Whole,
}

/// What a plan is for.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanRequest {
    /// To come to rest as soon as possible, not at the end of what is known.
    pub stop: bool,
    /// Feed override; 0 to stop.
    pub factor: f64,
}

/// A plan being made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horizon {
    pub(super) phase: Phase,
    /// Oldest node whose acceleration matters.
    pub(super) history: u32,
    /// First node whose speed may change.
    pub(super) commit: u32,
    /// Last node, at rest.
    pub(super) last: u32,
    /// Last node of the plan in force.
    pub(super) in_force: u32,
    /// First node that the first round looks at.
    pub(super) start: u32,
    /// First node at which the next pass forward may find something else than the one before.
    pub(super) from: u32,
    /// Where the last pass forward began.
    pub(super) began: u32,
    /// Last node whose boxes were changed by the last pass back.
    pub(super) until: u32,
    /// First and last node whose speeds the last pass forward changed.
    pub(super) moved: [u32; 2],
    /// By how much the times of nodes beyond it were moved by that pass \[s\].
    pub(super) shift: f64,
    /// First node whose speed is another one than in the plan in force.
    pub(super) lowest: u32,
    /// Rounds of passes so far.
    pub(super) round: u32,
    /// Rounds in which boxes may also grow: none after a plan was given up.
    pub(super) relaxed: u32,
    /// The boxes are those of an earlier plan.
    pub(super) warm: bool,
    /// A plan was dropped, perhaps in the middle of a pass: what was found of one node need not fit the next.
    torn: bool,
    /// What the plan being made is for.
    pub(super) wanted: PlanRequest,
    /// First node at which all speeds are the wanted ones again.
    pub(super) settled: u32,
    /// First node whose boxes are still those of the plan in force.
    pub(super) opened: u32,
    /// Where the search for the lowest speeds has come to rest.
    pub(super) braked: u32,
    /// The interval at whose end the machine comes to rest, if it was cut for that.
    pub(super) cut: Option<Cut>,
    /// Speeds have to come down below those of the plan in force.
    pub(super) braking: bool,
    /// The reach of the node looked at last is not as in the round before.
    pub(super) reach_changed: bool,
    /// The plan being made was slowed down as a whole.
    pub(super) scaled: bool,
    /// The plan in force is one to stop.
    stopping: bool,
    /// Where nodes were put in to begin the plan.
    pub(super) put_in: PutIn,
    /// Feed override of the plan in force.
    factor: f64,
    /// Work on the plan being made, and what plans have taken for each node, in the mean.
    spent: u32,
    work_of_node: f64,
    /// Ticks until it is worth looking again whether a plan has to be begun.
    early: u32,
    /// Longer time for a plan after others were given up: a factor.
    pub(super) patience: u32,
    /// Largest change of acceleration above its limit, as a share.
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
        start: 0,
        from: 0,
        began: 0,
        until: 0,
        moved: [0; 2],
        shift: 0.0,
        lowest: 0,
        round: 0,
        relaxed: RELAXED,
        warm: false,
        torn: false,
        wanted: PlanRequest {
            stop: false,
            factor: 1.0,
        },
        settled: 0,
        opened: 0,
        braked: 0,
        cut: None,
        braking: false,
        scaled: false,
        reach_changed: false,
        stopping: false,
        put_in: [0; STEPS + 1],
        factor: 1.0,
        spent: 0,
        work_of_node: WORK_OF_NODE,
        early: 0,
        patience: 1,
        excess: REST,
        away: 0,
        work: 0,
        given_up: 0,
        taken: 0,
    };

    /// With nothing planned, at rest at a node.
    pub const fn at(node: u32) -> Self {
        Self {
            in_force: node,
            ..Self::NONE
        }
    }

    pub fn waiting(&self) -> bool {
        self.phase == Phase::Waiting
    }

    /// A plan is being made.
    pub fn plans(&self) -> bool {
        !matches!(self.phase, Phase::Waiting | Phase::Whole)
    }

    /// A plan is whole, and not taken yet.
    pub fn is_whole(&self) -> bool {
        self.phase == Phase::Whole
    }

    /// The plan in force rests at node `last`, which need not be where it was told to.
    pub fn come_to(&mut self, last: u32) {
        self.stopping &= self.in_force == last;
        self.in_force = last;
    }

    /// A plan being made is of no use when the machine is to be slower than that; one for a lower override is finished,
    /// else an override that keeps falling would never be obeyed.
    pub fn obey<const N: usize>(&mut self, nodes: &mut Nodes<N>, wanted: PlanRequest) {
        let faster = self.wanted.factor >= self.factor || wanted.stop;
        if wanted.factor < self.wanted.factor && faster {
            self.drop_plan(nodes);
        }
    }

    /// The plan in force continues as wished, and it is not yet time to look whether another has to be begun.
    pub fn early(&mut self, wanted: &PlanRequest) -> bool {
        self.early = if self.goes_on(wanted) {
            self.early.saturating_sub(1)
        } else {
            0
        };
        self.early > 0
    }

    /// The plan in force is for what is wanted.
    pub fn goes_on(&self, wanted: &PlanRequest) -> bool {
        !wanted.stop && wanted.factor == self.factor
    }

    /// Begins a plan, if there is something new, and says so.
    pub fn begin<const N: usize>(
        &mut self,
        nodes: &mut Nodes<N>,
        player: &mut Place,
        rested: bool,
        wanted: PlanRequest,
        bounds: &Bounds,
    ) -> bool {
        self.put_in = PutIn::default();
        let (mut next, mut left) = self.next(nodes, player);
        let goes_on = self.goes_on(&wanted);
        if wanted.factor != self.wanted.factor {
            self.patience = 1;
        }
        // A window that is long enough to stop in, and short enough to be planned before it is passed.
        // A lower override is a matter of the plan in force alone.
        let slower = !wanted.stop && wanted.factor < self.factor && player.node < self.in_force;
        let mut last = match slower {
            true => self.in_force,
            false => nodes.rest((nodes.end - 1).min(self.in_force + WINDOW)),
        };
        let nothing = match wanted.stop {
            true => self.stopping,
            false => last <= self.in_force && goes_on,
        };
        if nothing || last < next || goes_on && last == next {
            return false;
        }
        let mut slowing = if goes_on { self.slowing(nodes, next) } else { next };
        let work_of_node = f64::from(self.patience) * self.work_of_node;
        let until = left + (next..slowing).map(|i| nodes.at(i).lasts).sum::<f64>();
        if goes_on && nodes.at(slowing).x > 0.0 {
            // Many nodes at once are less work; but they must be planned in time.
            let needed = time_of(f64::from(last - slowing) * work_of_node);
            let early = until - EARLY * needed;
            if last < self.in_force + WINDOW && early > 0.0 {
                self.early = (0.25 * early / PATH_PERIOD_S) as u32;
                return false;
            }
            let affordable = (until / (MARGIN * time_of(work_of_node))) as u32;
            let beyond = affordable.saturating_sub(self.in_force - slowing);
            // Where the machine creeps there is time for any number.
            last = nodes.rest(
                last.min(
                    self.in_force
                        .saturating_add((WINDOW / 2).max(beyond) / self.patience),
                ),
            );
        }
        // A lower override reaches some way beyond where it is obeyed.
        let most = if slower { WINDOW } else { u32::MAX };
        let share = if goes_on { 1 } else { self.patience };
        let work = match wanted.stop {
            true => f64::from(self.patience) * WORK_OF_STOP,
            false => f64::from((last - slowing).min(most) / share) * work_of_node,
        };
        // It should be ready before the slowing begins.
        let tight = TIGHT * time_of(work) + SPARE * PATH_PERIOD_S;
        let lead = until.clamp(tight, libm::fmax(tight, MARGIN * time_of(work)));
        if !goes_on {
            let slows = wanted.stop || wanted.factor < self.factor;
            self.put_in = split(nodes, [next, self.in_force], left, lead, slows, bounds);
            player.node = moved(player.node, &self.put_in);
            (next, left) = self.next(nodes, player);
            slowing = next;
            if last <= next {
                return false;
            }
        }
        let earliest = nodes.before(slowing, next, SLACK * bounds.filter);
        let commit = self.commit(nodes, next, left, lead, earliest, wanted.stop);
        if wanted.stop && nodes.at(commit).x <= 0.0 {
            // The machine comes to rest there anyway; now it stays.
            (self.in_force, self.stopping) = (commit, true);
            return false;
        }
        // From rest: what came before is forgotten only when the output has come to rest too.
        let rest = nodes.at(commit).x <= 0.0;
        if commit == last || rest && !rested {
            return false;
        }
        let remembered = if rest { 0.0 } else { bounds.remembered };
        self.history = nodes.before(commit, nodes.first, remembered);
        self.start = nodes.before(slowing.max(commit), commit, bounds.remembered);
        // What kept the plans before it from being good may lie beyond a shorter one.
        let nearer = nodes.rest(last.min(commit + (WINDOW / 2).max((last - commit) / share)));
        let last = match (wanted.stop, goes_on || slower || nearer <= commit) {
            (true, _) => commit + 1,
            (false, true) => last,
            (false, false) => nearer,
        };
        (self.commit, self.last) = (commit, last);
        (self.warm, self.excess, self.spent) = (true, REST, 0);
        for i in commit..=last {
            let node = nodes.at_mut(i);
            (node.factor, node.brake, node.floor) = (wanted.factor, 0.0, f32::NEG_INFINITY);
        }
        let node = nodes.at_mut(self.history);
        (node.time, node.trial, node.speed) = (0.0, node.x, libm::sqrt(node.x));
        self.wanted = wanted;
        self.phase = Phase::Ready(self.history);
        true
    }

    /// The node to which the player is on the way, and the time \[s\] until it is there.
    fn next<const N: usize>(&self, nodes: &Nodes<N>, player: &Place) -> (u32, f64) {
        match player.node < self.in_force {
            true => (player.node + 1, nodes.at(player.node).lasts - player.time),
            false => (self.in_force, 0.0),
        }
    }

    /// First node, from `player` on, from which the plan in force only slows down to its end.
    fn slowing<const N: usize>(&self, nodes: &Nodes<N>, player: u32) -> u32 {
        let mut slowing = self.in_force;
        while slowing > player && nodes.at(slowing - 1).x > nodes.at(slowing).x {
            slowing -= 1;
        }
        slowing
    }

    /// First node that will not have been played, and is not before `earliest`, when `lead` \[s\] are over: what
    /// comes before it stays as it is.
    fn commit<const N: usize>(
        &self,
        nodes: &Nodes<N>,
        player: u32,
        left: f64,
        lead: f64,
        earliest: u32,
        stop: bool,
    ) -> u32 {
        let after = |lead: f64, earliest: u32| {
            let (mut commit, mut time) = (player, left);
            while commit < self.in_force && (time < lead || commit < earliest) {
                time += nodes.at(commit).lasts;
                commit += 1;
            }
            (commit, time)
        };
        let (commit, time) = after(lead, earliest);
        if commit < self.in_force || stop {
            return commit;
        }
        // Little is left: there must be time to continue without a stop.
        let sooner = after(0.6 * time, player).0;
        let before = player.max(self.in_force - 1);
        match sooner > before && time - nodes.at(before).lasts >= 0.6 * lead {
            true => before,
            false => sooner,
        }
    }

    /// Times and accelerations up to the start are as they are.
    pub(super) fn ready<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if i == self.start {
            self.restart(nodes);
            return;
        }
        self.work += 1;
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let (x, end) = (node.x, next.x);
        let time = node.time + node.lasts + pause(next, bounds);
        let a = ((end - x) / (2.0 * node.delta)) as f32;
        let next = nodes.at_mut(i + 1);
        (next.time, next.trial, next.speed) = (time, end, libm::sqrt(end));
        for side in &mut nodes.at_mut(i).sides {
            side.allowed = side.accelerations(a, x as f32);
        }
        self.phase = Phase::Ready(i + 1);
    }

    /// Begins the first round: with a look at how slow the machine can be.
    pub(super) fn restart<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        let node = nodes.at_mut(self.commit);
        node.brake = node.x;
        self.braking = self.wanted.stop || node.x > 0.0 && self.wanted.factor < self.factor;
        if self.braking || self.torn {
            self.start = self.commit;
        }
        (self.from, self.until, self.lowest) = (self.start, self.last, self.start);
        self.round = 0;
        self.scaled = false;
        self.opened = self.commit;
        if self.braking {
            self.phase = Phase::Brake(self.commit);
        } else {
            nodes.at_mut(self.last).reach = 0.0;
            self.phase = Phase::Back(self.last);
        }
    }

    /// Gives up the plan being made if the player has come to where it begins.
    pub fn watch<const N: usize>(&mut self, nodes: &mut Nodes<N>, player: u32) {
        let stands = player == self.commit && player == self.in_force;
        if self.phase != Phase::Waiting && player >= self.commit && !stands {
            self.give_up(nodes);
        }
    }

    pub(super) fn give_up<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        self.drop_plan(nodes);
        self.given_up += 1;
        self.relaxed = 0;
        self.patience = (2 * self.patience).min(MOST_PATIENCE);
    }

    fn drop_plan<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        self.mend(nodes);
        self.torn |= self.phase != Phase::Waiting;
        self.phase = Phase::Waiting;
    }

    /// Goes on with the plan being made for as long as there is `most` work; says how much it was.
    pub fn run<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds, most: u32) -> u32 {
        self.work = 0;
        while self.plans() && self.work < most {
            self.visit(nodes, bounds);
        }
        self.spent += self.work;
        self.work
    }

    /// ṡ² and the time to the next of node `i`, in the plan that is whole.
    pub fn whole<const N: usize>(&self, nodes: &Nodes<N>, i: u32, bounds: &Bounds) -> (f64, f64) {
        let node = nodes.at(i);
        let x = if i > self.lowest { node.trial } else { node.x };
        if i < self.lowest || i >= self.last {
            return (x, node.lasts);
        }
        let next = nodes.at(i + 1);
        (x, next.time - pause(next, bounds) - node.time)
    }

    /// The plan that is whole was taken.
    pub fn take<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        debug_assert!(
            self.whole(nodes, self.last, bounds).0 <= 0.0,
            "a plan ends at rest"
        );
        for i in self.lowest..=self.last {
            let (x, lasts) = self.whole(nodes, i, bounds);
            let node = nodes.at_mut(i);
            (node.x, node.lasts) = (x, lasts);
        }
        if !self.wanted.stop {
            let more = f64::from(self.spent) / f64::from(self.last - self.start) - self.work_of_node;
            self.work_of_node += if more > 0.0 { RISE } else { 0.25 * RISE } * more;
        }
        self.keep_cut(nodes);
        self.in_force = self.last;
        self.taken += 1;
        (self.relaxed, self.torn) = (RELAXED, false);
        self.patience = 1;
        self.stopping = self.wanted.stop;
        self.factor = self.wanted.factor;
        self.phase = Phase::Waiting;
    }
}

/// Time that an amount of work takes \[s\].
fn time_of(work: f64) -> f64 {
    work / f64::from(WORK) * PATH_PERIOD_S
}
