//! Curves to test with.

use curves::nurbs::{Curve, MAX_DEGREE, Nurbs, NurbsError};
use nalgebra::Vector3;
use proptest::prelude::*;

/// What a curve borrows.
#[derive(Clone, Debug)]
pub struct Definition {
    pub degree: usize,
    pub points: Vec<Vector3<f64>>,
    pub weights: Vec<f64>,
    pub knots: Vec<f64>,
}

impl Definition {
    pub fn try_curve(&self) -> Result<Nurbs<'_>, NurbsError> {
        Nurbs::new(self.degree, &self.points, &self.weights, &self.knots)
    }

    pub fn curve(&self) -> Nurbs<'_> {
        self.try_curve().expect("valid")
    }

    /// Largest weight by smallest.
    pub fn weight_ratio(&self) -> f64 {
        let fold = |f: fn(f64, f64) -> f64| self.weights.iter().copied().reduce(f).expect("weights");
        fold(f64::max) / fold(f64::min)
    }

    /// Largest coordinate.
    pub fn size(&self) -> f64 {
        self.points.iter().map(|p| p.amax()).fold(0.0, f64::max)
    }
}

/// The parameter a `part` (0…1) of the domain after its start.
pub fn at_part<C: Curve>(curve: &C, part: f64) -> f64 {
    let [first, last] = curve.domain();
    first + (last - first) * part
}

/// A circle about the origin in the plane z = 0: nine points, degree 2, four spans.
pub fn circle(radius: f64) -> Definition {
    let corners = [
        (1, 0),
        (1, 1),
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
        (0, -1),
        (1, -1),
        (1, 0),
    ];
    let half = std::f64::consts::FRAC_1_SQRT_2;
    Definition {
        degree: 2,
        points: corners
            .map(|(x, y)| Vector3::new(f64::from(x), f64::from(y), 0.0) * radius)
            .to_vec(),
        weights: (0..9).map(|i| if i % 2 == 0 { 1.0 } else { half }).collect(),
        knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
    }
}

fn point() -> impl Strategy<Value = Vector3<f64>> {
    [-100.0..100.0f64, -100.0..100.0f64, -100.0..100.0f64].prop_map(Vector3::from)
}

/// Any valid curve: all degrees, clamped or not, with single and repeated knots inside, weights of a ratio up
/// to 100, and now and then a control point on the one before it.
pub fn any_curve() -> impl Strategy<Value = Definition> {
    (1..=MAX_DEGREE, 0..8usize, any::<bool>()).prop_flat_map(|(degree, extra, clamped)| {
        let n = degree + 1 + extra;
        let points = prop::collection::vec((point(), prop::bool::weighted(0.05)), n);
        let weights = prop::collection::vec((-1.0..1.0f64).prop_map(|e| 10f64.powf(e)), n);
        // Steps between knots; some are zero.
        let steps = prop::collection::vec((0.02..1.0f64, prop::bool::weighted(0.2)), n + degree);
        (points, weights, steps).prop_map(move |(points, weights, steps)| Definition {
            degree,
            points: coinciding(points),
            weights,
            knots: knots(degree, clamped, &steps),
        })
    })
}

fn coinciding(points: Vec<(Vector3<f64>, bool)>) -> Vec<Vector3<f64>> {
    let mut made: Vec<Vector3<f64>> = Vec::new();
    for (point, repeat) in points {
        let last = made.last().copied();
        made.push(if repeat { last.unwrap_or(point) } else { point });
    }
    made
}

/// Knots with these steps; a step is taken after all where too many knots would be equal.
fn knots(degree: usize, clamped: bool, steps: &[(f64, bool)]) -> Vec<f64> {
    let count = steps.len() + 1;
    let last = count - 1 - degree;
    let mut knots = vec![0.0f64];
    let mut equal = 1;
    for (i, &(step, none)) in (1..).zip(steps) {
        let at_end = clamped && (i <= degree || i > last);
        let end_of_domain = i == degree + 1 || clamped && i == last;
        let stay = at_end || none && !end_of_domain && equal < degree;
        equal = if stay { equal + 1 } else { 1 };
        knots.push(knots[i - 1] + if stay { 0.0 } else { step });
    }
    knots
}
