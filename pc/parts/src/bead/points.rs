//! Which points of a curve a program needs, so that the boards' spline through them is the curve.

use super::Attitude;
use super::error::BeadError;
use super::route::Route;
use cam::curve::Curve as Spline;
use cam::path::CAPACITY;
use curves::nurbs::{Curve, Discretisation, discretise};
use nalgebra::Vector3;
use shared::geometry::{Moving, angle};

/// Largest distance of the spline from the curve \[mm\]: half of what a planned path may have.
pub(super) const TOLERANCE: f64 = 1e-3;
/// Largest | |dP/ds| − 1 |: how exact the speed is.
const SPEED: f64 = 1e-3;
/// Largest angle between the travel and the turntable that follows it \[rad\]. Where the radius changes at once, a turntable
/// that were to follow exactly would have to change its rate at once.
const HEADING: f64 = 0.01;
/// Largest angle between two chords \[rad\]; beyond 0.35 a path counts as having a corner.
const MAX_TURN: f64 = 0.25;
/// The first points, before any spline is looked at: chord error \[mm\], turn \[rad\], chord \[mm\].
const FIRST: Discretisation = Discretisation {
    tolerance: 0.02,
    max_turn: MAX_TURN,
    max_chord: 10.0,
};
/// A path has no more points than boards hold, and they are no further apart than at first: no bead is longer \[mm\].
pub(super) const LONGEST: f64 = CAPACITY as f64 * FIRST.max_chord;
/// Places in each span where the spline is compared.
const LOOKS: usize = 6;

/// Chooses the places of a route that are to be points of the program, first and last included: few where the curve is calm, many in corners. Every span whose spline is not good enough is
/// halved, until all are.
pub(super) fn choose(route: &Route, attitude: Attitude) -> Result<Vec<f64>, BeadError> {
    let mut places = Vec::new();
    discretise(route, &FIRST, |t| places.push(t)).map_err(BeadError::Cut)?;
    loop {
        let spans = compare(route, attitude, &places)?;
        let worst = spans
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.badness().total_cmp(&b.1.badness()));
        let Some((index, _)) = worst.filter(|(_, span)| span.badness() > 1.0) else {
            return Ok(places);
        };
        let [x, y, z] = route.point(places[index]).into();
        let count = places.len();
        for (i, span) in spans.iter().enumerate() {
            if span.badness() > 1.0 {
                places.push((places[i] + places[i + 1]) / 2.0);
            }
        }
        if places.len() > CAPACITY {
            return Err(BeadError::TooManyPoints {
                places: count,
                x,
                y,
                z,
            });
        }
        places.sort_by(f64::total_cmp);
    }
}

/// How well the spline follows the curve between two points.
struct Span {
    deviation: f64,
    speed: f64,
    /// Of the spline through the directions at the points, if anything follows them.
    heading: f64,
    turn: f64,
}

impl Span {
    /// Above 1 it is not good enough.
    fn badness(&self) -> f64 {
        (self.deviation / TOLERANCE)
            .max(self.speed / SPEED)
            .max(self.heading / HEADING)
            .max(self.turn / MAX_TURN)
    }
}

fn compare(route: &Route, attitude: Attitude, places: &[f64]) -> Result<Vec<Span>, BeadError> {
    let points: Vec<[f64; 6]> = places.iter().map(|t| channels(&route.at(*t))).collect();
    let spline = Spline::by_length(&points).map_err(BeadError::Spline)?;
    let chord = |i: usize| vector(&points[i + 1], 0) - vector(&points[i], 0);
    let last = points.len() - 2;
    let span = |i: usize| {
        let [from, to] = [i, i + 1].map(|k| spline.parameters()[k]);
        let mut span = Span {
            deviation: 0.0,
            speed: 0.0,
            heading: 0.0,
            // With both neighbours: a corner between two spans is a matter of both.
            turn: [i.saturating_sub(1), (i + 1).min(last)]
                .map(|k| angle(&chord(i), &chord(k)))
                .into_iter()
                .fold(0.0, f64::max),
        };
        for k in 0..LOOKS {
            let part = (k as f64 + 0.5) / LOOKS as f64;
            let [at, slope, _] = spline.at(from + (to - from) * part);
            let p = vector(&at, 0);
            let guess = places[i] + (places[i + 1] - places[i]) * part;
            let nearest = route.at(route.nearest(&p, guess));
            span.deviation = span.deviation.max((p - nearest.value).norm());
            span.speed = span.speed.max((vector(&slope, 0).norm() - 1.0).abs());
            if attitude == Attitude::Tangent {
                span.heading = span.heading.max(angle(&vector(&at, 3), &nearest.first));
            }
        }
        span
    };
    Ok((0..=last).map(span).collect())
}

/// Position and direction.
fn channels(at: &Moving) -> [f64; 6] {
    std::array::from_fn(|i| if i < 3 { at.value[i] } else { at.first[i - 3] })
}

fn vector(channels: &[f64; 6], first: usize) -> Vector3<f64> {
    Vector3::from_fn(|i, _| channels[first + i])
}
