//! The parameter of a curve as a polynomial over its arc length.

use nalgebra::Vector2;

/// Coefficients of the parameter of an [`ArcLengthCurve`](super::ArcLengthCurve) over its length.
pub const PARAMETER_COEFFICIENTS: usize = 14;

/// The parameter v, from −1 to 1, over the length from the middle of a curve.
///
/// Coefficients of an even power and the odd one above it side by side: Horner's rule over the square of the
/// length then takes half as many steps, of two coefficients each, which two lanes of a processor share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parameter(pub(super) [Vector2<f64>; PARAMETER_COEFFICIENTS / 2]);

impl Parameter {
    /// v and dv/dx \[1/mm\] at the length `x` \[mm\] from the middle.
    #[inline]
    pub(super) fn at(&self, x: f64) -> (f64, f64) {
        let square = x * x;
        let [lower @ .., highest] = &self.0;
        let (mut sum, mut slope) = (*highest, Vector2::zeros());
        for pair in lower.iter().rev() {
            slope = slope * square + sum;
            sum = sum * square + pair;
        }
        (sum.x + x * sum.y, sum.y + 2.0 * x * (slope.x + x * slope.y))
    }
}
