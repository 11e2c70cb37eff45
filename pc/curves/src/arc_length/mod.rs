//! Free-form curves over their arc length.
//!
//! A rational Bézier curve has no formula for its parameter at a length, so that is tabulated as a polynomial,
//! to the accuracy that the [speed](FLUCTUATION) asks for. Where the curve is too uneven for one polynomial, as
//! where it almost turns on the spot, [`ArcLengthPieces`] cuts it.
//!
//! dv/ds = 1/|C′(v)| is solved by collocation: a polynomial v(s) that fulfils it at Lobatto's nodes, both ends
//! among them, so that pieces join without a step in speed. |C′(v(s))|·dv/ds − 1 is the fluctuation of the speed
//! along the curve at s, exactly and without a quadrature; so it is checked between the nodes.

mod pieces;

pub use pieces::{ArcLengthPiece, ArcLengthPieces, Cusp};

use crate::nurbs::{RationalBezier, power_basis};
use shared::geometry::nurbs::PowerBasis;
use shared::trajectory::{ArcLengthCurve, NoCurve, PARAMETER_COEFFICIENTS as COEFFICIENTS};
use thiserror::Error;

/// Deviation of the speed along a curve from the one that is asked for, as a part of it, at most. Half of it is
/// kept in reserve for what lies between the places that are checked.
pub const FLUCTUATION: f64 = 5e-7;

/// Nodes of the collocation.
const COUNT: usize = 13;

/// Lobatto's nodes on [−1, 1]: the ends and the zeros of P′₁₂.
const NODES: [f64; COUNT] = [
    -1.0,
    -0.953_309_846_642_163_9,
    -0.846_347_564_651_872_3,
    -0.686_188_469_081_757_5,
    -0.482_909_821_091_336_2,
    -0.249_286_930_106_239_98,
    0.0,
    0.249_286_930_106_239_98,
    0.482_909_821_091_336_2,
    0.686_188_469_081_757_5,
    0.846_347_564_651_872_3,
    0.953_309_846_642_163_9,
    1.0,
];

// The integral of a polynomial through the values at all nodes.
const _: () = assert!(COEFFICIENTS == COUNT + 1);

/// For each node, the weights of the values at all nodes in their [integral] there.
static INTEGRALS: [[f64; COUNT]; COUNT] = integrals();

/// Sweeps of Picard's iteration. Each gains a digit, and later ones more, on curves that are even enough.
const SWEEPS: usize = 12;

/// Parameters that change less in a sweep have settled.
const SETTLED: f64 = 1e-9;

/// The parameter varies too much over the length of the curve for its table.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "too uneven: the speed along the curve would vary by a factor of {fluctuation:e}, {FLUCTUATION:e} is allowed; \
     split the curve"
)]
pub struct TooUneven {
    /// By how much the speed would be off, as a part of itself; infinite if there is no table.
    pub fluctuation: f32,
}

/// The same curve as `curve` over its arc length, or an error if it must be split first. The work is bounded: at most
/// 193 evaluations of the curve, mostly about 105.
pub fn tabulate(curve: &RationalBezier) -> Result<ArcLengthCurve, TooUneven> {
    let curve = power_basis(curve);
    let (parameter, half_length) = table(&curve)?;
    ArcLengthCurve::of_parts(curve, parameter, half_length).map_err(|NoCurve| NO_TABLE)
}

const NO_TABLE: TooUneven = TooUneven {
    fluctuation: f32::INFINITY,
};

/// Coefficients of the parameter over the length from the middle, and half the length \[mm\].
fn table(curve: &PowerBasis) -> Result<([f64; COEFFICIENTS], f64), TooUneven> {
    let rates = collocate(curve).ok_or(NO_TABLE)?;
    let slope = interpolate(rates);
    let mut parameter = integral(&slope);
    // From these coefficients and no others, so that the ends are exact.
    let half_length = 1.0 / horner(&parameter, 1.0);
    for coefficient in &mut parameter {
        *coefficient *= half_length;
    }
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

/// Solves dv/ds = 1/|C′(v)| by Picard's iteration: 1/|C′| \[1/mm\] at the nodes, which are
/// spread over the length. Nothing if it does not settle or the curve has no speed.
fn collocate(curve: &PowerBasis) -> Option<[f64; COUNT]> {
    let mut parameters = NODES;
    for _ in 0..SWEEPS {
        let rates = parameters.map(|v| 1.0 / speed(curve, v));
        let integral_to = |row: &[f64; COUNT]| -> f64 { row.iter().zip(&rates).map(|(a, b)| a * b).sum() };
        let integrals = INTEGRALS.each_ref().map(integral_to);
        let half_length = 1.0 / integrals[COUNT - 1];
        if !half_length.is_normal() {
            return None;
        }
        let mut change = 0.0;
        for (v, integral) in parameters.iter_mut().zip(integrals) {
            // The curve is only known between its ends.
            let new = (half_length * integral).clamp(-1.0, 1.0);
            change = libm::fmax(change, libm::fabs(new - *v));
            *v = new;
        }
        if change <= SETTLED {
            return Some(rates);
        }
    }
    None
}

/// |dC/dv| \[mm\].
fn speed(curve: &PowerBasis, v: f64) -> f64 {
    curve.at(v).first.norm()
}

const fn integrals() -> [[f64; COUNT]; COUNT] {
    let mut integrals = [[0.0; COUNT]; COUNT];
    let mut j = 0;
    while j < COUNT {
        let mut values = [0.0; COUNT];
        values[j] = 1.0;
        let integral = integral(&interpolate(values));
        let mut i = 0;
        while i < COUNT {
            integrals[i][j] = horner(&integral, NODES[i]);
            i += 1;
        }
        j += 1;
    }
    integrals
}

/// Coefficients of the polynomial with these values at the nodes: divided differences, multiplied out.
const fn interpolate(values: [f64; COUNT]) -> [f64; COUNT] {
    let mut c = values;
    let mut level = 1;
    while level < COUNT {
        let mut i = COUNT - 1;
        while i >= level {
            c[i] = (c[i] - c[i - 1]) / (NODES[i] - NODES[i - level]);
            i -= 1;
        }
        level += 1;
    }
    let mut k = COUNT - 1;
    while k > 0 {
        k -= 1;
        let mut i = k;
        while i < COUNT - 1 {
            c[i] -= NODES[k] * c[i + 1];
            i += 1;
        }
    }
    c
}

/// Coefficients of the integral of a polynomial that is as much above 0 at 1 as below it at −1.
const fn integral(polynomial: &[f64; COUNT]) -> [f64; COEFFICIENTS] {
    let mut integral = [0.0; COEFFICIENTS];
    let mut power = 1;
    while power < COEFFICIENTS {
        integral[power] = polynomial[power - 1] / power as f64;
        if power % 2 == 0 {
            integral[0] -= integral[power];
        }
        power += 1;
    }
    integral
}

/// The value of a polynomial.
const fn horner(polynomial: &[f64], x: f64) -> f64 {
    let mut value = 0.0;
    let mut power = polynomial.len();
    while power > 0 {
        power -= 1;
        value = value * x + polynomial[power];
    }
    value
}
