//! A curve over its arc length in plain numbers, as it goes over the wire.

use super::ArcLengthCurve;
use super::arc_length::{COEFFICIENTS, Parameter};
use crate::geometry::Moving;
use crate::geometry::nurbs::{MAX_DEGREE, PowerBasis};
use heapless::Vec;
use nalgebra::{Vector2, Vector3, Vector4};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The numbers of an [`ArcLengthCurve`]: they mean nothing by themselves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct CurveNumbers {
    middle: [f64; 3],
    terms: Vec<[f64; 4], MAX_DEGREE>,
    parameter: [[f64; 2]; COEFFICIENTS / 2],
    half_length: f64,
}

impl From<&ArcLengthCurve> for CurveNumbers {
    fn from(curve: &ArcLengthCurve) -> Self {
        let (middle, terms) = curve.curve.parts();
        Self {
            middle: middle.into(),
            terms: terms.iter().map(|term| (*term).into()).collect(),
            parameter: curve.parameter.0.map(Into::into),
            half_length: curve.half_length,
        }
    }
}

/// The numbers are no curve over its arc length: there are none, one is not finite, or somewhere the curve is not as
/// fast as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the numbers of the curve are none over its arc length")]
pub struct NoCurve;

/// Places at which numbers that came in are checked.
const CHECKED: u32 = 24;
/// By how much the speed along the curve may be off there: numbers of a curve are exact to [`super::FLUCTUATION`],
/// others are off by far more.
const OFF: f64 = 1e-3;

impl TryFrom<&CurveNumbers> for ArcLengthCurve {
    type Error = NoCurve;

    fn try_from(numbers: &CurveNumbers) -> Result<Self, NoCurve> {
        let terms: Vec<Vector4<f64>, MAX_DEGREE> =
            numbers.terms.iter().map(|term| Vector4::from(*term)).collect();
        let curve = Self {
            curve: PowerBasis::of_parts(Vector3::from(numbers.middle), &terms).ok_or(NoCurve)?,
            parameter: Parameter(numbers.parameter.map(Vector2::from)),
            half_length: numbers.half_length,
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
}
