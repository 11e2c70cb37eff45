//! The parameter of a curve as a polynomial over its arc length.
//!
//! dv/ds = 1/|C′(v)| is solved by collocation: a polynomial v(s) that fulfils it at Lobatto's nodes, both ends
//! among them, so that pieces join without a step in speed. |C′(v(s))|·dv/ds − 1 is the fluctuation of the speed
//! along the curve at s, exactly and without a quadrature; so it is checked between the nodes.

use super::FLUCTUATION;
use crate::geometry::nurbs::PowerBasis;
use thiserror::Error;

/// Lobatto's nodes on [−1, 1]: the ends and the zeros of P′₁₁.
const NODES: [f64; 12] = [
    -1.0,
    -0.944_899_272_222_882_2,
    -0.819_279_321_644_006_7,
    -0.632_876_153_031_860_7,
    -0.399_530_940_965_348_9,
    -0.136_552_932_854_927_55,
    0.136_552_932_854_927_55,
    0.399_530_940_965_348_9,
    0.632_876_153_031_860_7,
    0.819_279_321_644_006_7,
    0.944_899_272_222_882_2,
    1.0,
];

/// Coefficients of the parameter, from the constant one on.
pub(super) const COEFFICIENTS: usize = NODES.len() + 1;

/// Sweeps of Picard's iteration. Each gains a digit, and later ones more, on curves that are even enough.
const SWEEPS: usize = 12;

/// Parameters that change less in a sweep have settled.
const SETTLED: f64 = 1e-9;

/// The parameter varies too much over the length of the curve for its table.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "too uneven: the speed along the curve would be off by {fluctuation:e} of itself, {FLUCTUATION:e} is allowed; \
     split the curve"
)]
pub struct TooUneven {
    /// By how much the speed would be off, as a part of itself; infinite if there is no table.
    pub fluctuation: f32,
}

/// Coefficients of the parameter v, from −1 to 1, over the length from the middle \[mm\], and half the length.
pub(super) fn tabulate(curve: &PowerBasis) -> Result<([f64; COEFFICIENTS], f64), TooUneven> {
    let (slope, half_length) = collocate(curve).ok_or(TooUneven {
        fluctuation: f32::INFINITY,
    })?;
    let mut parameter = integral(&slope, half_length);
    for pair in NODES.windows(2) {
        let x = (pair[0] + pair[1]) / 2.0;
        let fluctuation = libm::fabs(speed(curve, horner(&parameter, x)) * horner(&slope, x) - 1.0);
        let even = fluctuation <= FLUCTUATION / 2.0;
        if !even {
            return Err(TooUneven {
                fluctuation: fluctuation as f32,
            });
        }
    }
    let mut scale = 1.0;
    for coefficient in &mut parameter {
        *coefficient *= scale;
        scale /= half_length;
    }
    Ok((parameter, half_length))
}

/// Solves dv/ds = 1/|C′(v)| by Picard's iteration: coefficients of 1/|C′| over x, the length from the middle as
/// a part of half the length, and that half \[mm\]. Nothing if it does not settle or the curve has no speed.
fn collocate(curve: &PowerBasis) -> Option<([f64; NODES.len()], f64)> {
    let mut parameters = NODES;
    for _ in 0..SWEEPS {
        let slope = interpolate(parameters.map(|v| 1.0 / speed(curve, v)));
        let half_length = 1.0 / half_rise(&slope);
        if !half_length.is_normal() {
            return None;
        }
        let parameter = integral(&slope, half_length);
        let mut change = 0.0;
        for (v, &x) in parameters.iter_mut().zip(&NODES) {
            // The curve is only known between its ends.
            let new = horner(&parameter, x).clamp(-1.0, 1.0);
            change = libm::fmax(change, libm::fabs(new - *v));
            *v = new;
        }
        if change <= SETTLED {
            return Some((slope, half_length));
        }
    }
    None
}

/// |dC/dv| \[mm\].
fn speed(curve: &PowerBasis, v: f64) -> f64 {
    curve.at(v).first.norm()
}

/// Coefficients of the polynomial with these values at the nodes: divided differences, multiplied out.
fn interpolate(values: [f64; NODES.len()]) -> [f64; NODES.len()] {
    let last = NODES.len() - 1;
    let mut c = values;
    for level in 1..=last {
        for i in (level..=last).rev() {
            c[i] = (c[i] - c[i - 1]) / (NODES[i] - NODES[i - level]);
        }
    }
    for k in (0..last).rev() {
        for i in k..last {
            c[i] -= NODES[k] * c[i + 1];
        }
    }
    c
}

/// Half the integral of a polynomial from −1 to 1; odd powers have no part in that.
fn half_rise(polynomial: &[f64; NODES.len()]) -> f64 {
    let even = polynomial.iter().enumerate().step_by(2);
    even.map(|(power, c)| c / (power + 1) as f64).sum()
}

/// Coefficients of `scale` times the integral of a polynomial, which is as much above 0 at 1 as below it at −1.
fn integral(polynomial: &[f64; NODES.len()], scale: f64) -> [f64; COEFFICIENTS] {
    let mut integral = [0.0; COEFFICIENTS];
    for (power, c) in (1..).zip(polynomial) {
        integral[power] = scale * c / power as f64;
    }
    integral[0] = -integral.iter().skip(2).step_by(2).sum::<f64>();
    integral
}

/// The value of a polynomial.
fn horner(polynomial: &[f64], x: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |value, c| value * x + c)
}
