//! NURBS of a program over their length.

use super::{PathError, Tip};
use curves::nurbs::{Curve, Nurbs, RationalBezier, length, parameter_at_length};
use curves::tabulate;
use nalgebra::Vector3;
use nc::{NurbsWay, SourcePosition};
use shared::geometry::{Moving, angle};
use shared::trajectory::ArcLengthCurve;

/// The first control point may be this far from where the tip is \[mm\]: the rounding of programs.
const START_TOLERANCE: f64 = 1e-3;
/// A turn between two spans that is gone over \[rad\]: as between blocks.
const MAX_TURN: f64 = crate::path::exact::MAX_TURN;
/// Shortest derivative over the parameter of a span, as a part of the control polygon, that has a direction.
const NO_SPEED: f64 = 1e-6;
/// Spans of cubics are not made shorter than this \[mm\].
const SHORTEST_SPAN: f64 = 1e-3;
/// A piece of a curve that has no even speed and is shorter than this \[mm\] turns on the spot.
const SHORTEST_PIECE: f64 = 1e-5;

/// A curve as its spans, one after the other.
pub(super) struct LongCurve {
    spans: Vec<Span>,
    length: f64,
}

struct Span {
    /// Length up to here \[mm\].
    start: f64,
    length: f64,
    curve: RationalBezier,
}

impl LongCurve {
    /// The curve of `way`, which begins at `from`; `place` is where it was opened.
    pub(super) fn build(way: &NurbsWay, from: &Tip, place: SourcePosition) -> Result<Self, PathError> {
        let invalid = |source| PathError::Nurbs { place, source };
        let points = control_points(way, from)?;
        let weights: Vec<f64> = way.points.iter().map(|point| point.weight).collect();
        let nurbs = Nurbs::new(way.order - 1, &points, &weights, &way.knots).map_err(invalid)?;
        let mut spans: Vec<Span> = Vec::new();
        let mut start = 0.0;
        for piece in nurbs.pieces() {
            let curve = piece.curve;
            let length = length(&curve);
            let span = Span { start, length, curve };
            let before = spans.last().map(|before| before.curve.at(1.0).first);
            span.check(before, place)?;
            spans.push(span);
            start += length;
        }
        Ok(Self { spans, length: start })
    }

    /// Length \[mm\].
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// Where spans begin and end \[mm\].
    pub(super) fn breaks(&self) -> impl Iterator<Item = f64> + '_ {
        self.spans.iter().map(|span| span.start).chain([self.length])
    }

    /// The curve from one length to another \[mm\] in pieces over their own length; or the length up to where it has no
    /// direction \[mm\].
    pub(super) fn pieces(&self, from: f64, to: f64) -> Result<Vec<ArcLengthCurve>, f64> {
        let mut pieces = Vec::new();
        for span in &self.spans {
            let Some(part) = span.part(from, to) else { continue };
            let mut waiting = vec![part];
            while let Some(piece) = waiting.pop() {
                match tabulate(&piece) {
                    Ok(curve) => pieces.push(curve),
                    Err(_) if length(&piece) < SHORTEST_PIECE => return Err(span.start),
                    Err(_) => {
                        let [first, second] = piece.split(0.5);
                        waiting.extend([second, first]);
                    }
                }
            }
        }
        Ok(pieces)
    }

    /// Point \[mm\], direction and curvature \[1/mm\] a length `s` \[mm\] after the start.
    pub(super) fn at(&self, s: f64) -> Moving {
        let index = self.spans.partition_point(|span| span.start <= s).max(1) - 1;
        let span = &self.spans[index];
        by_length(
            &span
                .curve
                .at(parameter_at_length(&span.curve, 0.0, s - span.start)),
        )
    }

    /// Places between which a cubic with the right ends is off by less than `tolerance` \[mm\], from `from` to `to`;
    /// without the first.
    pub(super) fn places(&self, from: f64, to: f64, tolerance: f64) -> Vec<f64> {
        let inside = self.breaks().filter(|s| *s > from && *s < to);
        let mut bounds: Vec<f64> = [from].into_iter().chain(inside).chain([to]).collect();
        bounds.dedup_by(|a, b| *a - *b < SHORTEST_SPAN);
        // Where the last break was too near to the end, the end stays.
        if let Some(last) = bounds.last_mut() {
            *last = to;
        }
        let mut places = Vec::new();
        for pair in bounds.windows(2) {
            let mut waiting = vec![[pair[0], pair[1]]];
            while let Some([a, b]) = waiting.pop() {
                let middle = (a + b) / 2.0;
                if b - a < 2.0 * SHORTEST_SPAN || self.off(a, b) <= tolerance {
                    places.push(b);
                } else {
                    waiting.extend([[middle, b], [a, middle]]);
                }
            }
        }
        places
    }

    /// How far the cubic between two places is off \[mm\].
    fn off(&self, a: f64, b: f64) -> f64 {
        let (from, to, h) = (self.at(a), self.at(b), b - a);
        let off = |t: f64| {
            let r = 1.0 - t;
            let cubic = from.value * (r * r * (1.0 + 2.0 * t))
                + to.value * (t * t * (1.0 + 2.0 * r))
                + (from.first * r - to.first * t) * (h * t * r);
            (cubic - self.at(a + h * t).value).norm()
        };
        [0.25, 0.5, 0.75].map(off).into_iter().fold(0.0, f64::max)
    }
}

impl Span {
    /// What of it lies between two lengths of the curve \[mm\], if that is not next to nothing.
    fn part(&self, from: f64, to: f64) -> Option<RationalBezier> {
        let (from, to) = (from - self.start, to - self.start);
        if to <= SHORTEST_PIECE || from >= self.length - SHORTEST_PIECE {
            return None;
        }
        let mut part = self.curve;
        let mut end = 1.0;
        if to < self.length - SHORTEST_PIECE {
            end = parameter_at_length(&self.curve, 0.0, to);
            [part, _] = part.split(end);
        }
        if from > SHORTEST_PIECE {
            let start = parameter_at_length(&self.curve, 0.0, from);
            [_, part] = part.split(start / end);
        }
        Some(part)
    }

    /// Whether it continues from where the last one went, `before`, and has a direction at both ends.
    fn check(&self, before: Option<Vector3<f64>>, place: SourcePosition) -> Result<(), PathError> {
        let polygon = self.curve.points().windows(2).map(|two| (two[1] - two[0]).norm());
        let least = NO_SPEED * polygon.sum::<f64>();
        for (t, s) in [(0.0, self.start), (1.0, self.start + self.length)] {
            if self.curve.at(t).first.norm() <= least {
                return Err(PathError::NurbsStands { place, s });
            }
        }
        let turn = before.map_or(0.0, |before| angle(&before, &self.curve.at(0.0).first));
        if turn > MAX_TURN {
            return Err(PathError::NurbsCorner {
                place,
                degrees: turn.to_degrees(),
                s: self.start,
            });
        }
        Ok(())
    }
}

/// The control points of `way`, with what is not said as at the point before.
fn control_points(way: &NurbsWay, from: &Tip) -> Result<Vec<Vector3<f64>>, PathError> {
    let mut position = from.position_mm;
    let mut points: Vec<Vector3<f64>> = Vec::with_capacity(way.points.len());
    for point in &way.points {
        for (now, said) in position.iter_mut().zip(point.position) {
            *now = said.unwrap_or(*now);
        }
        points.push(position.into());
    }
    // The curve begins exactly where the tip is, as a line or an arc does.
    if let (Some(first), Some(said)) = (points.first_mut(), way.points.first()) {
        let start: Vector3<f64> = from.position_mm.into();
        let distance = (*first - start).norm();
        if distance > START_TOLERANCE {
            let place = said.place;
            return Err(PathError::NurbsStart { place, distance });
        }
        *first = start;
    }
    Ok(points)
}

/// Derivatives over a parameter as ones over length.
fn by_length(at: &Moving) -> Moving {
    let speed = at.first.norm();
    let first = at.first / speed;
    let second = (at.second - first * first.dot(&at.second)) / (speed * speed);
    Moving {
        value: at.value,
        first,
        second,
    }
}
