extern crate std;

use super::*;
use nalgebra::{Vector3, Vector4};

const RADIUS: f64 = 10.0;
/// Tangent of a quarter of the sweep.
const QUARTER: f64 = 0.2;
const MIDDLE: [f64; 3] = [1.0, 2.0, 3.0];

fn parts() -> (PowerBasis, [f64; PARAMETER_COEFFICIENTS], f64) {
    // With τ = QUARTER·v the tangent of half the angle from the middle: x = 2Rτ/(1+τ²), y = 2Rτ²/(1+τ²).
    let x = Vector4::new(2.0 * RADIUS * QUARTER, 0.0, 0.0, 0.0);
    let y = Vector4::new(0.0, 2.0 * RADIUS * QUARTER * QUARTER, 0.0, QUARTER * QUARTER);
    let curve = PowerBasis::of_parts(Vector3::from(MIDDLE), &[x, y]).unwrap();
    // tan(s/2R) in powers of s.
    let tangent = [
        1.0,
        1.0 / 3.0,
        2.0 / 15.0,
        17.0 / 315.0,
        62.0 / 2835.0,
        1382.0 / 155_925.0,
        21844.0 / 6_081_075.0,
    ];
    let mut coefficients = [0.0; PARAMETER_COEFFICIENTS];
    for (i, t) in tangent.into_iter().enumerate() {
        coefficients[2 * i + 1] = t / QUARTER / libm::pow(2.0 * RADIUS, (2 * i + 1) as f64);
    }
    (curve, coefficients, 2.0 * RADIUS * libm::atan(QUARTER))
}

/// A part of a circle, of two terms.
pub(crate) fn arc() -> ArcLengthCurve {
    let (curve, coefficients, half_length) = parts();
    ArcLengthCurve::of_parts(curve, coefficients, half_length).unwrap()
}

#[test]
fn a_circle_of_its_parts_is_gone_along_evenly() {
    let arc = arc();
    for i in 0..=20 {
        let s = arc.length() * f64::from(i) / 20.0;
        let (sin, cos) = libm::sincos((s - arc.length() / 2.0) / RADIUS);
        let at = arc.at(s);
        let wanted = Vector3::from(MIDDLE) + Vector3::new(sin, 1.0 - cos, 0.0) * RADIUS;
        assert!((at.value - wanted).norm() < 1e-9, "{s}");
        assert!((at.first - Vector3::new(cos, sin, 0.0)).norm() < 1e-9, "{s}");
        assert!(
            (at.second - Vector3::new(-sin, cos, 0.0) / RADIUS).norm() < 1e-9,
            "{s}"
        );
    }
}

#[test]
fn parts_that_do_not_belong_together_are_no_curve() {
    let (curve, coefficients, half_length) = parts();
    let of = |coefficients, half_length| ArcLengthCurve::of_parts(curve, coefficients, half_length);
    assert!(of(coefficients, half_length).is_ok());
    assert_eq!(of(coefficients, 100.0 * half_length), Err(NoCurve));
    assert_eq!(of(coefficients, f64::NAN), Err(NoCurve));
    assert_eq!(of(coefficients.map(|c| c * 1.1), half_length), Err(NoCurve));
    assert_eq!(of([0.0; PARAMETER_COEFFICIENTS], half_length), Err(NoCurve));
}
