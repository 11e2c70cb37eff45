//! How far measured values are from what they should be (mathematics 4.4).
//!
//! Errors of single coordinates contain timing; the distance to the path does not. The percentage error MAPE
//! depends on the origin and has no bound near it: it is for comparison with published figures; judge by RMSE
//! and the largest error, and a contour by the distance to it.

use nalgebra::Vector3;
use thiserror::Error;

/// References nearer to zero have no percentage error.
const ZERO: f64 = 1e-9;

/// Why there are no figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MetricsError {
    /// Not one reference for each measured value.
    #[error("length: {measured} measured values against {reference} references")]
    Length {
        /// Number of measured values.
        measured: usize,
        /// Number of references.
        reference: usize,
    },
    /// Nothing to compare.
    #[error("nothing measured")]
    NothingMeasured,
    /// A value is infinite or not a number.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// What it is.
        what: &'static str,
        /// Its place, from 0.
        index: usize,
    },
}

/// Errors of measured values against their references, in the unit of the values unless in percent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorFigures {
    /// Mean absolute error.
    pub mae: f64,
    /// Root mean square error.
    pub rmse: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Mean absolute error relative to each reference \[%\]; `None` if every reference is zero.
    pub mape_percent: Option<f64>,
    /// Values with a reference other than zero, of which [`Self::mape_percent`] is the mean.
    pub mape_count: usize,
    /// Mean absolute error relative to the range of the references \[%\]; `None` if they are all equal.
    pub nmae_percent: Option<f64>,
}

/// The errors of `measured` against `reference`, value by value.
pub fn compare(measured: &[f64], reference: &[f64]) -> Result<ErrorFigures, MetricsError> {
    if measured.len() != reference.len() {
        return Err(MetricsError::Length {
            measured: measured.len(),
            reference: reference.len(),
        });
    }
    let mut comparison = Comparison::default();
    let pairs = measured.iter().zip(reference);
    pairs.for_each(|(measured, reference)| comparison.add(*measured, *reference));
    comparison.figures()
}

/// Errors of measured values against references, one after another: of any number of them.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    count: usize,
    sum: f64,
    squares: f64,
    max: f64,
    relative: f64,
    relative_count: usize,
    /// Of the references.
    least: f64,
    greatest: f64,
    /// Places of the first values that are not finite.
    bad_measured: Option<usize>,
    bad_reference: Option<usize>,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            count: 0,
            sum: 0.0,
            squares: 0.0,
            max: 0.0,
            relative: 0.0,
            relative_count: 0,
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            bad_measured: None,
            bad_reference: None,
        }
    }
}

impl Comparison {
    /// Adds a value.
    pub fn add(&mut self, measured: f64, reference: f64) {
        for (value, bad) in [
            (measured, &mut self.bad_measured),
            (reference, &mut self.bad_reference),
        ] {
            if !value.is_finite() {
                bad.get_or_insert(self.count);
            }
        }
        let error = libm::fabs(measured - reference);
        self.count += 1;
        self.sum += error;
        self.squares += error * error;
        self.max = self.max.max(error);
        if libm::fabs(reference) > ZERO {
            self.relative += libm::fabs((measured - reference) / reference);
            self.relative_count += 1;
        }
        self.least = self.least.min(reference);
        self.greatest = self.greatest.max(reference);
    }

    /// Number of values so far.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Of all values so far.
    ///
    /// # Errors
    /// There are none, or one of them is no number.
    pub fn figures(&self) -> Result<ErrorFigures, MetricsError> {
        if self.count == 0 {
            return Err(MetricsError::NothingMeasured);
        }
        let what = [
            ("measured value", self.bad_measured),
            ("reference", self.bad_reference),
        ];
        if let Some((what, index)) = what.into_iter().find_map(|(what, bad)| Some((what, bad?))) {
            return Err(MetricsError::NotFinite { what, index });
        }
        let mae = self.sum / self.count as f64;
        let range = self.greatest - self.least;
        Ok(ErrorFigures {
            mae,
            rmse: libm::sqrt(self.squares / self.count as f64),
            max: self.max,
            mape_percent: (self.relative_count > 0)
                .then(|| 100.0 * self.relative / self.relative_count as f64),
            mape_count: self.relative_count,
            nmae_percent: (range > 0.0).then_some(100.0 * mae / range),
        })
    }
}

/// Distance of `point` from the nearest place of a polyline, corners and ends included \[mm\]; `None` if the
/// polyline has no points. Segments without length count as points.
pub fn distance_to_polyline(polyline: &[Vector3<f64>], point: &Vector3<f64>) -> Option<f64> {
    let first = (point - polyline.first()?).norm_squared();
    let square = polyline
        .windows(2)
        .map(|pair| square_distance(&pair[0], &pair[1], point))
        .fold(first, f64::min);
    Some(libm::sqrt(square))
}

/// Squared distance of `point` from the segment `a`–`b`.
fn square_distance(a: &Vector3<f64>, b: &Vector3<f64>, point: &Vector3<f64>) -> f64 {
    let step = b - a;
    let length = step.norm_squared();
    let part = if length > 0.0 {
        ((point - a).dot(&step) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (point - a - step * part).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polyline_ends_at_its_ends_and_may_have_one_point_or_none() {
        let line = [Vector3::zeros(), Vector3::zeros(), Vector3::x()];
        let beyond = Vector3::new(4.0, 4.0, 0.0);
        assert_eq!(distance_to_polyline(&line, &beyond), Some(5.0));
        assert_eq!(distance_to_polyline(&line[..1], &Vector3::y()), Some(1.0));
        assert_eq!(distance_to_polyline(&[], &beyond), None);
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let values = [1.0, f64::NAN];
        let length = compare(&values, &values[..1]).unwrap_err();
        assert_eq!(
            length.to_string(),
            "length: 2 measured values against 1 references"
        );
        assert_eq!(
            compare(&values, &[1.0, 2.0]).unwrap_err().to_string(),
            "measured value 1 is not finite"
        );
        assert_eq!(compare(&[], &[]), Err(MetricsError::NothingMeasured));
    }
}
