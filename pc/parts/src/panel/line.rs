//! The smooth line through taught points: where the focus goes, and along which normal.

use super::PanelError;
use cam::curve::Curve;
use nalgebra::Vector3;
use teach::TaughtPoint;

/// Points put before the first and after the last taught one, so that the ends of the spline lie outside the cut:
/// of what a natural spline gets wrong at its end, less than a tenth is left two points further.
const MARGIN: usize = 2;
/// Least points of an open and of a closed line.
const LEAST: usize = 3;

/// Position and normal over the length; the cut begins at 0.
#[derive(Debug)]
pub struct Line {
    curve: Curve<6>,
    start: f64,
    end: f64,
}

/// A place on the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Length from where the cut begins \[mm\].
    pub s: f64,
    /// The focus \[mm\].
    pub position: Vector3<f64>,
    /// Unit normal of the surface.
    pub normal: Vector3<f64>,
}

impl Line {
    /// The line through `points`. Where it is open it continues curved as at its ends; a closed one goes
    /// round.
    pub fn through(points: &[TaughtPoint], closed: bool) -> Result<Self, PanelError> {
        let least = if closed { LEAST + 1 } else { LEAST };
        if points.len() < least {
            let found = points.len();
            return Err(PanelError::TooFew { found, least });
        }
        let channels: Vec<[f64; 6]> = points.iter().map(channels).collect();
        let (before, after) = if closed {
            let n = channels.len();
            let round = |i: usize| channels[i % n];
            let before = (0..MARGIN).map(|i| round(n - MARGIN + i)).collect::<Vec<_>>();
            // The first point once more, and those after it.
            let after = (0..=MARGIN).map(round).collect::<Vec<_>>();
            (before, after)
        } else {
            let n = channels.len();
            let first = [0, 1, 2].map(|i| channels[i]);
            let last = [n - 1, n - 2, n - 3].map(|i| channels[i]);
            let mut before: Vec<_> = (1..=MARGIN).map(|i| beyond(&first, i)).collect();
            before.reverse();
            let after = (1..=MARGIN).map(|i| beyond(&last, i)).collect();
            (before, after)
        };
        let all = [before.as_slice(), &channels, &after].concat();
        let curve = Curve::by_length(&all).map_err(PanelError::Curve)?;
        let at = curve.parameters();
        let (start, end) = (at[MARGIN], at[at.len() - 1 - MARGIN]);
        Ok(Self { curve, start, end })
    }

    /// Length of the cut \[mm\].
    pub fn length(&self) -> f64 {
        self.end - self.start
    }

    /// The place at `s`, before 0 and beyond the end too.
    pub fn at(&self, s: f64) -> Station {
        let [value, ..] = self.curve.at(self.start + s);
        Station {
            s,
            position: Vector3::new(value[0], value[1], value[2]),
            normal: Vector3::new(value[3], value[4], value[5]).normalize(),
        }
    }

    /// Number of the taught point that is nearest to `s`, from 1; `count` there are.
    pub fn point_near(&self, s: f64, count: usize) -> usize {
        let at = &self.curve.parameters()[MARGIN..MARGIN + count];
        let distance = |i: &usize| (at[*i] - self.start - s).abs();
        let nearest = (0..count).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map_or(0, |i| i + 1)
    }
}

fn channels(point: &TaughtPoint) -> [f64; 6] {
    let (p, n) = (&point.position, &point.normal);
    [p.x, p.y, p.z, n.x, n.y, n.z]
}

/// The `steps`-th point before the first of three, on the parabola through them over their chords, steps as long as
/// the first chord.
fn beyond(three: &[[f64; 6]; 3], steps: usize) -> [f64; 6] {
    let chord = |i: usize| cam::curve::distance(&three[i], &three[i + 1]);
    let (x1, x2) = (chord(0), chord(0) + chord(1));
    let x = -(steps as f64) * x1;
    let weights = [
        (x - x1) * (x - x2) / (x1 * x2),
        x * (x - x2) / (x1 * (x1 - x2)),
        x * (x - x1) / (x2 * (x2 - x1)),
    ];
    std::array::from_fn(|c| (0..3).map(|i| weights[i] * three[i][c]).sum())
}
