//! The limit of jerk: how far the acceleration of a row may differ from itself one filter length away, and boxes made to
//! fit.

use super::horizon::{Horizon, VISIT};
use super::limits::{Bounds, ROWS};
use super::node::{EMPTY, Lanes, Nodes, REST, include, least, most, pause};
use super::scan::advance;

/// Least ṡ² at the end of an interval, as a share of that at its start and of what is possible.
const CREEP: f64 = 1e-3;

impl Horizon {
    /// Speed, time and accelerations of the interval of node `i`, and what its past allows them to be.
    pub(super) fn forward<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) {
        self.work += VISIT;
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let x = if self.scaled {
            next.trial
        } else if self.braking && i < self.settled {
            next.brake
        } else {
            // Boxes may ask for all but a rest where there is none: it would not end.
            let x = advance(node, node.trial, next.reach);
            let from = if x > 0.0 { node.trial } else { f64::INFINITY };
            libm::fmax(x, CREEP * libm::fmin(from, next.reach))
        };
        let speed = libm::sqrt(x);
        let time = node.time + 2.0 * node.delta / (node.speed + speed);
        let leaves = time + pause(next, bounds);
        let a = ((x - node.trial) / (2.0 * node.delta)) as f32;
        let (from, to) = (
            node.time - bounds.filter,
            libm::fmin(time - bounds.filter, node.time),
        );
        self.away = nodes.passed(self.away, [self.history, i], from);
        let was = self.room(nodes, [self.away, i], [from, to], bounds);
        let wanted = [0, 1].map(|side: usize| node.sides[side].accelerations(a, node.trial as f32));
        let length = time - node.time;
        let alone = (length > bounds.filter).then(|| alone([node.speed, speed], length, &wanted, bounds));
        let after = nodes.at_mut(i + 1);
        if x != after.trial {
            self.moved = [self.moved[0].min(i + 1), i + 1];
        }
        self.shift = leaves - after.time;
        (after.trial, after.speed, after.time) = (x, speed, leaves);
        let rests = i + 1 == self.last || leaves > time;
        for (side, wanted) in nodes.at_mut(i).sides.iter_mut().zip(wanted) {
            side.allowed = self.clamp(&wanted, &was, bounds);
            if let Some(alone) = &alone {
                side.allowed = self.clamp(&side.allowed, alone, bounds);
            }
        }
        if rests {
            let first = nodes.passed(self.away, [self.history, i], time - bounds.filter);
            let was = self.room(nodes, [first, i + 1], [time - bounds.filter, time], bounds);
            self.clamp(&REST, &was, bounds);
        }
    }

    /// What the future allows the accelerations of node `i` to be; changes its boxes by that and its past, and
    /// says whether it did.
    pub(super) fn repair<const N: usize>(&mut self, nodes: &mut Nodes<N>, i: u32, bounds: &Bounds) -> bool {
        self.work += VISIT;
        let (node, next) = (nodes.at(i), nodes.at(i + 1));
        let end = next.time - pause(next, bounds);
        let a = ((next.trial - node.trial) / (2.0 * node.delta)) as f32;
        let (from, to) = (libm::fmax(node.time + bounds.filter, end), end + bounds.filter);
        self.away = nodes.passed(self.away, [i + 1, self.away], from);
        let will = self.room(nodes, [self.away, self.last], [from, to], bounds);
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
            for resized in [
                grow && place.grow(&is, &will, bounds),
                place.shrink(&is, &by_past, &by_future, bounds),
            ] {
                changed |= resized;
            }
        }
        changed
    }

    /// `wanted`, no higher and no lower than there is `room`; notes by how much it was off.
    fn clamp(&mut self, wanted: &Lanes, room: &[Lanes; 2], bounds: &Bounds) -> Lanes {
        let mut allowed = *wanted;
        for row in 0..ROWS {
            allowed[row] = most(least(wanted[row], room[0][row]), room[1][row]);
            let off = most(wanted[row] - allowed[row], allowed[row] - wanted[row]);
            self.excess[row] = most(self.excess[row], off * bounds.per_acceleration_change[row]);
        }
        allowed
    }

    /// Highest and lowest accelerations that the limit of jerk allows beside all between two times, as in `range`.
    fn room<const N: usize>(
        &mut self,
        nodes: &Nodes<N>,
        from_to: [u32; 2],
        times: [f64; 2],
        bounds: &Bounds,
    ) -> [Lanes; 2] {
        let [mut highest, mut lowest] = self.range(nodes, from_to, times, bounds);
        for row in 0..ROWS {
            let (top, bottom) = (
                highest[row] + bounds.acceleration_change[row],
                lowest[row] - bounds.acceleration_change[row],
            );
            // Where those are too far apart for it, the middle is off by the least.
            let middle = 0.5 * (top + bottom);
            highest[row] = most(middle, top);
            lowest[row] = least(middle, bottom);
            self.excess[row] = most(
                self.excess[row],
                0.5 * (bottom - top) * bounds.per_acceleration_change[row],
            );
        }
        [highest, lowest]
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
        let mut range = EMPTY;
        if from < nodes.at(i).time {
            include(&mut range, &REST);
        }
        while i < beyond {
            self.work += 1;
            let (node, next) = (nodes.at(i), nodes.at(i + 1));
            let end = next.time - pause(next, bounds);
            if node.time <= to && end >= from {
                let [start, stop] = &node.sides;
                let at = |time: f64| {
                    let part = way([node.speed, next.speed], (time - node.time) / (end - node.time)) as f32;
                    core::array::from_fn(|row| {
                        start.allowed[row] + part * (stop.allowed[row] - start.allowed[row])
                    })
                };
                include(
                    &mut range,
                    &if from > node.time { at(from) } else { start.allowed },
                );
                include(&mut range, &if to < end { at(to) } else { stop.allowed });
            }
            if end < next.time && next.time > from && end < to {
                include(&mut range, &REST);
            }
            if next.time > to {
                return range;
            }
            i += 1;
        }
        if beyond == self.last {
            include(&mut range, &REST);
        }
        range
    }
}

/// Share of the way of an interval that is passed after a share of its time; `from` and `to` are the speeds at its
/// ends. Over the way, accelerations go evenly from one end to the other.
fn way([from, to]: [f64; 2], part: f64) -> f64 {
    part * (1.0 + (1.0 - part) * (from - to) / libm::fmax(from + to, f64::MIN_POSITIVE))
}

/// Highest and lowest accelerations in an interval by itself that is longer than the filter and lasts `length` \[s\]:
/// where it is fastest they change by no more than the limit of jerk allows in the filter's length, on the way from one
/// `wanted` to the other.
fn alone([from, to]: [f64; 2], length: f64, wanted: &[Lanes; 2], bounds: &Bounds) -> [Lanes; 2] {
    let part = way(
        [libm::fmax(from, to), libm::fmin(from, to)],
        bounds.filter / length,
    );
    let changes = 0.5 / part as f32;
    let middle = |row: usize| 0.5 * (wanted[0][row] + wanted[1][row]);
    [1.0, -1.0].map(|sign| {
        core::array::from_fn(|row| middle(row) + sign * changes * bounds.acceleration_change[row])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::planner::node::{Node, Side};
    use proptest::prelude::*;

    /// Boxes that the machine keeps only by coming to all but a rest, in an interval behind which it could
    /// continue.
    #[test]
    fn boxes_do_not_bring_it_to_rest() {
        let side = Side {
            slope: [2.0; ROWS],
            high: [1.500_000_1; ROWS],
            low: [-1e9; ROWS],
            ..Side::ZERO
        };
        let mut nodes = Nodes::<4>::new();
        nodes.clear();
        let first = nodes.first;
        nodes.push(Node {
            delta: 1.0,
            trial: 1.0,
            speed: 1.0,
            sides: [side; 2],
            ..Node::ZERO
        });
        nodes.push(Node {
            reach: 0.5,
            limit: 1.0,
            ..Node::ZERO
        });
        let mut horizon = Horizon::at(first);
        (horizon.history, horizon.away) = (first, first);
        horizon.forward(&mut nodes, first, &Bounds::NONE);
        assert!(nodes.at(first + 1).trial >= CREEP * 0.5);
        assert!(nodes.at(first + 1).time < 3.0);
    }

    /// A row that has to be near two others, which are too far apart for that.
    #[test]
    fn a_past_that_asks_for_two_things_is_noticed() {
        let bounds = Bounds::NONE;
        let mut nodes = Nodes::<4>::new();
        nodes.clear();
        let first = nodes.first;
        for (k, high) in [3.0, -1.0].into_iter().enumerate() {
            let side = Side {
                allowed: [high; ROWS],
                ..Side::ZERO
            };
            nodes.push(Node {
                time: k as f64,
                delta: 1.0,
                speed: 1.0,
                limit: 1.0,
                sides: [side; 2],
                ..Node::ZERO
            });
        }
        nodes.push(Node {
            time: 2.0,
            speed: 1.0,
            limit: 1.0,
            ..Node::ZERO
        });
        let mut horizon = Horizon::at(first);
        horizon.last = first + 3;
        let [highest, lowest] = horizon.room(&nodes, [first, first + 2], [0.5, 1.5], &bounds);
        assert_eq!([highest[0], lowest[0]], [1.0, 1.0]);
        assert_eq!(horizon.excess[0], 1.0);
    }

    proptest! {
        /// By steps of time, and in an interval by itself the filter's length of it keeps the limit of jerk.
        #[test]
        fn accelerations_go_over_the_way(from in 0.0..2.0f64, to in 0.01..2.0f64, part in 0.0..1.0f64) {
            let speed = |time: f64| from + time * (to - from);
            let steps = 1000;
            let gone = |part: f64| {
                let mean = |k: i32| speed(part * (f64::from(k) + 0.5) / f64::from(steps));
                (0..steps).map(mean).sum::<f64>() * part / f64::from(steps)
            };
            prop_assert!((way([from, to], part) - gone(part) / gone(1.0)).abs() < 1e-9);
            let bounds = Bounds::NONE;
            let length = 1.5 * bounds.filter;
            let [highest, lowest] = alone([from, to], length, &[[4.0; ROWS], [-4.0; ROWS]], &bounds);
            let fastest = libm::fmax(way([from, to], 2.0 / 3.0), 1.0 - way([from, to], 1.0 / 3.0));
            prop_assert!(((highest[0] - lowest[0]) * fastest as f32 - bounds.acceleration_change[0]).abs() < 1e-4);
        }
    }
}
