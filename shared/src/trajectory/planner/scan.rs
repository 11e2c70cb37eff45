//! The fastest speed inside the limits of one interval (Pham & Pham, IEEE T-RO 34(3), 2018): in x = ṡ² and
//! a = s̈ every limit is a straight line.

use super::limits::ROWS;
use super::node::{Lanes, Node, Side, least, most};

/// Iterations of Newton's method; each changes at least one of the two limits that meet.
const ITERATIONS: u32 = 12;

/// The limits of a at one x are lines: a ≤ high − slope·x and a ≥ low − slope·x for every row of both ends, and by the
/// speed at the end of the interval a ≤ (next − x)/2Δ and a ≥ −x/2Δ.
struct Lines<'a> {
    sides: &'a [Side; 2],
    next: f32,
    per_length: f32,
}

impl<'a> Lines<'a> {
    fn new(node: &'a Node, next: f64) -> Self {
        Self {
            sides: &node.sides,
            next: next as f32,
            per_length: (0.5 / node.delta) as f32,
        }
    }

    /// Highest a at `x`.
    fn highest(&self, x: f32) -> f32 {
        let most = (self.next - x) * self.per_length;
        self.rows(|side| &side.high, least, x, most)
    }

    /// Lowest a at `x`.
    fn lowest(&self, x: f32) -> f32 {
        most(self.lowest_of_rows(x), -x * self.per_length)
    }

    /// The same, though it would lead to rest inside the interval.
    fn lowest_of_rows(&self, x: f32) -> f32 {
        self.rows(|side| &side.low, most, x, f32::NEG_INFINITY)
    }

    /// The `nearer` one of `bound` and of the lines of all rows at `x`.
    fn rows(&self, of: fn(&Side) -> &Lanes, nearer: impl Fn(f32, f32) -> f32, x: f32, bound: f32) -> f32 {
        let [start, end] = self.sides;
        let [first, last] = [of(start), of(end)];
        let lanes: Lanes = core::array::from_fn(|row| {
            nearer(first[row] - start.slope[row] * x, last[row] - end.slope[row] * x)
        });
        lanes.into_iter().fold(bound, nearer)
    }

    /// The line of the highest a that is `a` at `x`, as (value at 0, slope): that of a row, or else of the next speed.
    fn upper(&self, x: f32, a: f32) -> (f32, f32) {
        self.through(|side| &side.high, x, a)
            .unwrap_or((self.next * self.per_length, self.per_length))
    }

    /// The same of the lowest a: that of a row, or else of rest.
    fn lower(&self, x: f32, a: f32) -> (f32, f32) {
        self.through(|side| &side.low, x, a)
            .unwrap_or((0.0, self.per_length))
    }

    fn through(&self, of: fn(&Side) -> &Lanes, x: f32, a: f32) -> Option<(f32, f32)> {
        for side in self.sides {
            let lines = of(side);
            for row in 0..ROWS {
                if lines[row] - side.slope[row] * x == a {
                    return Some((lines[row], side.slope[row]));
                }
            }
        }
        None
    }
}

/// The highest x at the start of the interval of `node` from which some a keeps every limit and arrives at no more
/// than `next`, with x at most `cap`; and how many iterations that took.
pub(super) fn reach(node: &Node, next: f64, cap: f64) -> (f64, u32) {
    let lines = Lines::new(node, next);
    let mut x = cap as f32;
    if x > lines.next {
        // Mostly the limit of braking at `next` is that at the reach too, and this crossing is what is searched.
        let (lower, rises) = lines.lower(lines.next, lines.lowest(lines.next));
        let crossing = (lines.next * lines.per_length - lower) / (lines.per_length - rises);
        if crossing > lines.next {
            x = least(x, crossing);
        }
    }
    // The room between the limits is concave in x, and there is some at 0: from above, the crossings of the
    // limits in force come down to where there is none.
    for iteration in 0..ITERATIONS {
        let (high, low) = (lines.highest(x), lines.lowest(x));
        if high >= low {
            return (f64::from(x), iteration);
        }
        let (upper, falls) = lines.upper(x, high);
        let (lower, rises) = lines.lower(x, low);
        // Where the two lines meet; x itself may be larger by many orders.
        let crossing = (upper - lower) / (falls - rises);
        if !(crossing > 0.0 && crossing < x) {
            // Rounding: there is nothing between this x and the last one.
            return (if crossing > 0.0 { f64::from(x) } else { 0.0 }, iteration);
        }
        x = crossing;
    }
    (f64::from(x), ITERATIONS)
}

/// x at the end of the interval of `node` if it begins at `x` and ends no faster than `next`, as fast as the
/// limits allow.
pub(super) fn advance(node: &Node, x: f64, next: f64) -> f64 {
    let a = Lines::new(node, next).highest(x as f32);
    let end = x + 2.0 * node.delta * f64::from(a);
    libm::fmax(libm::fmin(end, next), 0.0)
}

/// The lowest a at the start of the interval of `node` that its boxes allow at `x`, though it would lead to rest inside
/// the interval.
pub(super) fn lowest(node: &Node, x: f64) -> f32 {
    Lines::new(node, f64::INFINITY).lowest_of_rows(x as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An interval of length 1 with two rows, whose first derivatives and second derivatives are given at both ends.
    fn node(rows: [[f32; 4]; 2], cap: f64) -> Node {
        let mut node = Node {
            delta: 1.0,
            feed: cap,
            limit: f64::INFINITY,
            ..Node::ZERO
        };
        for (end, side) in node.sides.iter_mut().enumerate() {
            *side = Side {
                high: [1e9; ROWS],
                low: [-1e9; ROWS],
                ..Side::ZERO
            };
            for (row, q) in rows.iter().enumerate() {
                let (first, second) = (q[2 * end], q[2 * end + 1]);
                let alpha = first + if end == 1 { 2.0 * second } else { 0.0 };
                side.alpha[row] = if alpha.abs() < 1e-3 { 1e-3 } else { alpha };
                side.slope[row] = second / side.alpha[row];
                side.high[row] = 1.0 / side.alpha[row].abs();
                side.low[row] = -side.high[row];
            }
        }
        node
    }

    /// Whether some a keeps all limits at `x` and ends between 0 and `next`, by looking at many.
    fn possible(node: &Node, x: f64, next: f64, margin: f64) -> bool {
        (0..=4000).any(|k| {
            let end = next * f64::from(k) / 4000.0;
            let a = (end - x) / 2.0;
            let inside = |side: &Side| {
                let rows = side.accelerations(a as f32, x as f32);
                rows[..2].iter().all(|row| f64::from(row.abs()) <= 1.0 + margin)
            };
            node.sides.iter().all(inside)
        })
    }

    proptest! {
        #[test]
        fn the_reach_is_possible_and_more_is_not(
            rows in prop::array::uniform2(prop::array::uniform4(-2.0..2.0f32)),
            cap in 0.1..10.0f64, next in 0.0..5.0f64,
        ) {
            let node = node(rows, cap);
            let (x, _) = reach(&node, next, cap);
            prop_assert!((0.0..=cap * (1.0 + 1e-6)).contains(&x));
            prop_assert!(possible(&node, x * 0.999, next, 0.02), "{x} is not possible");
            if x < cap * 0.99 {
                prop_assert!(!possible(&node, x * 1.02 + 0.01, next, -0.001), "more than {x} is possible");
            }
            // From there the fastest end is inside all limits, and the slowest is slower.
            let end = advance(&node, x, next);
            prop_assert!((0.0..=next).contains(&end));
            prop_assert!(x + 2.0 * f64::from(lowest(&node, x)) <= end + 1e-3);
        }
    }
}
