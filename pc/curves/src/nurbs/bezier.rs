//! Rational Bézier curves: the pieces a NURBS falls into, of fixed size.

use super::curve::Curve;
use super::de_boor::{evaluate, homogeneous};
use super::validation::{NurbsError, check_degree, check_points};
use super::{MAX_DEGREE, ORDER};
use nalgebra::{Vector3, Vector4};
use shared::geometry::Moving;

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
        let mut curve = Self::of_degree(degree);
        curve.points[..=degree].copy_from_slice(points);
        curve.weights[..=degree].copy_from_slice(weights);
        Ok(curve)
    }

    /// Points and weights of this degree that are yet to be set.
    pub(super) fn of_degree(degree: usize) -> Self {
        Self {
            degree,
            points: [Vector3::zeros(); ORDER],
            weights: [0.0; ORDER],
        }
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

    pub(super) fn set(&mut self, i: usize, point: &Vector4<f64>) {
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
