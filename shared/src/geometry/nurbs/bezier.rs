//! Rational Bézier curves: the pieces a NURBS falls into, of fixed size.

use super::super::Moving;
use super::curve::Curve;
use super::de_boor::{blossom, evaluate, homogeneous};
use super::spline::Nurbs;
use super::validation::{NurbsError, check_degree, check_points};
use super::{MAX_DEGREE, ORDER};
use nalgebra::{Vector3, Vector4};

/// A rational Bézier curve over t from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RationalBezier {
    degree: usize,
    points: [Vector3<f64>; ORDER],
    weights: [f64; ORDER],
}

/// Knots of a Bézier curve: a 0 and a 1 for each degree.
const KNOTS: [f64; 2 * MAX_DEGREE] = {
    let mut knots = [0.0; 2 * MAX_DEGREE];
    let mut i = MAX_DEGREE;
    while i < 2 * MAX_DEGREE {
        knots[i] = 1.0;
        i += 1;
    }
    knots
};

impl RationalBezier {
    /// The curve with these control points \[mm\] and weights; its degree is one less than their number.
    pub fn new(points: &[Vector3<f64>], weights: &[f64]) -> Result<Self, NurbsError> {
        let degree = points.len().saturating_sub(1);
        check_degree(degree, points.len())?;
        check_points(points, weights)?;
        let mut curve = Self {
            degree,
            points: [Vector3::zeros(); ORDER],
            weights: [0.0; ORDER],
        };
        curve.points[..=degree].copy_from_slice(points);
        curve.weights[..=degree].copy_from_slice(weights);
        Ok(curve)
    }

    /// Degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The curve up to `t` and the curve from `t` on, each over 0 to 1, by de Casteljau. `t` lies inside 0 to 1.
    ///
    /// The two meet, and end where the curve ends, to the last digit.
    pub fn split(&self, t: f64) -> [Self; 2] {
        let [mut before, mut after] = [*self; 2];
        let mut net = homogeneous(self.points(), self.weights());
        for level in 1..=self.degree {
            for j in 0..=self.degree - level {
                net[j] = net[j] * (1.0 - t) + net[j + 1] * t;
            }
            before.set(level, &net[0]);
            after.set(self.degree - level, &net[self.degree - level]);
        }
        [before, after]
    }

    fn set(&mut self, i: usize, point: &Vector4<f64>) {
        self.points[i] = point.xyz() / point.w;
        self.weights[i] = point.w;
    }

    /// Control points \[mm\], one more than the degree.
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points[..=self.degree]
    }

    /// Weights of the control points.
    pub fn weights(&self) -> &[f64] {
        &self.weights[..=self.degree]
    }
}

impl Curve for RationalBezier {
    fn domain(&self) -> [f64; 2] {
        [0.0, 1.0]
    }

    fn at(&self, u: f64) -> Moving {
        let knots = &KNOTS[MAX_DEGREE - self.degree..MAX_DEGREE + self.degree];
        let u = libm::fmin(libm::fmax(u, 0.0), 1.0);
        evaluate(homogeneous(self.points(), self.weights()), knots, u)
    }

    fn next_break(&self, _u: f64) -> f64 {
        1.0
    }
}

/// One span of a NURBS as a Bézier curve: C(u) is the curve at t = (u − from) / (to − from), and a derivative
/// over u is the one over t divided by (to − from), once for each order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The same points as the span.
    pub curve: RationalBezier,
    /// Parameter of the NURBS at t = 0.
    pub from: f64,
    /// Parameter of the NURBS at t = 1.
    pub to: f64,
}

/// The pieces of a NURBS, in order; see [`Nurbs::pieces`].
#[derive(Clone, Debug)]
pub struct Pieces<'a> {
    nurbs: Nurbs<'a>,
    /// Where the next piece begins.
    from: f64,
}

impl<'a> Pieces<'a> {
    pub(super) fn new(nurbs: Nurbs<'a>) -> Self {
        let [from, _] = nurbs.domain();
        Self { nurbs, from }
    }
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    /// Inserting both ends of the span as knots until they are full leaves the control points f(from, …, to, …)
    /// of the blossom f, with one more `to` from point to point. Weights stay positive (see `de_boor`).
    fn next(&mut self) -> Option<Piece> {
        let [_, end] = self.nurbs.domain();
        if self.from >= end {
            return None;
        }
        let span = self.nurbs.span(self.from);
        let [from, to] = self.nurbs.bounds(span);
        let (net, knots) = self.nurbs.net(span);
        let degree = self.nurbs.degree();
        let mut curve = RationalBezier {
            degree,
            points: [Vector3::zeros(); ORDER],
            weights: [0.0; ORDER],
        };
        for j in 0..=degree {
            let arguments = (0..degree).map(|level| if level < degree - j { from } else { to });
            curve.set(j, &blossom(net, knots, arguments));
        }
        self.from = to;
        Some(Piece { curve, from, to })
    }
}
