//! Rational Bézier curves in the power basis: the quickest form to evaluate.

use super::super::Moving;
use super::bezier::RationalBezier;
use super::de_boor::{homogeneous, project};
use super::{MAX_DEGREE, ORDER};
use nalgebra::{Vector3, Vector4};

/// A [`RationalBezier`] as polynomials about its middle: over v = 2t − 1, from −1 to 1.
///
/// About the middle, and relative to the point there, the terms stay small, and so does their rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerBasis {
    middle: Vector3<f64>,
    /// Of v, v², …: what (w·(C − middle), w) has beside its value (0, 0, 0, 1) in the middle.
    terms: [Vector4<f64>; MAX_DEGREE],
    degree: usize,
}

impl PowerBasis {
    /// The same curve as `curve`.
    ///
    /// Over its second half v goes from 0 to 1, so the terms are the binomial differences of the control points
    /// of that half.
    pub fn new(curve: &RationalBezier) -> Self {
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
        Self {
            middle,
            terms,
            degree,
        }
    }

    /// The point in the middle, and the terms in use.
    pub fn parts(&self) -> (Vector3<f64>, &[Vector4<f64>]) {
        (self.middle, &self.terms[..self.degree])
    }

    /// A curve of these [parts](Self::parts); terms beyond the highest degree are left out. `None` without terms: a
    /// point is no curve.
    pub fn of_parts(middle: Vector3<f64>, terms: &[Vector4<f64>]) -> Option<Self> {
        let degree = terms.len().min(MAX_DEGREE);
        let mut all = [Vector4::zeros(); MAX_DEGREE];
        all[..degree].copy_from_slice(&terms[..degree]);
        (degree > 0).then_some(Self {
            middle,
            terms: all,
            degree,
        })
    }

    /// Point \[mm\], first and second derivative over `v`, by Horner's rule. Outside −1 to 1 the curve goes on by
    /// its formula.
    #[inline]
    pub fn at(&self, v: f64) -> Moving {
        let [mut first, mut half_second] = [Vector4::zeros(); 2];
        let mut value = self.terms[self.degree - 1];
        for term in self.terms[..self.degree - 1].iter().rev() {
            half_second = half_second * v + first;
            first = first * v + value;
            value = value * v + term;
        }
        half_second = half_second * v + first;
        first = first * v + value;
        value = value * v + Vector4::w();
        let mut moving = project(&value, &first, &(half_second * 2.0));
        moving.value += self.middle;
        moving
    }
}
