//! The fastest speed inside the limits of one interval (Pham & Pham, IEEE T-RO 34(3), 2018): in x = ṡ² and
//! a = s̈ every limit is a straight line.

use super::limits::ROWS;
use super::node::{Lanes, Node, Side};

/// Iterations of Newton's method; each changes at least one of the two limits that meet.
const ITERATIONS: u32 = 12;

/// Limits of a at one x: a ≤ upper − slope·x and a ≥ lower − slope·x.
struct Lines {
    upper: [Lanes; 2],
    lower: [Lanes; 2],
    slope: [Lanes; 2],
    /// Of the speed at the end of the interval: a ≤ (next − x)/2Δ, a ≥ −x/2Δ.
    next: f32,
    per_length: f32,
}

impl Lines {
    fn new(node: &Node, next: f64) -> Self {
        let mut lines = Self {
            upper: [[0.0; ROWS]; 2],
            lower: [[0.0; ROWS]; 2],
            slope: [node.sides[0].slope, node.sides[1].slope],
            next: next as f32,
            per_length: (0.5 / node.delta) as f32,
        };
        for (side, Side { alpha, high, low, .. }) in node.sides.iter().enumerate() {
            for row in 0..ROWS {
                let (one, other) = (high[row] / alpha[row], low[row] / alpha[row]);
                lines.upper[side][row] = if one > other { one } else { other };
                lines.lower[side][row] = if one > other { other } else { one };
            }
        }
        lines
    }

    /// Highest a at `x`, and its line (value at x = 0, slope).
    fn highest(&self, x: f32) -> (f32, f32, f32) {
        let mut line = (self.next * self.per_length, self.per_length);
        let mut a = line.0 - line.1 * x;
        for side in 0..2 {
            for row in 0..ROWS {
                let limit = self.upper[side][row] - self.slope[side][row] * x;
                if limit < a {
                    a = limit;
                    line = (self.upper[side][row], self.slope[side][row]);
                }
            }
        }
        (a, line.0, line.1)
    }

    /// Lowest a at `x`, and its line.
    fn lowest(&self, x: f32) -> (f32, f32, f32) {
        let mut line = (0.0, self.per_length);
        let mut a = -line.1 * x;
        for side in 0..2 {
            for row in 0..ROWS {
                let limit = self.lower[side][row] - self.slope[side][row] * x;
                if limit > a {
                    a = limit;
                    line = (self.lower[side][row], self.slope[side][row]);
                }
            }
        }
        (a, line.0, line.1)
    }
}

/// The highest x at the start of the interval of `node` from which some a keeps every limit and arrives at no more
/// than `next`.
pub(super) fn reach(node: &Node, next: f64) -> f64 {
    let lines = Lines::new(node, next);
    let mut x = node.cap as f32;
    // The room between the limits is concave in x, and there is some at 0: from above, the crossings of the
    // limits in force come down to where there is none.
    for _ in 0..ITERATIONS {
        let (high, upper, upper_slope) = lines.highest(x);
        let (low, lower, lower_slope) = lines.lowest(x);
        if high >= low {
            return f64::from(x);
        }
        let crossing = (upper - lower) / (upper_slope - lower_slope);
        if !(crossing > 0.0 && crossing < x) {
            // Rounding: there is nothing between this x and the last one.
            return if crossing > 0.0 { f64::from(x) } else { 0.0 };
        }
        x = crossing;
    }
    f64::from(x)
}

/// x at the end of the interval of `node` if it begins at `x` and ends no faster than `next`, as fast as the
/// limits allow.
pub(super) fn advance(node: &Node, x: f64, next: f64) -> f64 {
    let (a, ..) = Lines::new(node, next).highest(x as f32);
    let end = x + 2.0 * node.delta * f64::from(a);
    libm::fmax(libm::fmin(end, next), 0.0)
}
