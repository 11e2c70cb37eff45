//! What makes a NURBS valid (mathematics 3.1).

use super::MAX_DEGREE;
use nalgebra::Vector3;
use thiserror::Error;

/// Why control points, weights and knots are not a curve. Everything is counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NurbsError {
    /// A curve of degree k ≥ 1 needs at least k + 1 control points.
    #[error("too few control points: {points} for degree {degree}; degree k ≥ 1 needs at least k + 1")]
    TooFewPoints {
        /// Control points given.
        points: usize,
        /// Degree given.
        degree: usize,
    },
    /// The degree is above [`MAX_DEGREE`].
    #[error("degree {degree} is too high: at most {MAX_DEGREE} is supported, so reduce it in the CAD system")]
    DegreeTooHigh {
        /// Degree given.
        degree: usize,
    },
    /// Not as many knots as control points + degree + 1.
    #[error("knot count: {knots} given, but these control points and this degree need {wanted}")]
    KnotCount {
        /// Knots given.
        knots: usize,
        /// Knots needed.
        wanted: usize,
    },
    /// A knot is infinite or not a number.
    #[error("knot {index} is not finite")]
    KnotNotFinite {
        /// Which knot.
        index: usize,
    },
    /// A knot is smaller than the one before it.
    #[error("knots decrease: knot {index} is {value}, less than the one before it")]
    KnotsDecrease {
        /// Which knot.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Not one weight for each control point.
    #[error("weights: {weights} given for {points} control points")]
    WeightCount {
        /// Weights given.
        weights: usize,
        /// Control points given.
        points: usize,
    },
    /// A weight is zero, negative, infinite or not a number.
    #[error("weights: weight {index} is {value}, but every weight must be finite and above zero")]
    Weight {
        /// Which weight.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A coordinate of a control point is infinite or not a number.
    #[error("control point {index} is not finite")]
    PointNotFinite {
        /// Which control point.
        index: usize,
    },
    /// A knot is repeated so often that the curve falls apart there, or the start or end too often to matter.
    #[error(
        "knot multiplicity: knot {index} at {value} occurs {count} times, at most {most} are allowed there"
    )]
    KnotMultiplicity {
        /// First of the equal knots.
        index: usize,
        /// Their value.
        value: f64,
        /// How many there are.
        count: usize,
        /// How many there may be: the degree inside, one more at the ends of the domain.
        most: usize,
    },
    /// The domain has no length.
    #[error("empty domain: it begins and ends at knot value {at}")]
    EmptyDomain {
        /// Where it begins and ends.
        at: f64,
    },
}

/// Checks in the order of mathematics 3.1.
pub(super) fn validate(
    degree: usize,
    points: &[Vector3<f64>],
    weights: &[f64],
    knots: &[f64],
) -> Result<(), NurbsError> {
    check_degree(degree, points.len())?;
    let wanted = points.len() + degree + 1;
    if knots.len() != wanted {
        return Err(NurbsError::KnotCount {
            knots: knots.len(),
            wanted,
        });
    }
    if let Some(index) = knots.iter().position(|u| !u.is_finite()) {
        return Err(NurbsError::KnotNotFinite { index });
    }
    if let Some(before) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(NurbsError::KnotsDecrease {
            index: before + 1,
            value: knots[before + 1],
        });
    }
    check_points(points, weights)?;
    let [first, last] = [knots[degree], knots[points.len()]];
    let mut index = 0;
    for equal in knots.chunk_by(|a, b| a == b) {
        let (value, count) = (equal[0], equal.len());
        let inside = first < value && value < last;
        let most = if inside { degree } else { degree + 1 };
        if count > most {
            return Err(NurbsError::KnotMultiplicity {
                index,
                value,
                count,
                most,
            });
        }
        index += count;
    }
    if first < last {
        Ok(())
    } else {
        Err(NurbsError::EmptyDomain { at: first })
    }
}

/// 1 ≤ degree ≤ [`MAX_DEGREE`], and enough points for it.
pub(super) fn check_degree(degree: usize, points: usize) -> Result<(), NurbsError> {
    if degree < 1 || points <= degree {
        return Err(NurbsError::TooFewPoints { points, degree });
    }
    if degree > MAX_DEGREE {
        return Err(NurbsError::DegreeTooHigh { degree });
    }
    Ok(())
}

/// One positive weight for each point, and all of it finite.
pub(super) fn check_points(points: &[Vector3<f64>], weights: &[f64]) -> Result<(), NurbsError> {
    if weights.len() != points.len() {
        return Err(NurbsError::WeightCount {
            weights: weights.len(),
            points: points.len(),
        });
    }
    if let Some(index) = weights.iter().position(|&w| !(w.is_finite() && w > 0.0)) {
        return Err(NurbsError::Weight {
            index,
            value: weights[index],
        });
    }
    match points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(index) => Err(NurbsError::PointNotFinite { index }),
        None => Ok(()),
    }
}
