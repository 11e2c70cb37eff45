//! Rational Bézier curves in the power basis, in which boards evaluate them.

use super::bezier::RationalBezier;
use super::de_boor::homogeneous;
use super::{MAX_DEGREE, ORDER};
use nalgebra::{Vector3, Vector4};
use shared::geometry::nurbs::PowerBasis;

/// The same curve as `curve`, as polynomials about its middle.
///
/// Over its second half v goes from 0 to 1, so the terms are the binomial differences of the control points
/// of that half.
pub fn power_basis(curve: &RationalBezier) -> PowerBasis {
    let [_, half] = curve.split(0.5);
    let (degree, middle, weight) = (half.degree(), half.points()[0], half.weights()[0]);
    let mut relative = [Vector3::zeros(); ORDER];
    for (slot, point) in relative.iter_mut().zip(half.points()) {
        *slot = point - middle;
    }
    let mut differences = homogeneous(&relative[..=degree], half.weights());
    let mut terms = [Vector4::zeros(); MAX_DEGREE];
    let mut binomial = 1.0;
    for k in 1..=degree {
        for i in 0..=degree - k {
            differences[i] = differences[i + 1] - differences[i];
        }
        binomial *= (degree + 1 - k) as f64 / k as f64;
        terms[k - 1] = differences[0] * (binomial / weight);
    }
    PowerBasis::of_parts(middle, &terms[..degree]).expect("a Bézier curve has a degree of 1 or more")
}
