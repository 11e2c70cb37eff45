//! Rounds of passes over the nodes of a plan being made. Only where boxes have changed, or what is one filter length
//! away from that, is looked at again.

use super::horizon::{Horizon, Phase, VISIT};
use super::limits::Bounds;
use super::node::{Nodes, REST, most};
use super::scan::reach;

/// Rounds of passes that a plan is given before it is given up.
const ROUNDS: u32 = 12;
/// A plan is good if no change of acceleration is above its limit by more than this share.
const GOOD: f32 = 0.025;
/// After the last round, so much will do: with what is kept in reserve the limit of jerk holds still.
const FAIR: f32 = 0.045;

impl Horizon {
    /// One visit of one node, or a step from one pass to the next.
    pub(super) fn visit<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        match self.phase {
            Phase::Waiting | Phase::Whole => {}
            Phase::Brake(i) => self.brake(nodes, i, bounds),
            Phase::Release(i) => self.release(nodes, i, bounds),
            Phase::Ready(i) => self.ready(nodes, i, bounds),
            Phase::Back(i) if self.goes_back(nodes, i, bounds) => {
                self.back(nodes, i - 1, bounds);
                self.phase = Phase::Back(i - 1);
            }
            Phase::Back(i) => {
                if self.round > 0 && !self.braking && self.is_good() {
                    self.phase = Phase::Whole;
                } else if is_too_fast(nodes, i) || self.braking && comes_too_fast(nodes, self.settled) {
                    self.begin_cold(nodes);
                } else {
                    self.next_round(nodes, bounds);
                }
            }
            Phase::Forward(i) if self.goes_forward(nodes, i, bounds) => {
                self.forward(nodes, i, bounds);
                self.phase = Phase::Forward(i + 1);
            }
            Phase::Forward(i) => self.end_forward(nodes, i, bounds),
            Phase::Repair(i) if i > self.commit => {
                self.repair(nodes, i - 1, bounds);
                self.phase = Phase::Repair(i - 1);
            }
            Phase::Repair(i) => {
                if self.is_good() {
                    self.phase = Phase::Whole;
                } else if self.scaled || self.round == ROUNDS {
                    self.last_resort(nodes, bounds);
                } else {
                    // The boxes have changed, and with them how slow the machine can be.
                    self.phase = Phase::Brake(i);
                }
            }
        }
    }

    pub(super) fn next_round<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        if self.round == ROUNDS {
            self.last_resort(nodes, bounds);
        } else {
            self.round += 1;
            self.excess = REST;
            self.begin_forward(nodes, bounds);
        }
    }

    /// The rounds have not led to a good plan. One from rest may be slower as a whole: accelerations go with x, and
    /// so do their changes of acceleration. Otherwise the plan in force continues, to rest.
    fn last_resort<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        if nodes.at(self.commit).x > 0.0 {
            self.give_up(nodes);
            return;
        }
        let excess = self.excess.into_iter().fold(0.0, most);
        let slower = 1.0 / (1.0 + 1.2 * f64::from(excess));
        for i in self.commit..=self.last {
            nodes.at_mut(i).trial *= slower;
        }
        self.scaled = true;
        self.excess = REST;
        self.from = self.commit;
        self.begin_forward(nodes, bounds);
    }

    /// Whether the pass back has more to do below node `i`.
    fn goes_back<const N: usize>(&self, nodes: &Nodes<N>, i: u32, bounds: &Bounds) -> bool {
        if i == self.commit {
            return false;
        }
        if self.round == 0 {
            return i > self.start || is_too_fast(nodes, i);
        }
        // Below, nothing was looked at by the pass forward, and nothing that has changed is as near in time as the
        // filter's length.
        self.braking
            || self.reach_changed
            || is_too_fast(nodes, i)
            || i > self.began
            || i >= self.moved[0]
            || nodes.at(i).time + bounds.filter >= nodes.at(self.moved[0] - 1).time
    }

    /// One step of the pass back: boxes and reach of node `i`.
    fn back<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        self.work += 1;
        if self.braking && i < self.settled {
            nodes.at_mut(i).reach = nodes.at(i).brake;
            return;
        }
        self.renew(nodes, i, bounds);
        let first = self.round == 0 || self.braking;
        let repaired = !first && self.repair(nodes, i, bounds);
        if repaired {
            self.until = self.until.max(i);
            self.from = self.from.min(i);
        }
        // Most nodes stay as they were in the round before.
        if repaired || self.reach_changed || first {
            let next = nodes.at(i + 1).reach;
            let node = nodes.at_mut(i);
            let (x, iterations) = reach(node, next, node.cap());
            self.work += (1 + iterations) * VISIT / 2;
            self.reach_changed = x != node.reach;
            node.reach = x;
        }
        if self.reach_changed || first || is_too_fast(nodes, i + 1) {
            self.from = self.from.min(i.saturating_sub(1).max(self.commit));
        }
    }

    /// Begins a pass forward where the last pass back has changed something.
    fn begin_forward<const N: usize>(&mut self, nodes: &Nodes<N>, bounds: &Bounds) {
        self.from = self.from.max(self.commit);
        if self.braking || self.scaled {
            self.from = self.commit;
            self.until = self.last;
        }
        let time = nodes.at(self.from).time - bounds.filter;
        self.away = nodes.passed(self.from, [self.history, self.from], time);
        self.moved = if self.until == self.last {
            [self.from, self.last]
        } else {
            [self.last, self.from]
        };
        self.shift = 0.0;
        self.lowest = self.lowest.min(self.from);
        self.began = self.from;
        self.phase = Phase::Forward(self.from);
    }

    /// Whether the pass forward has more to do from node `i` on.
    fn goes_forward<const N: usize>(&self, nodes: &Nodes<N>, i: u32, bounds: &Bounds) -> bool {
        let near = || nodes.at(i).time - bounds.filter <= nodes.at(self.moved[1] + 1).time;
        i < self.last && (i <= self.until || i <= self.moved[1] + 1 || near())
    }

    /// Begins the pass back, or the repair, where the pass forward has ended.
    fn end_forward<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        for later in i + 1..=self.last {
            nodes.at_mut(later).time += self.shift;
        }
        self.reach_changed = false;
        if self.braking || self.scaled {
            self.away = i - 1;
            self.phase = Phase::Repair(i);
            return;
        }
        self.away = i;
        let time = nodes.at(i).time + bounds.filter;
        while self.away < self.last && nodes.at(self.away).time <= time {
            self.away += 1;
        }
        (self.from, self.until) = (self.last, self.commit);
        self.phase = Phase::Back(i);
    }

    /// No change of acceleration is too large.
    fn is_good(&self) -> bool {
        let most = if self.round == ROUNDS { FAIR } else { GOOD };
        self.excess.iter().all(|excess| *excess <= most)
    }

    /// Boxes of an earlier plan may be what keeps this one from being good, or from the speed at the commit, which is given:
    /// with full boxes that is possible.
    fn begin_cold<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        if !self.warm {
            self.give_up(nodes);
            return;
        }
        self.warm = false;
        self.start = self.commit;
        self.restart(nodes);
    }

    /// Opens the boxes of node `i` in the first round of a plan that does not begin with those of an earlier one.
    fn renew<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if self.warm || self.round > 0 {
            return;
        }
        self.work += 1;
        for side in &mut nodes.at_mut(i).sides {
            side.open(bounds);
        }
    }
}

/// Braking comes to node `i` faster than the machine could stop from there.
fn comes_too_fast<const N: usize>(nodes: &Nodes<N>, i: u32) -> bool {
    let node = nodes.at(i);
    node.reach < node.brake * (1.0 - 1e-6)
}

/// The plan passes node `i` faster than it could stop from there.
fn is_too_fast<const N: usize>(nodes: &Nodes<N>, i: u32) -> bool {
    let node = nodes.at(i);
    node.reach < node.trial * (1.0 - 1e-6)
}
