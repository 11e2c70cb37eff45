//! Knots of the smooth path, what it is between two of them, and how far that is off the lines.

use super::lines::{Run, RunLine, used};
use shared::trajectory::{CHANNELS, Cubic, SHAPED, Tolerance};

/// All channels.
pub(super) type Channels = [f64; CHANNELS];

/// A cubic over which the direction turns by less \[rad\] is as good as two parabolas. With half or double of it programs
/// take as long to 0.2 %; far larger, jerk limits are passed as with [`ALIKE`].
const LITTLE_TURN: f64 = 0.3;
/// So is one that bends alike at both ends: the product of both bends is at least this share of the larger one's square.
/// With 0, jerk limits are passed by a tenth on lines that scatter by more than their tolerance; with 0.9 there are some
/// more elements.
const ALIKE: f64 = 0.5;
/// Most times that a part is halved to find how far it is off: bounds of it are then 1000 times as close.
const HALVINGS: u32 = 5;

/// A place of the smooth path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knot {
    /// Path length from the start of the run \[mm\].
    pub s: f64,
    pub value: Channels,
    pub slope: Channels,
    /// The lines are averaged over this to both sides \[mm\].
    pub half: f64,
}

/// A part of the smooth path: cubics from a place to another \[mm\].
pub(super) struct Piece {
    pub from: f64,
    pub to: f64,
    pub cubics: [Cubic; CHANNELS],
}

/// The path from a knot to the next: a cubic, or two parabolas where the bend of that would change much. Where the speed
/// changes too, planners see best what bends evenly; and two parabolas bend less than one cubic.
pub(super) fn pieces(from: &Knot, to: &Knot) -> (Piece, Option<Piece>) {
    let length = to.s - from.s;
    let cubic = |i: usize| Cubic::hermite([from.value[i], from.slope[i]], [to.value[i], to.slope[i]], length);
    let whole = Piece {
        from: from.s,
        to: to.s,
        cubics: std::array::from_fn(cubic),
    };
    let [a, b] = [from.s, to.s].map(|s| whole.bend(s));
    let product = |a: &[f64; SHAPED], b: &[f64; SHAPED]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let square = product(&a, &a).max(product(&b, &b));
    if libm::sqrt(square) * length < LITTLE_TURN || product(&a, &b) > ALIKE * square {
        return (whole, None);
    }
    let half = 0.5 * length;
    let mut parts = [[Cubic::default(); CHANNELS]; 2];
    for i in 0..CHANNELS {
        let [begin, end] = [from.slope[i], to.slope[i]];
        let middle = 2.0 * (to.value[i] - from.value[i]) / length - 0.5 * (begin + end);
        parts[0][i] = Cubic([from.value[i], begin, 0.5 * (middle - begin) / half, 0.0]);
        let [value, ..] = parts[0][i].at(half);
        parts[1][i] = Cubic([value, middle, 0.5 * (end - middle) / half, 0.0]);
    }
    let piece = |i: usize, from: f64, to: f64| Piece {
        from,
        to,
        cubics: parts[i],
    };
    let s = from.s + half;
    (piece(0, from.s, s), Some(piece(1, s, to.s)))
}

/// Whether the path from a knot to the next is nowhere off the lines by more than `allowed` at the same path length.
pub(super) fn follows(run: &Run, from: &Knot, to: &Knot, allowed: &Tolerance) -> bool {
    let (first, second) = pieces(from, to);
    let inside = |piece: &Piece| {
        let mut lines = run.between(piece.from, piece.to);
        lines.all(|line| piece.is_inside(line, allowed))
    };
    inside(&first) && second.is_none_or(|second| inside(&second))
}

impl Piece {
    /// Second derivatives of the position at `s` \[mm\].
    fn bend(&self, s: f64) -> [f64; SHAPED] {
        std::array::from_fn(|i| self.cubics[i].at(s - self.from)[2])
    }

    /// The tip goes at most so many mm for each of path length.
    pub fn quickest(&self) -> f64 {
        let length = self.to - self.from;
        let norm = |slope: &dyn Fn(&Cubic) -> f64| {
            let squares = self.cubics[..SHAPED]
                .iter()
                .map(|cubic| slope(cubic) * slope(cubic));
            libm::sqrt(squares.sum())
        };
        // The slope is a parabola, which lies between its ends and where its tangents meet.
        let begin = norm(&|cubic| cubic.0[1]);
        let meet = norm(&|cubic| cubic.0[1] + cubic.0[2] * length);
        let end = norm(&|cubic| cubic.at(length)[1]);
        begin.max(meet).max(end)
    }

    /// Whether the part of it along `line` is off that by no more than `allowed`.
    fn is_inside(&self, line: &RunLine, allowed: &Tolerance) -> bool {
        let (from, to) = (line.start.max(self.from), line.end().min(self.to));
        if to <= from {
            return true;
        }
        let third = (to - from) / 3.0;
        let ends = [from, to].map(|s| (s - self.from, line.at(s)));
        let mut points = [[0.0; CHANNELS]; 4];
        for (i, cubic) in self.cubics.iter().enumerate() {
            let [begin, end] = ends.each_ref().map(|(s, on)| {
                let [value, slope, _] = cubic.at(*s);
                (value - on[i], third * (slope - line.slope[i]))
            });
            let values = [begin.0, begin.0 + begin.1, end.0 - end.1, end.0];
            for (point, value) in points.iter_mut().zip(values) {
                point[i] = value;
            }
        }
        is_inside(&points, allowed, HALVINGS)
    }
}

/// Whether a Bézier curve, which lies between its control points, has no larger values than `allowed`.
fn is_inside(points: &[Channels; 4], allowed: &Tolerance, halvings: u32) -> bool {
    let inside = |point: &Channels| used(point, allowed) <= 1.0;
    let [a, b, c, d] = points;
    if !(inside(a) && inside(d)) {
        return false;
    }
    if inside(b) && inside(c) {
        return true;
    }
    if halvings == 0 {
        return false;
    }
    let middle = |a: &Channels, b: &Channels| -> Channels { std::array::from_fn(|i| 0.5 * (a[i] + b[i])) };
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(&ab, &bc), middle(&bc, &cd));
    let half = middle(&abc, &bcd);
    is_inside(&[*a, ab, abc, half], allowed, halvings - 1)
        && is_inside(&[half, bcd, cd, *d], allowed, halvings - 1)
}
