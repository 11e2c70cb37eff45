//! Parameters between which a curve is straight enough (mathematics 3.6).

use super::curve::{Curve, spans};
use heapless::Vec;
use nalgebra::Vector3;
use shared::geometry::angle;
use thiserror::Error;

/// How fine a curve is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretisation {
    /// Largest distance \[mm\] of the curve from its chord, seen at a quarter, a half and three quarters.
    pub tolerance: f64,
    /// Largest turn \[rad\] of the tangent within a chord.
    pub max_turn: f64,
    /// Longest chord \[mm\].
    pub max_chord: f64,
}

/// Why a curve was not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum DiscretiseError {
    /// A limit is below 1e-9.
    #[error("tolerance, turn and chord of a discretisation must be 1e-9 (mm, rad) or more")]
    Limits,
    /// A span is so large that halving does not get from it to parts fine enough.
    #[error("the curve or its knots are too large to be discretised: scale them")]
    Depth,
}

/// An interval of the parameter that is not cut any more.
const FINEST: f64 = 1e-9;

/// A stretch of curve within this distance \[mm\] is a point, as where control points coincide: its tangent is
/// rounding. Also the least that limits \[mm, rad\] can be.
const AT_REST: f64 = 1e-9;

/// Halvings of a span.
const DEPTH: usize = 64;

impl Discretisation {
    /// Whether the chord from `x` to `y` is good enough.
    fn accepts<C: Curve>(&self, curve: &C, x: f64, y: f64) -> bool {
        let (from, to) = (curve.at(x), curve.at(y));
        let between = [0.25, 0.5, 0.75].map(|part| curve.point(x + (y - x) * part));
        let rests = |point: &Vector3<f64>| (point - from.value).norm() <= AT_REST;
        if rests(&to.value) && between.iter().all(rests) {
            return true;
        }
        let flat = |point| distance_to_chord(point, &from.value, &to.value) <= self.tolerance;
        (to.value - from.value).norm() <= self.max_chord
            && angle(&from.first, &to.first) <= self.max_turn
            && between.iter().all(flat)
    }
}

/// Distance of a point from a chord, ends included.
fn distance_to_chord(point: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let (chord, offset) = (to - from, point - from);
    let square = chord.norm_squared();
    let part = if square > 0.0 {
        libm::fmin(libm::fmax(offset.dot(&chord) / square, 0.0), 1.0)
    } else {
        0.0
    };
    (offset - chord * part).norm()
}

/// Hands the parameters that cut `curve` as finely as asked to `accept`, in order, both ends included. Breaks
/// are always among them.
///
/// The tangent at a break is the one on its right. So at a kink, as degree 1 has at each control point, the
/// chords before it are halved until they are 1e-9 of the parameter long, about 30 of them.
pub fn discretise<C: Curve>(
    curve: &C,
    fineness: &Discretisation,
    mut accept: impl FnMut(f64),
) -> Result<(), DiscretiseError> {
    let Discretisation {
        tolerance,
        max_turn,
        max_chord,
    } = *fineness;
    if !(tolerance >= AT_REST && max_turn >= AT_REST && max_chord >= AT_REST) {
        return Err(DiscretiseError::Limits);
    }
    let [first, last] = curve.domain();
    accept(first);
    for span in spans(curve, first, last) {
        let mut stack: Vec<[f64; 2], DEPTH> = Vec::new();
        let mut next = Some(span);
        while let Some([x, y]) = next {
            if y - x <= FINEST || fineness.accepts(curve, x, y) {
                accept(y);
                next = stack.pop();
            } else {
                let middle = (x + y) / 2.0;
                stack.push([middle, y]).map_err(|_| DiscretiseError::Depth)?;
                next = Some([x, middle]);
            }
        }
    }
    Ok(())
}
