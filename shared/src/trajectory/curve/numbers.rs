//! A curve over its arc length in plain numbers, as it goes over the wire.

use super::parameter::{PARAMETER_COEFFICIENTS, Parameter};
use super::{ArcLengthCurve, NoCurve};
use crate::geometry::nurbs::{MAX_DEGREE, PowerBasis};
use heapless::Vec;
use nalgebra::{Vector2, Vector3, Vector4};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The numbers of an [`ArcLengthCurve`]: they mean nothing by themselves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct CurveNumbers {
    middle: [f64; 3],
    terms: Vec<[f64; 4], MAX_DEGREE>,
    parameter: [[f64; 2]; PARAMETER_COEFFICIENTS / 2],
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

impl TryFrom<&CurveNumbers> for ArcLengthCurve {
    type Error = NoCurve;

    fn try_from(numbers: &CurveNumbers) -> Result<Self, NoCurve> {
        let terms: Vec<Vector4<f64>, MAX_DEGREE> =
            numbers.terms.iter().map(|term| Vector4::from(*term)).collect();
        let curve = PowerBasis::of_parts(Vector3::from(numbers.middle), &terms).ok_or(NoCurve)?;
        let parameter = Parameter(numbers.parameter.map(Vector2::from));
        Self::checked(curve, parameter, numbers.half_length)
    }
}
