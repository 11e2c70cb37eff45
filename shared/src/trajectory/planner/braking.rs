//! Braking, or how slow the machine can be: the speeds that a plan to stop, or one for a lower override, is not below.
//!
//! First forward in time, from the commit to rest: at every node the lowest acceleration that the boxes and
//! the past allow. Where all speeds have come down to the programmed ones, the plan settles; from there back
//! in time, so that the acceleration is let go in time too. If that does not lead back to the speed at the
//! commit, it settles later.

use super::horizon::{Horizon, LEAST_WINDOW, Phase};
use super::jerk_limit::LOOK;
use super::limits::{Bounds, PATH_ROW, ROWS};
use super::node::{Lanes, Node, Nodes, least, most, pause};
use super::rounds::{ITERATION, OPEN, REACH};
use super::scan::{lowest, reach};

/// Work of a step forward, and of one back beside the search for a reach; nodes looked at for a unit of it.
const BRAKE: u32 = 5;
const LET_GO: u32 = 5;
const LOOKED_AT_FOR_ONE: u32 = 16;
/// Share of ṡ² at the commit that may be too much,
const SPARE: f64 = 0.02;
/// share of what is too much that is taken away, and the most of ṡ² at the last interval.
const TRIMMED: f64 = 0.9;
const MOST_TRIMMED: f64 = 0.75;
/// Share of ṡ² that rounding leaves.
const ROUNDED: f64 = 1e-5;

impl Horizon {
    /// The lowest speed at the node after `i`, until that is rest.
    pub(super) fn brake<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if i == self.commit {
            (self.away, self.settled) = (self.history, self.commit);
        }
        let node = nodes.at(i);
        let ends = i == self.in_force() || i > self.commit && node.limit <= 0.0;
        if node.brake > node.cap_of_feed() {
            self.settled = i + 1;
        }
        if node.brake > 0.0 && !ends {
            self.slow_down(nodes, i, bounds);
            self.phase = Phase::Brake(i + 1);
        } else if node.brake > 0.0 {
            // The plan in force is not faster than it has to be.
            self.give_up();
        } else {
            for later in self.settled..=self.in_force() {
                let node = nodes.at_mut(later);
                node.brake = 0.0;
                if later >= i {
                    node.floor = f32::NEG_INFINITY;
                }
            }
            if !self.wanted.stop {
                // Nodes far beyond would only take time now; they are planned when it is obeyed.
                let near = i.max(self.settled) + LEAST_WINDOW;
                if near < self.last && nodes.at(near - 1).limit > 0.0 {
                    self.last = near;
                }
            }
            self.trim = None;
            self.settle(nodes, self.settled);
        }
    }

    /// One step of it.
    fn slow_down<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        self.work += BRAKE;
        self.open(nodes, i, bounds);
        nodes.at_mut(i).floor = f32::NEG_INFINITY;
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let x = node.brake;
        let per_length = 2.0 * node.delta;
        let boxes = lowest(node, x);
        let end = |a: f32| {
            let end = x + per_length * f64::from(a);
            if end > ROUNDED * x { end } else { 0.0 }
        };
        let speed = libm::sqrt(x);
        let passes = |end: f64| node.time + per_length / (speed + libm::sqrt(end));
        let from = node.time - bounds.filter;
        let to = libm::fmin(passes(end(boxes)) - bounds.filter, node.time);
        while self.away < i && nodes.at(self.away + 1).time <= from {
            self.away += 1;
        }
        let was = self.along_path(nodes, [self.away, i], [from, to], bounds);
        // The plan in force has kept to what the past demands.
        let in_force = ((next.x - node.x) / per_length) as f32;
        let floor = least(demanded(node, &was, bounds), most(in_force, 0.0));
        let a = most(boxes, floor);
        let (brake, time) = (end(a), passes(end(a)) + pause(next, bounds));
        let next = nodes.at_mut(i + 1);
        (next.brake, next.time) = (brake, time);
        let node = nodes.at_mut(i);
        if floor > boxes {
            node.floor = floor;
        }
        for side in &mut node.sides {
            side.allowed = side.accelerations(a, x as f32);
        }
    }

    /// Opens the boxes of node `i`, once: they were made for continuing.
    fn open<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if i < self.opened {
            return;
        }
        self.opened = i + 1;
        self.work += OPEN;
        for side in &mut nodes.at_mut(i).sides {
            side.open(bounds);
        }
    }

    /// Begins to let go of the acceleration before node `settled`.
    fn settle<const N: usize>(&mut self, nodes: &mut Nodes<N>, settled: u32) {
        self.settled = settled;
        if self.wanted.stop {
            self.last = settled;
        }
        let node = nodes.at_mut(settled);
        if settled > self.commit {
            (node.brake, node.time) = (node.cap_of_feed(), 0.0);
        }
        self.away = settled;
        self.phase = Phase::Settle(settled);
    }

    /// The highest speed at the node before `i` from which the machine settles in time.
    pub(super) fn shape<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        if i > self.commit {
            self.let_go(nodes, i - 1, bounds);
            self.phase = Phase::Settle(i - 1);
            return;
        }
        let (node, settled) = (nodes.at(i), self.settled);
        let lacks = node.x - node.brake;
        if settled > i && lacks > ROUNDED * node.x {
            if self.trim.is_some_and(|trim| trim > 0.0) {
                self.trim = Some(0.0);
                self.settle(nodes, settled);
            } else {
                self.trim = None;
                self.settle_later(nodes, lacks, bounds);
            }
            return;
        }
        if settled > i + 1 && self.trim.is_none() && -lacks > SPARE * node.x {
            // What is too much is best taken from the last interval.
            let falls = nodes.at(settled - 1).brake - nodes.at(settled).brake;
            self.trim = Some(libm::fmin(-TRIMMED * lacks, MOST_TRIMMED * falls));
            self.settle(nodes, settled);
            return;
        }
        nodes.at_mut(i).brake = nodes.at(i).x;
        nodes.at_mut(self.last).reach = 0.0;
        self.phase = Phase::Back(self.last);
    }

    fn settle_later<const N: usize>(&mut self, nodes: &mut Nodes<N>, lacks: f64, bounds: &Bounds) {
        let mut steepest = 0.0;
        for i in self.commit..self.settled {
            steepest = most(steepest, -nodes.at(i).sides[0].allowed[PATH_ROW]);
        }
        self.work += (self.settled - self.commit) / LOOKED_AT_FOR_ONE;
        let mut way = 0.5 * lacks / f64::from(steepest);
        let mut settled = self.settled;
        let end = if self.wanted.stop {
            self.in_force()
        } else {
            self.last - 1
        };
        while way > 0.0 && settled < end && nodes.at(settled).limit > 0.0 {
            self.open(nodes, settled, bounds);
            way -= nodes.at(settled).delta;
            settled += 1;
        }
        if settled == self.settled {
            self.give_up();
        } else {
            self.settle(nodes, settled);
        }
    }

    /// One step of it.
    fn let_go<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let speed = libm::sqrt(next.brake);
        let length = 2.0 * node.delta;
        let first = i == self.commit;
        let most_x = if first { 1.5 * node.x } else { node.x };
        let (mut x, iterations) = reach(node, next.brake, most_x, node.floor);
        self.work += LET_GO + REACH + iterations * ITERATION;
        let lasts = length / (speed + libm::sqrt(x));
        let from = libm::fmax(next.time - lasts + bounds.filter, next.time);
        let to = next.time + bounds.filter;
        while self.away > i + 1 && nodes.at(self.away).time > from {
            self.away -= 1;
        }
        let will = self.along_path(nodes, [self.away, self.settled], [from, to], bounds);
        let floor = most(node.floor, least(demanded(node, &will, bounds), 0.0));
        if ((next.brake - x) / length) < f64::from(floor) {
            let iterations;
            (x, iterations) = reach(node, next.brake, most_x, floor);
            self.work += REACH + iterations * ITERATION;
        }
        if i + 1 == self.settled {
            x -= self.trim.unwrap_or(0.0);
        }
        let time = next.time - length / (speed + libm::sqrt(x));
        let a = ((next.brake - x) / length) as f32;
        let node = nodes.at_mut(i);
        node.brake = x;
        if !first {
            // Else it is that of the past.
            node.time = time;
        }
        for side in &mut node.sides {
            side.allowed = side.accelerations(a, x as f32);
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
        let (mut low, mut high) = ([f32::INFINITY; ROWS], [f32::NEG_INFINITY; ROWS]);
        let mut include = |alpha: &Lanes, a: f32| {
            for row in 0..ROWS {
                low[row] = least(alpha[row] * a, low[row]);
                high[row] = most(alpha[row] * a, high[row]);
            }
        };
        if nodes.at(first).time > from || nodes.at(beyond).time < to {
            include(&[1.0; ROWS], 0.0);
        }
        let mut i = first;
        while i < beyond && nodes.at(i).time <= to {
            self.work += LOOK;
            for side in &nodes.at(i).sides {
                include(&side.alpha, side.allowed[PATH_ROW]);
            }
            i += 1;
            if pause(nodes.at(i), bounds) > 0.0 {
                include(&[1.0; ROWS], 0.0);
            }
        }
        [low, high]
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
