//! How far measured values are from what they should be (mathematics 4.4).
//!
//! Errors of single coordinates contain timing; the distance to the path does not. The percentage error MAPE depends
//! on where the origin lies and explodes near it: it is here to be compared with published figures; judge by RMSE,
//! the largest error and the contour error.

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
    /// No path to compare with.
    #[error("the path has no points")]
    NoPath,
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

/// Size of errors, distances or deviations, in their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnitudes {
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
    /// Place of the largest among them, from 0.
    pub worst: usize,
}

impl Magnitudes {
    /// Of at least one value ≥ 0.
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut sum, mut squares, mut max, mut worst, mut count) = (0.0, 0.0, 0.0, 0, 0);
        for (index, value) in values.enumerate() {
            sum += value;
            squares += value * value;
            if value > max {
                (max, worst) = (value, index);
            }
            count = index + 1;
        }
        Self {
            mean: sum / count as f64,
            rms: libm::sqrt(squares / count as f64),
            max,
            worst,
        }
    }
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

/// The distances of all `measured` points \[mm\] from the polyline through `path`. The polyline itself must be
/// fine enough: its chords are off a curve of radius ρ by their length squared over 8ρ.
pub fn contour_error(measured: &[Vector3<f64>], path: &[Vector3<f64>]) -> Result<Magnitudes, MetricsError> {
    if measured.is_empty() {
        return Err(MetricsError::NothingMeasured);
    }
    if path.is_empty() {
        return Err(MetricsError::NoPath);
    }
    for (what, points) in [("measured point", measured), ("point of the path", path)] {
        if let Some(index) = points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(MetricsError::NotFinite { what, index });
        }
    }
    let distances = measured
        .iter()
        .filter_map(|point| distance_to_polyline(path, point));
    Ok(Magnitudes::of(distances))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_coordinates_contain_timing_and_the_contour_error_does_not() {
        // A point runs along a straight line at 45°, always 0.1 mm late and 0.01 mm beside it.
        let path = [Vector3::zeros(), Vector3::new(100.0, 100.0, 0.0)];
        let along = Vector3::new(0.5f64.sqrt(), 0.5f64.sqrt(), 0.0);
        let aside = Vector3::new(-along.y, along.x, 0.0);
        let wanted: Vec<_> = (10..130).map(|s| along * f64::from(s)).collect();
        let measured: Vec<_> = wanted.iter().map(|p| p - along * 0.1 + aside * 0.01).collect();
        let x = |points: &[Vector3<f64>]| points.iter().map(|p| p.x).collect::<Vec<f64>>();
        let in_x = compare(&x(&measured), &x(&wanted)).expect("figures");
        assert!((in_x.max - 0.11 * along.x).abs() < 1e-12, "{in_x:?}");
        let contour = contour_error(&measured, &path).expect("figures");
        assert!((contour.max - 0.01).abs() < 1e-12 && (contour.mean - 0.01).abs() < 1e-12);
    }

    #[test]
    fn the_worst_point_is_named() {
        let path = [Vector3::zeros(), Vector3::x()];
        let measured = [0.1, -0.3, 0.2].map(|y| Vector3::new(0.5, y, 0.0));
        let error = contour_error(&measured, &path).expect("figures");
        assert_eq!((error.max, error.worst), (0.3, 1));
        assert!((error.rms - (0.14f64 / 3.0).sqrt()).abs() < 1e-15);
    }

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
        let bad = [Vector3::zeros(), Vector3::x() * f64::NAN];
        assert_eq!(contour_error(&bad[..1], &[]), Err(MetricsError::NoPath));
        let what = "point of the path";
        assert_eq!(
            contour_error(&bad[..1], &bad),
            Err(MetricsError::NotFinite { what, index: 1 })
        );
    }
}
