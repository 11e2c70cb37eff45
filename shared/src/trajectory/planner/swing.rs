//! Swings of the acceleration: how far a row may differ from itself one filter length away, and boxes made to fit.

use super::horizon::Horizon;
use super::limits::{Bounds, ROWS};
use super::node::{Lanes, Node, Nodes, least, most};
use super::scan::advance;
use crate::motion::PATH_PERIOD_S;

/// No acceleration.
pub(super) const REST: Lanes = [0.0; ROWS];
/// Work of a step of the pass forward, of a repair, and of each interval one filter length away that they look at.
const FORWARD: u32 = 5;
const REPAIR: u32 = 6;
const LOOK: u32 = 1;
/// ṡ² where there would be none by rounding, as a share of what is possible.
const CREEP: f64 = 1e-3;

impl Horizon {
    /// Speed, time and accelerations of the interval of node `i`, and what its past allows them to be.
    pub(super) fn forward<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        self.work += FORWARD;
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let x = if self.scaled {
            next.trial
        } else {
            // Rounding must not make a place at rest where there is none.
            let x = advance(node, node.trial, next.reach);
            if x > 0.0 { x } else { CREEP * next.reach }
        };
        let speed = libm::sqrt(x);
        let time = node.time + 2.0 * node.delta / (node.speed + speed);
        let leaves = time + pause(next, bounds);
        let a = ((x - node.trial) / (2.0 * node.delta)) as f32;
        let (from, to) = (
            node.time - bounds.filter,
            libm::fmin(time - bounds.filter, node.time),
        );
        while self.away < i && nodes.at(self.away + 1).time <= from {
            self.away += 1;
        }
        let was = self.range(nodes, [self.away, i], [from, to], bounds);
        let wanted = [0, 1].map(|side: usize| node.sides[side].accelerations(a, node.trial as f32));
        let after = nodes.at_mut(i + 1);
        if x != after.trial {
            self.moved = [self.moved[0].min(i + 1), i + 1];
        }
        self.shift = leaves - after.time;
        (after.trial, after.speed, after.time) = (x, speed, leaves);
        for (side, wanted) in nodes.at_mut(i).sides.iter_mut().zip(wanted) {
            side.allowed = self.clamp(&wanted, &was, bounds);
        }
    }

    /// What the future allows the accelerations of node `i` to be; changes its boxes by that and its past, and
    /// says whether it did.
    pub(super) fn repair<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) -> bool {
        self.work += REPAIR;
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let end = next.time - pause(next, bounds);
        let a = ((next.trial - node.trial) / (2.0 * node.delta)) as f32;
        let (from, to) = (libm::fmax(node.time + bounds.filter, end), end + bounds.filter);
        while self.away > i + 1 && nodes.at(self.away).time > from {
            self.away -= 1;
        }
        let will = self.range(nodes, [self.away, self.last], [from, to], bounds);
        let grow = self.round <= self.relaxed;
        let node = nodes.at_mut(i);
        let mut changed = false;
        for place in &mut node.sides {
            let is = place.accelerations(a, node.trial as f32);
            let by_future = self.clamp(&is, &will, bounds);
            let by_past = core::mem::replace(&mut place.allowed, by_future);
            if self.scaled {
                continue;
            }
            changed |= grow && place.boxed && place.grow(&is, &will, bounds);
            changed |= place.shrink(&is, &by_past, &by_future, bounds);
        }
        changed
    }

    /// `wanted`, at most one swing away from the range of `other`; notes by how much it was more.
    fn clamp(&mut self, wanted: &Lanes, other: &[Lanes; 2], bounds: &Bounds) -> Lanes {
        let mut allowed = *wanted;
        for row in 0..ROWS {
            let swing = bounds.swing[row];
            let (high, low) = (other[0][row] + swing, other[1][row] - swing);
            allowed[row] = most(least(wanted[row], high), low);
            let off = most(wanted[row] - allowed[row], allowed[row] - wanted[row]);
            self.excess[row] = most(self.excess[row], off * bounds.per_swing[row]);
        }
        allowed
    }

    /// Lowest and highest allowed accelerations between two times, the first of which is in the interval of the
    /// first of `from_to` or before all of them, and the second before the last of them; none at rest.
    fn range<const N: usize>(
        &mut self,
        nodes: &Nodes<N>,
        from_to: [u32; 2],
        times: [f64; 2],
        bounds: &Bounds,
    ) -> [Lanes; 2] {
        let ([mut i, beyond], [from, to]) = (from_to, times);
        let mut low = [f32::INFINITY; ROWS];
        let mut high = [f32::NEG_INFINITY; ROWS];
        let mut include = |lanes: &Lanes| {
            for row in 0..ROWS {
                low[row] = least(lanes[row], low[row]);
                high[row] = most(lanes[row], high[row]);
            }
        };
        if from < nodes.at(i).time {
            include(&REST);
        }
        while i < beyond {
            self.work += LOOK;
            let (node, next) = (nodes.at(i), nodes.at(i + 1));
            let end = next.time - pause(next, bounds);
            if node.time <= to && end >= from {
                let [start, stop] = &node.sides;
                let at = |time: f64| {
                    let part = ((time - node.time) / (end - node.time)) as f32;
                    core::array::from_fn(|row| {
                        start.allowed[row] + part * (stop.allowed[row] - start.allowed[row])
                    })
                };
                include(&if from > node.time { at(from) } else { start.allowed });
                include(&if to < end { at(to) } else { stop.allowed });
            }
            if end < next.time && next.time > from && end < to {
                include(&REST);
            }
            if next.time > to {
                return [low, high];
            }
            i += 1;
        }
        if beyond == self.last {
            include(&REST);
        }
        [low, high]
    }
}

/// Time that the machine stands at a node: until the output filter has come to rest \[s\].
pub(super) fn pause(node: &Node, bounds: &Bounds) -> f64 {
    if node.limit > 0.0 {
        0.0
    } else {
        bounds.filter + PATH_PERIOD_S
    }
}
