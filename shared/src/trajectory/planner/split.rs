//! Nodes put inside an interval that lasts long, so that a hold or another override need not wait for its end.

use super::limits::{Bounds, ROWS};
use super::node::{Node, Nodes, Side, least, most};
use crate::ticks::PATH_PERIOD_S;

/// An interval is split if it would make a change of the plan later than this \[s\], and than twice the time that a plan
/// needs: more nodes are more work.
const LATE: f64 = 0.05;
/// Ticks after the time at which a plan has to be ready.
pub(super) const SPARE: f64 = 2.0;
/// Nodes for the way in which the machine can stop, and that way is this many times the shortest.
pub(super) const STEPS: usize = 12;
const LONGER: f64 = 1.3;
/// No part is shorter than this share of the interval.
pub(super) const SLIVER: f64 = 1e-3;

/// Where nodes were put in: the old serials of the nodes at the start of those intervals, and 0 for none.
pub(super) type PutIn = [u32; STEPS + 1];

/// The serial of a node after others were put in: all up to a new one move down, those beyond are as they were.
pub(super) fn moved(serial: u32, put_in: &PutIn) -> u32 {
    serial - put_in.iter().filter(|interval| **interval >= serial).count() as u32
}

/// Puts nodes into long intervals of the plan in force, which stays as it is: one where that is `lead` \[s\] from now, if
/// the next would be late; and where that node is needed, or the machine `slows` down, others on the way to a stop from there. The
/// player is on the way to node `player`, reached in `left` \[s\] from now; the plan ends at node `last`.
pub(super) fn split<const N: usize>(
    nodes: &mut Nodes<N>,
    [player, last]: [u32; 2],
    left: f64,
    lead: f64,
    slows: bool,
    bounds: &Bounds,
) -> PutIn {
    let (mut end, mut time) = (player, left);
    while end < last && time < lead {
        time += nodes.at(end).lasts;
        end += 1;
    }
    let late = end > nodes.first && time >= lead + libm::fmax(lead, LATE);
    if !late && (!slows || end >= last) {
        return PutIn::default();
    }
    let mut places = Places::default();
    let mut at = 0.0;
    let mut interval = if late { end - 1 } else { end };
    let (node, next) = (nodes.at(interval), nodes.at(interval + 1));
    let a = (next.x - node.x) / (2.0 * node.delta);
    if late {
        let after = lead + SPARE * PATH_PERIOD_S - (time - node.lasts);
        let way = after * (libm::sqrt(node.x) + 0.5 * a * after);
        at = libm::fmax(way, SLIVER * node.delta);
        if at > (1.0 - SLIVER) * node.delta {
            return PutIn::default();
        }
        places.push(interval, at);
    }
    let way = LONGER * stopping(node, libm::fmax(node.x + 2.0 * a * at, 0.0), a, bounds);
    let mut gone = 0.0;
    while interval < last && gone < way && !places.full() {
        let delta = nodes.at(interval).delta;
        let step = libm::fmax(way / STEPS as f64, SLIVER * delta);
        if delta - at > 1.5 * step {
            (at, gone) = (at + step, gone + step);
            places.push(interval, at);
        } else {
            gone += delta - at;
            (interval, at) = (interval + 1, 0.0);
        }
    }
    let oldest = nodes.before(player - 1, nodes.first, bounds.remembered);
    if nodes.room() < places.count {
        nodes.first = oldest;
    }
    let count = places.count.min(nodes.room()).min(nodes.first as usize);
    let mut put_in = PutIn::default();
    for (already, k) in (0..count).rev().enumerate() {
        put_in[k] = places.intervals[k];
        insert(nodes, put_in[k] - already as u32, places.ats[k], bounds);
    }
    put_in
}

/// Where nodes are to be put in.
#[derive(Default)]
struct Places {
    intervals: PutIn,
    /// Distances from the starts of the intervals \[mm\].
    ats: [f64; STEPS + 1],
    count: usize,
}

impl Places {
    fn full(&self) -> bool {
        self.count == self.ats.len()
    }

    fn push(&mut self, interval: u32, at: f64) {
        (self.intervals[self.count], self.ats[self.count]) = (interval, at);
        self.count += 1;
    }
}

/// The shortest way to rest from ṡ² = `x` and the acceleration `a` in the interval of `node`, about \[mm\].
fn stopping(node: &Node, x: f64, a: f64, bounds: &Bounds) -> f64 {
    // What the rows allow along the path, and how long it takes to get there.
    let (mut most_a, mut change) = (f32::INFINITY, f32::INFINITY);
    for side in &node.sides {
        for row in 0..ROWS {
            let per_alpha = 1.0 / side.alpha[row].abs();
            most_a = most_a.min(bounds.acceleration[row] * per_alpha);
            change = change.min(bounds.acceleration_change[row] * per_alpha);
        }
    }
    let (most_a, jerk, v) = (
        f64::from(most_a),
        f64::from(change) / bounds.filter,
        libm::sqrt(x),
    );
    // A slow machine is at rest before it slows down with all it has.
    let ramp = libm::fmax(bounds.filter, libm::fmin(most_a / jerk, libm::sqrt(v / jerk)));
    let v = v + 0.5 * libm::fmax(a, 0.0) * ramp;
    v * v / (2.0 * most_a) + v * ramp
}

/// Puts a node into an interval, `at` a distance from its start; the plan in force is as before.
fn insert<const N: usize>(nodes: &mut Nodes<N>, interval: u32, at: f64, bounds: &Bounds) {
    let (whole, end) = (*nodes.at(interval), *nodes.at(interval + 1));
    let before = part(&whole, &end, [0.0, at], bounds);
    let after = part(&whole, &end, [at, whole.delta], bounds);
    *nodes.at_mut(interval) = before;
    nodes.insert_after(
        interval,
        Node {
            lasts: whole.lasts - before.lasts,
            ..after
        },
    );
}

/// The part of the interval of node `whole`, which ends at node `end`, between two distances from its start; the plan in
/// force is as before.
pub(super) fn part(whole: &Node, end: &Node, [from, to]: [f64; 2], bounds: &Bounds) -> Node {
    let a = (end.x - whole.x) / (2.0 * whole.delta);
    let x = libm::fmax(whole.x + 2.0 * a * from, 0.0);
    let (v, v_to) = (
        libm::sqrt(x),
        libm::sqrt(libm::fmax(x + 2.0 * a * (to - from), 0.0)),
    );
    let part = Node {
        delta: to - from,
        lasts: 2.0 * (to - from) / (v + v_to),
        sides: [
            side(whole, from, 0.0, [a, x], bounds),
            side(whole, to, to - from, [a, x], bounds),
        ],
        ..*whole
    };
    if from <= 0.0 {
        return part;
    }
    Node {
        s: whole.s + whole.direction * from,
        // Both ends keep the limits of the interval too.
        feed: libm::fmax(whole.feed, end.feed),
        limit: libm::fmax(whole.limit, end.limit),
        factor: end.factor,
        x,
        ..part
    }
}

/// The limits `at` a distance from the start of an interval, for an end of a part of it that begins with `x` = ṡ²:
/// rates are straight lines between the ends. `delta` is 0 at the start of the part, its length at its end. The plan
/// in force, which has the acceleration `a`, is always inside them, whatever rounding does.
fn side(whole: &Node, at: f64, delta: f64, [a, x]: [f64; 2], bounds: &Bounds) -> Side {
    let [start, end] = &whole.sides;
    let (part, length) = ((at / whole.delta) as f32, whole.delta as f32);
    let mut side = Side::ZERO;
    for row in 0..ROWS {
        let second = [
            start.slope[row] * start.alpha[row],
            end.slope[row] * end.alpha[row],
        ];
        let first = [start.alpha[row], end.alpha[row] - 2.0 * length * second[1]];
        let second = second[0] + part * (second[1] - second[0]);
        let alpha = first[0] + part * (first[1] - first[0]) + 2.0 * delta as f32 * second;
        side.set_rates(row, alpha, second);
    }
    side.open(bounds);
    for row in 0..ROWS {
        let is = a as f32 + side.slope[row] * x as f32;
        side.high[row] = most(side.high[row], is);
        side.low[row] = least(side.low[row], is);
    }
    side
}

#[cfg(test)]
mod tests {
    use super::super::plan::{Knot, Place, Plan};
    use super::*;
    use proptest::prelude::*;

    /// Three intervals, of which the last is long; `x` is ṡ² at its ends.
    fn nodes(x: [f64; 2], rates: [[f32; 2]; 2]) -> Nodes<16> {
        let mut nodes = Nodes::new();
        nodes.clear();
        let side = |[first, second]: [f32; 2], delta: f32| {
            let mut side = Side::ZERO;
            side.alpha[0] = first + 2.0 * delta * second;
            side.slope[0] = second / side.alpha[0];
            side.open(&Bounds::NONE);
            side
        };
        let mut s = 0.0;
        for (delta, x, to) in [(0.01, 0.0, x[0]), (0.01, x[0], x[0]), (1.0, x[0], x[1])] {
            nodes.push(Node {
                s,
                delta,
                x,
                lasts: 2.0 * delta / (libm::sqrt(x) + libm::sqrt(to)),
                feed: 1.0,
                limit: 2.0,
                sides: [side(rates[0], 0.0), side(rates[1], delta as f32)],
                ..Node::ZERO
            });
            s += delta;
        }
        nodes.push(Node {
            s,
            x: x[1],
            feed: 0.5,
            limit: 0.0,
            ..Node::ZERO
        });
        nodes
    }

    /// The plan in force, from node `from` on.
    fn plan(nodes: &Nodes<16>, from: u32) -> Plan<16> {
        let mut plan = Plan::NONE;
        plan.last = nodes.end - 1;
        for serial in from..nodes.end {
            let node = nodes.at(serial);
            plan.set(serial, Knot::of(node, (node.x, node.lasts)));
        }
        plan
    }

    proptest! {
        /// The same places at the same times, and the plan in force is inside the limits of every part.
        #[test]
        fn the_plan_in_force_is_as_it_was(
            x in prop::array::uniform2(0.01..1.0f64), lead in 0.01..0.1f64,
            rates in prop::array::uniform2([0.5..2.0f32, -0.3..0.3f32]),
        ) {
            let mut after = nodes(x, rates);
            let mut player = Place::at(after.first + 2);
            let before = after.clone();
            let mut was = player;
            let last = after.end - 1;
            let left = after.at(player.node).lasts;
            let put_in = split(&mut after, [last, last], left, lead, true, &Bounds::NONE);
            prop_assert_eq!(put_in[0], player.node);
            player.node = moved(player.node, &put_in);
            prop_assert!(player.node < was.node);
            prop_assert_eq!(after.end, before.end);
            let mut time = 0.0;
            for serial in player.node..last {
                let (node, next) = (after.at(serial), after.at(serial + 1));
                time += node.lasts;
                prop_assert!(node.delta > 0.0 && node.lasts > 0.0 && node.cap() >= node.x * (1.0 - 1e-12));
                prop_assert!((node.s + node.delta - next.s).abs() < 1e-12);
                let a = ((next.x - node.x) / (2.0 * node.delta)) as f32;
                let second = &node.sides[0];
                let is = a + second.slope[0] * node.x as f32;
                prop_assert!(is <= second.high[0] + 1e-5 && is >= second.low[0] - 1e-5);
            }
            prop_assert!((time - left).abs() < 1e-12);
            prop_assert!(after.at(player.node).lasts >= lead);
            let [before, after] = [plan(&before, was.node), plan(&after, player.node)];
            for _ in 0..(1000.0 * left) as u32 {
                was.step(&before, 0);
                player.step(&after, 0);
                let (old, new) = (was.state(&before), player.state(&after));
                prop_assert!((old.s - new.s).abs() < 1e-12 && (old.v - new.v).abs() < 1e-12, "{old:?} {new:?}");
                prop_assert!((old.a - new.a).abs() < 1e-9);
            }
        }

        /// The rates at a new node are those of a straight line between the ends.
        #[test]
        fn the_rates_go_on_over_a_split(rates in prop::array::uniform2([0.5..2.0f32, -0.3..0.3f32])) {
            let mut after = nodes([0.04, 0.04], rates);
            let interval = after.end - 2;
            insert(&mut after, interval, 0.25, &Bounds::NONE);
            let node = after.at(interval);
            let at = |k: usize| rates[0][k] + 0.25 * (rates[1][k] - rates[0][k]);
            prop_assert!((node.sides[0].alpha[0] - at(0)).abs() < 1e-5);
            prop_assert!((node.sides[0].slope[0] * node.sides[0].alpha[0] - at(1)).abs() < 1e-5);
            let end = &after.at(interval - 1).sides[1];
            prop_assert!((end.alpha[0] - at(0) - 0.5 * at(1)).abs() < 1e-5);
        }
    }
}
