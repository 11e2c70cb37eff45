//! The interface of parametric curves, and their curvature (mathematics 3.2).

use nalgebra::Vector3;
use shared::geometry::Moving;
use thiserror::Error;

/// A curve over a parameter u, smooth but at a finite number of parameters, its breaks.
pub trait Curve {
    /// First and last parameter.
    fn domain(&self) -> [f64; 2];

    /// Point \[mm\], first and second derivative over the parameter, which is clamped to the domain. At a break
    /// the derivatives are those on its right; at the end of the domain those on its left.
    fn at(&self, u: f64) -> Moving;

    /// The next break after `u`, or the end of the domain.
    fn next_break(&self, u: f64) -> f64;

    /// The point alone.
    fn point(&self, u: f64) -> Vector3<f64> {
        self.at(u).value
    }
}

/// The smooth stretches of `curve` between two parameters, in order.
pub(super) fn spans<C: Curve>(curve: &C, from: f64, to: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
    let [first, last] = curve.domain();
    let (mut begin, end) = (libm::fmax(from, first), libm::fmin(to, last));
    core::iter::from_fn(move || {
        let span = [begin, libm::fmin(curve.next_break(begin), end)];
        // Not "≥", so that a NaN ends it too.
        (begin < end).then(|| {
            begin = span[1];
            span
        })
    })
}

/// The curve has no direction at a parameter, for instance where control points coincide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("no tangent: the first derivative is zero; move control points that coincide apart")]
pub struct NoTangent;

/// Shortest first derivative that has a direction.
const NO_SPEED: f64 = 1e-12;

/// Length of the first derivative, if there is one to go along.
pub(super) fn speed(at: &Moving) -> Option<f64> {
    let speed = at.first.norm();
    (speed.is_finite() && speed >= NO_SPEED).then_some(speed)
}

/// Curvature \[1/mm\]: |C′×C″| / |C′|³.
pub fn curvature(at: &Moving) -> Result<f64, NoTangent> {
    let speed = speed(at).ok_or(NoTangent)?;
    // Divided early: the cube of a small speed would lose the digits.
    Ok((at.first / speed).cross(&(at.second / speed)).norm() / speed)
}
