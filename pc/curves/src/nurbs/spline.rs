//! The NURBS curve itself (mathematics 3.1).

use super::curve::Curve;
use super::de_boor::{Net, evaluate, homogeneous};
use super::validation::{NurbsError, validate};
use nalgebra::Vector3;
use shared::geometry::Moving;

/// C(u) = Σ N(u)·w·d / Σ N(u)·w over borrowed control points d \[mm\], weights w and knots.
///
/// Valid by construction, so that evaluation cannot fail. Coincident control points and repeated knots are
/// allowed: at the first the curve may have no tangent, at the second a kink, and both show in
/// [`curvature`](super::curvature) and at the [breaks](Curve::next_break).
#[derive(Clone, Copy, Debug)]
pub struct Nurbs<'a> {
    degree: usize,
    points: &'a [Vector3<f64>],
    weights: &'a [f64],
    knots: &'a [f64],
}

impl<'a> Nurbs<'a> {
    /// The curve of `degree` k with n control points, n weights and n + k + 1 knots.
    pub fn new(
        degree: usize,
        points: &'a [Vector3<f64>],
        weights: &'a [f64],
        knots: &'a [f64],
    ) -> Result<Self, NurbsError> {
        validate(degree, points, weights, knots)?;
        Ok(Self {
            degree,
            points,
            weights,
            knots,
        })
    }

    /// Degree k.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Index i of the span [uᵢ, uᵢ₊₁) that holds `u`; at the end of the domain and beyond, the last span that
    /// is not empty; before the domain, its first.
    pub fn span(&self, u: f64) -> usize {
        let (first, last) = (self.degree, self.points.len());
        let inside = &self.knots[..=last];
        if u < self.knots[last] {
            inside.partition_point(|&knot| knot <= u).max(first + 1) - 1
        } else {
            inside.partition_point(|&knot| knot < self.knots[last]) - 1
        }
    }

    /// Control points of span `i`, and the knots around it.
    pub(super) fn net(&self, i: usize) -> (Net, &'a [f64]) {
        let k = self.degree;
        let net = homogeneous(&self.points[i - k..=i], &self.weights[i - k..=i]);
        (net, &self.knots[i + 1 - k..=i + k])
    }

    /// Bounds of span `i`.
    pub(super) fn bounds(&self, i: usize) -> [f64; 2] {
        [self.knots[i], self.knots[i + 1]]
    }
}

impl Curve for Nurbs<'_> {
    fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.points.len()]]
    }

    fn at(&self, u: f64) -> Moving {
        let [first, last] = self.domain();
        let u = libm::fmin(libm::fmax(u, first), last);
        let (net, knots) = self.net(self.span(u));
        evaluate(net, knots, u)
    }

    fn next_break(&self, u: f64) -> f64 {
        self.knots[self.span(u) + 1]
    }
}
