//! Free-form curves over their arc length.
//!
//! A rational Bézier curve has no formula for its parameter at a length, so that comes with it as a polynomial, which
//! the PC tabulates.

mod numbers;
mod parameter;
#[cfg(test)]
pub(crate) mod tests;

pub use numbers::CurveNumbers;
pub use parameter::PARAMETER_COEFFICIENTS;

use crate::geometry::Moving;
use crate::geometry::nurbs::PowerBasis;
use nalgebra::Vector2;
use parameter::Parameter;
use thiserror::Error;

/// Places at which numbers that came in are checked.
const CHECKED: u32 = 24;
/// By how much the speed along the curve may be off there: that of a tabulated one is exact to a millionth, others are
/// off by far more.
const OFF: f64 = 1e-3;

/// The numbers of the curve are none over its arc length: there are none, one is not finite, or somewhere the curve is not as
/// fast as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the curve is not parametrised by its arc length")]
pub struct NoCurve;

/// A rational Bézier curve over its arc length, of fixed size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcLengthCurve {
    curve: PowerBasis,
    parameter: Parameter,
    half_length: f64,
}

impl ArcLengthCurve {
    /// The curve whose parameter, from −1 to 1, has these `coefficients`, from the constant one on, over the length \[mm\]
    /// from its middle; it is twice `half_length` \[mm\] long.
    pub fn of_parts(
        curve: PowerBasis,
        coefficients: [f64; PARAMETER_COEFFICIENTS],
        half_length: f64,
    ) -> Result<Self, NoCurve> {
        let pairs = core::array::from_fn(|i| Vector2::new(coefficients[2 * i], coefficients[2 * i + 1]));
        Self::checked(curve, Parameter(pairs), half_length)
    }

    fn checked(curve: PowerBasis, parameter: Parameter, half_length: f64) -> Result<Self, NoCurve> {
        let curve = Self {
            curve,
            parameter,
            half_length,
        };
        let sound = |place: u32| {
            let s = curve.length() * (f64::from(place) / f64::from(CHECKED));
            let Moving { value, first, second } = curve.at(s);
            let finite = value.iter().chain(second.iter()).all(|x| x.is_finite());
            finite && libm::fabs(first.norm() - 1.0) <= OFF
        };
        if (0..=CHECKED).all(sound) {
            Ok(curve)
        } else {
            Err(NoCurve)
        }
    }

    /// Length \[mm\]; to 1e-9 of itself.
    pub fn length(&self) -> f64 {
        2.0 * self.half_length
    }

    /// Point \[mm\] and its derivatives over the length `s` \[mm\] gone: unit tangent and curvature vector.
    ///
    /// They are those of the curve at one parameter, to rounding; that parameter belongs to the length `s` as closely as
    /// it was tabulated. A little outside 0 to the length the curve continues by its formula.
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
