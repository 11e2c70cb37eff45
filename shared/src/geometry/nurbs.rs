//! Pieces of NURBS in the power basis: the quickest form to evaluate (mathematics 3).

use super::Moving;
use nalgebra::{Vector3, Vector4};

/// The highest degree of a curve; CAD systems rarely write a higher one.
pub const MAX_DEGREE: usize = 5;

/// A rational Bézier curve as polynomials about its middle: over v = 2t − 1, from −1 to 1.
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

    /// Point \[mm\], first and second derivative over `v`, by Horner's rule. Outside −1 to 1 the curve
    /// continues by its formula.
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

/// A homogeneous point with its derivatives, divided by its weight.
pub fn project(a: &Vector4<f64>, a1: &Vector4<f64>, a2: &Vector4<f64>) -> Moving {
    let per_weight = 1.0 / a.w;
    let value = a.xyz() * per_weight;
    let first = (a1.xyz() - value * a1.w) * per_weight;
    let second = (a2.xyz() - first * (2.0 * a1.w) - value * a2.w) * per_weight;
    Moving { value, first, second }
}
