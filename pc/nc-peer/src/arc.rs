//! Length of an arc or helix, and its point halfway.

use shared::geometry::Turn;
use std::f64::consts::TAU;

/// Ends nearer than this are one place \[mm\].
const SAME: f64 = 1e-6;

/// An arc about an axis of the coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    /// 0, 1, 2: it goes about X, Y, Z.
    pub axis: usize,
    /// Of the centre, the coordinate along the axis does not matter.
    pub centre: [f64; 3],
    /// Seen from the positive end of the axis.
    pub turn: Turn,
    pub more_turns: u32,
}

impl Arc {
    /// Its length and the point halfway, from one place to another.
    pub fn measure(&self, from: [f64; 3], to: [f64; 3]) -> (f64, [f64; 3]) {
        let (length, middle, _) = self.with_first_radius(from, to);
        (length, middle)
    }

    /// Its length if the radius stayed that of its start.
    pub fn length_by_first_radius(&self, from: [f64; 3], to: [f64; 3]) -> f64 {
        self.with_first_radius(from, to).2
    }

    fn with_first_radius(&self, from: [f64; 3], to: [f64; 3]) -> (f64, [f64; 3], f64) {
        let (u, v, w) = ((self.axis + 1) % 3, (self.axis + 2) % 3, self.axis);
        let about = |place: [f64; 3]| [place[u] - self.centre[u], place[v] - self.centre[v]];
        let ([a, b], [c, d]) = (about(from), about(to));
        let sense = match self.turn {
            Turn::CounterClockwise => 1.0,
            Turn::Clockwise => -1.0,
        };
        let (start, end) = (b.atan2(a), d.atan2(c));
        let mut angle = (sense * (end - start)).rem_euclid(TAU);
        if (c - a).hypot(d - b) < SAME {
            angle = TAU;
        }
        angle += TAU * f64::from(self.more_turns);
        let (first, last) = (a.hypot(b), c.hypot(d));
        let half = start + sense * angle / 2.0;
        let radius = (first + last) / 2.0;
        let mut middle = [0.0; 3];
        middle[u] = self.centre[u] + radius * half.cos();
        middle[v] = self.centre[v] + radius * half.sin();
        middle[w] = (from[w] + to[w]) / 2.0;
        let rise = to[w] - from[w];
        ((radius * angle).hypot(rise), middle, (first * angle).hypot(rise))
    }
}

/// Centre of an arc of `radius` between two places; of a negative one it is the longer arc.
pub fn centre(axis: usize, turn: Turn, radius: f64, from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (du, dv) = (to[u] - from[u], to[v] - from[v]);
    let chord = du.hypot(dv).max(f64::MIN_POSITIVE);
    let height = (radius * radius - chord * chord / 4.0).max(0.0).sqrt();
    // Of a short counterclockwise arc the centre is to the left of the chord.
    let left = (turn == Turn::CounterClockwise) == (radius > 0.0);
    let height = if left { height } else { -height };
    let mut centre = from;
    centre[u] = f64::midpoint(from[u], to[u]) - height * dv / chord;
    centre[v] = f64::midpoint(from[v], to[v]) + height * du / chord;
    centre
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn a_quarter_by_its_radius_has_its_centre_and_middle() {
        let (from, to) = ([1.0, 0.0, 0.0], [0.0, 1.0, 2.0]);
        let turn = Turn::CounterClockwise;
        let found = centre(2, turn, 1.0, from, to);
        assert!(near([found[0], found[1], 0.0], [0.0; 3]), "{found:?}");
        let arc = Arc {
            axis: 2,
            centre: found,
            turn,
            more_turns: 1,
        };
        let (length, middle) = arc.measure(from, to);
        assert!((length - (2.5 * PI).hypot(2.0)).abs() < 1e-12, "{length}");
        let diagonal = -0.5_f64.sqrt();
        assert!(near(middle, [diagonal, diagonal, 1.0]), "{middle:?}");
    }

    #[test]
    fn a_negative_radius_is_the_longer_arc_and_same_ends_are_a_circle() {
        let (from, to) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let turn = Turn::Clockwise;
        let centre = centre(0, turn, -1.0, from, to);
        let arc = Arc {
            axis: 0,
            centre,
            turn,
            more_turns: 0,
        };
        assert!((arc.measure(from, to).0 - 1.5 * PI).abs() < 1e-12);
        assert!((arc.measure(from, from).0 - TAU).abs() < 1e-12);
    }
}
