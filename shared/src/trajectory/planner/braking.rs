//! Braking: the speeds of a plan to stop, or of one for a lower override, until they have come down.
//!
//! Forward in time from the commit, at every node the lowest acceleration that the boxes and the past allow. At the end of
//! that the acceleration has to go: where the limit of jerk does not allow this at once, it is let go from an earlier
//! node on, the last from which it is in time.

use super::horizon::{Horizon, Phase, VISIT, WINDOW};
use super::limits::{Bounds, PATH_ROW, ROWS};
use super::node::{EMPTY, Lanes, Node, Nodes, REST, include, least, most, pause};
use super::scan::lowest;
use super::split::{SLIVER, part};

/// Share of ṡ² that rounding leaves.
const ROUNDED: f64 = 1e-5;
/// Share of the most that an acceleration may change at once with which the machine comes to rest. The rest is for rates
/// that change on the way.
const LAST: f32 = 0.95;

/// An interval that was cut where the machine comes to rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// The node where it begins.
    node: u32,
    /// That and the next, as they were.
    were: [Node; 2],
}

impl Horizon {
    /// The lowest speed at the node after `i`, until that is rest.
    pub(super) fn brake<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if i == self.commit {
            self.mend(nodes);
            (self.away, self.settled) = (self.history, self.commit);
        }
        let node = nodes.at(i);
        if node.brake > self.goal(node) {
            self.settled = i + 1;
        }
        if node.brake > 0.0 {
            self.slow_down(nodes, i, bounds);
            self.phase = Phase::Brake(i + 1);
            return;
        }
        self.braked = i;
        if self.settled > self.commit {
            self.phase = Phase::Release(self.late(nodes, bounds));
        } else {
            self.end_brake(nodes, bounds);
        }
    }

    /// ṡ² at `node` down to which braking goes.
    fn goal(&self, node: &Node) -> f64 {
        if self.wanted.stop { 0.0 } else { node.cap_of_feed() }
    }

    /// The last node from which the acceleration can be let go in time, if the rates of the rows do not change on the way.
    fn late<const N: usize>(&mut self, nodes: &Nodes<N>, bounds: &Bounds) -> u32 {
        let mut from = self.settled - 1;
        while from > self.commit {
            self.work += 1;
            let node = nodes.at(from);
            let change = f64::from(most_change(node, bounds));
            let a = f64::from(node.sides[0].allowed[PATH_ROW]);
            let goal = self.goal(node);
            // From there on with a jerk of `change` in the filter's length, down to `change`.
            let way_down = 0.5 * (a * a / change - change) * bounds.filter;
            if libm::sqrt(node.brake) >= libm::sqrt(goal) + way_down {
                break;
            }
            from -= 1;
        }
        from
    }

    /// Tries to let go of the acceleration from node `from` on, or else earlier.
    pub(super) fn release<const N: usize>(&mut self, nodes: &mut Nodes<N>, from: u32, bounds: &Bounds) {
        if self.release_from(nodes, from, bounds) {
            self.end_brake(nodes, bounds);
        } else if from > self.commit {
            self.phase = Phase::Release(from - 1);
        } else {
            self.give_up(nodes);
        }
    }

    /// Begins the round of passes that looks whether what was found is good.
    fn end_brake<const N: usize>(&mut self, nodes: &mut Nodes<N>, bounds: &Bounds) {
        if self.wanted.stop {
            self.last = self.settled;
            self.next_round(nodes, bounds);
            return;
        }
        let beyond = self.settled + 1;
        for later in beyond..=self.braked.max(beyond).min(self.in_force) {
            nodes.at_mut(later).brake = 0.0;
        }
        // Nodes far beyond would only take time now; they are planned when it is obeyed. In a later round that may be farther.
        let near = self.braked.max(self.settled) + WINDOW / 2 / self.patience;
        self.last = match near < self.in_force && nodes.at(near - 1).limit > 0.0 {
            true => near,
            false => self.in_force,
        };
        nodes.at_mut(self.last).reach = 0.0;
        self.phase = Phase::Back(self.last);
    }

    /// One step of it.
    fn slow_down<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        self.work += VISIT;
        self.open(nodes, i, bounds);
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let x = node.brake;
        let boxes = lowest(node, x);
        let end = |a: f32| {
            let end = x + 2.0 * node.delta * f64::from(a);
            if end > ROUNDED * x {
                libm::fmin(end, next.x)
            } else {
                0.0
            }
        };
        let from = node.time - bounds.filter;
        let to = libm::fmin(passes(node, end(boxes)) - bounds.filter, node.time);
        self.away = nodes.passed(self.away, [self.history, i], from);
        let was = self.along_path(nodes, [self.away, i], [from, to], bounds);
        // The plan in force has kept to what the past demands.
        let in_force = ((next.x - node.x) / (2.0 * node.delta)) as f32;
        let floor = least(demanded(node, &was, bounds), most(in_force, 0.0));
        let x = end(most(boxes, floor));
        nodes.at_mut(i).floor = floor;
        go_to(nodes, i, x, bounds);
    }

    /// Opens the boxes of node `i`, once: they were made for continuing.
    fn open<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if i < self.opened {
            return;
        }
        self.opened = i + 1;
        self.work += 1;
        for side in &mut nodes.at_mut(i).sides {
            side.open(bounds);
        }
    }

    /// Lets go of the acceleration from node `from` on, down to what may change to none at once. Says whether
    /// the speed has come down with no more than may change so, for as long as the output filter remembers.
    fn release_from<const N: usize>(&mut self, nodes: &mut Nodes<N>, from: u32, bounds: &Bounds) -> bool {
        let mut away = from;
        for i in from..self.in_force {
            self.work += VISIT / 2;
            self.open(nodes, i, bounds);
            let (node, next) = (nodes.at(i), nodes.at(i + 1));
            let (x, change) = (node.brake, most_change(node, bounds));
            let since = node.time - bounds.filter;
            away = nodes.passed(away, [self.history, i], since);
            let until = since + passes(node, x) - node.time;
            let highest = self.strongest(nodes, [away, i], until) + change;
            let floor = if i < self.braked {
                node.floor
            } else {
                f32::NEG_INFINITY
            };
            let a = most(most(least(highest, -LAST * change), floor), lowest(node, x));
            let goal = self.goal(next);
            let end = libm::fmin(x + 2.0 * node.delta * f64::from(a), next.x);
            if end > goal + SLIVER * x {
                go_to(nodes, i, end, bounds);
                continue;
            }
            // Where it may be faster than it is, it need not be at once.
            let end_x = libm::fmin(libm::fmin(goal, next.x), libm::fmax(end, x));
            if self.wanted.stop && end < 0.0 {
                self.cut(nodes, i, x / f64::from(-2.0 * a), bounds);
            }
            go_to(nodes, i, end_x, bounds);
            let arrived = nodes.at(i + 1).time - pause(nodes.at(i + 1), bounds);
            away = nodes.passed(away, [self.history, i], arrived - bounds.filter);
            if -self.strongest(nodes, [away, i + 1], arrived) <= change {
                self.settled = i + 1;
                return true;
            }
            self.mend(nodes);
            return false;
        }
        false
    }

    /// The strongest slowing down of braking in the intervals from the first node to the second that begin no later than
    /// a time; none is 0.
    fn strongest<const N: usize>(&mut self, nodes: &Nodes<N>, [first, beyond]: [u32; 2], until: f64) -> f32 {
        self.work += beyond - first;
        (first..beyond)
            .map(|i| nodes.at(i))
            .take_while(|node| node.time <= until)
            .fold(0.0, |strongest, node| {
                least(strongest, node.sides[0].allowed[PATH_ROW])
            })
    }

    /// Cuts the interval of node `i`, so that the next one is `way` from it.
    fn cut<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, way: f64, bounds: &Bounds) {
        let (whole, end) = (*nodes.at(i), *nodes.at(i + 1));
        if way >= (1.0 - SLIVER) * whole.delta {
            return;
        }
        self.cut = Some(Cut {
            node: i,
            were: [whole, end],
        });
        *nodes.at_mut(i) = part(&whole, &end, [0.0, way], bounds);
        nodes.at_mut(i).sides[0] = whole.sides[0];
        *nodes.at_mut(i + 1) = part(&whole, &end, [way, whole.delta], bounds);
    }

    /// Makes an interval whole again that was cut.
    pub(super) fn mend<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        if let Some(cut) = self.cut.take() {
            let [mut whole, end] = cut.were;
            whole.sides[0] = nodes.at(cut.node).sides[0];
            *nodes.at_mut(cut.node) = whole;
            *nodes.at_mut(cut.node + 1) = end;
        }
    }

    /// The plan with a cut interval was taken: the node where it ended comes after the new one.
    pub(super) fn keep_cut<const N: usize>(&mut self, nodes: &mut Nodes<N>) {
        if let Some(cut) = self.cut.take() {
            nodes.insert(cut.node + 2, cut.were[1]);
        }
    }

    /// Lowest and highest accelerations of the rows by that along the path, in the intervals from the first node to
    /// the second that are passed between two times.
    fn along_path<const N: usize>(
        &mut self,
        nodes: &Nodes<N>,
        [first, beyond]: [u32; 2],
        [from, to]: [f64; 2],
        bounds: &Bounds,
    ) -> [Lanes; 2] {
        let mut range = EMPTY;
        if nodes.at(first).time > from || nodes.at(beyond).time < to {
            include(&mut range, &REST);
        }
        let mut i = first;
        while i < beyond && nodes.at(i).time <= to {
            self.work += 1;
            for side in &nodes.at(i).sides {
                include(
                    &mut range,
                    &side.alpha.map(|alpha| alpha * side.allowed[PATH_ROW]),
                );
            }
            i += 1;
            if pause(nodes.at(i), bounds) > 0.0 {
                include(&mut range, &REST);
            }
        }
        range
    }
}

/// Lowest a from which no row is farther from `other` than the limit of jerk allows, but never more than there.
fn demanded(node: &Node, other: &[Lanes; 2], bounds: &Bounds) -> f32 {
    let mut a = f32::NEG_INFINITY;
    for side in &node.sides {
        for row in 0..ROWS {
            let (alpha, change) = (side.alpha[row], bounds.acceleration_change[row]);
            let bound = if alpha > 0.0 {
                other[1][row] - change
            } else {
                other[0][row] + change
            };
            a = most(a, bound / alpha);
        }
    }
    least(a, other[1][PATH_ROW])
}

/// By how much a may change at once in the interval of `node`.
fn most_change(node: &Node, bounds: &Bounds) -> f32 {
    let mut change = f32::INFINITY;
    for side in &node.sides {
        for row in 0..ROWS {
            change = least(change, bounds.acceleration_change[row] / side.alpha[row].abs());
        }
    }
    change
}

/// When the interval of `node` ends, if it begins with the speed of braking, and ends with ṡ² = `x`.
fn passes(node: &Node, x: f64) -> f64 {
    node.time + 2.0 * node.delta / (libm::sqrt(node.brake) + libm::sqrt(x))
}

/// Braking goes from node `i` to ṡ² = `x` at the next one.
fn go_to<const N: usize>(nodes: &mut Nodes<N>, i: u32, x: f64, bounds: &Bounds) {
    let node = nodes.at(i);
    let a = ((x - node.brake) / (2.0 * node.delta)) as f32;
    let (from, time) = (
        node.brake as f32,
        passes(node, x) + pause(nodes.at(i + 1), bounds),
    );
    for side in &mut nodes.at_mut(i).sides {
        side.allowed = side.accelerations(a, from);
    }
    let next = nodes.at_mut(i + 1);
    (next.brake, next.time) = (x, time);
}
