//! Free-form curves over their arc length.
//!
//! A rational Bézier curve has no formula for its parameter at a length, so that is tabulated as a polynomial,
//! to the accuracy that the [speed](FLUCTUATION) asks for. Where the curve is too uneven for one polynomial, as
//! where it almost turns on the spot, [`ArcLengthPieces`] cuts it.

mod arc_length;
mod numbers;
mod pieces;

pub use arc_length::{FLUCTUATION, TooUneven};
pub use numbers::{CurveNumbers, NoCurve};
pub use pieces::{ArcLengthPiece, ArcLengthPieces, Cusp};

use crate::geometry::Moving;
use crate::geometry::nurbs::{PowerBasis, RationalBezier};
use arc_length::{Parameter, tabulate};

/// A rational Bézier curve over its arc length, of fixed size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcLengthCurve {
    curve: PowerBasis,
    parameter: Parameter,
    half_length: f64,
}

impl ArcLengthCurve {
    /// The same curve as `curve`, or an error if it must be split first. The work is bounded: at most 168
    /// evaluations of the curve, mostly about 80.
    pub fn new(curve: &RationalBezier) -> Result<Self, TooUneven> {
        let curve = PowerBasis::new(curve);
        let (parameter, half_length) = tabulate(&curve)?;
        Ok(Self {
            curve,
            parameter,
            half_length,
        })
    }

    /// Length \[mm\]; to 1e-9 of itself.
    pub fn length(&self) -> f64 {
        2.0 * self.half_length
    }

    /// Point \[mm\] and its derivatives over the length `s` \[mm\] gone: unit tangent and curvature vector.
    ///
    /// They are those of the curve at one parameter, to rounding; that parameter belongs to the length `s` so
    /// closely that the speed along the curve is off by a part of [`FLUCTUATION`] at most. A little outside 0 to
    /// the length the curve goes on by its formula.
    pub fn at(&self, s: f64) -> Moving {
        let (v, rate) = self.parameter.at(s - self.half_length);
        let over_v = self.curve.at(v);
        // dv/ds is 1/|C′| but for the fluctuation; a step of Newton leaves less than a digit of that.
        let per_speed = rate * (1.5 - 0.5 * over_v.first.norm_squared() * (rate * rate));
        let first = over_v.first * per_speed;
        let second = over_v.second * (per_speed * per_speed);
        Moving {
            value: over_v.value,
            first,
            second: second - first * first.dot(&second),
        }
    }
}
