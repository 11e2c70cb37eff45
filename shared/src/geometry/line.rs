//! Straight line over its length.

use super::Moving;
use nalgebra::Vector3;
use thiserror::Error;

/// Lines shorter than this \[mm\] have no direction.
const SHORTEST: f64 = 1e-9;

/// Why there is no line.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LineError {
    /// The ends coincide.
    #[error("zero length: the ends of the line are {length} mm apart; leave it out or move one of them")]
    ZeroLength {
        /// Distance of the ends \[mm\].
        length: f64,
    },
    /// A coordinate is infinite or not a number.
    #[error("not finite: a coordinate of the line is not a number")]
    NotFinite,
}

/// The straight line from a start to an end \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    start: Vector3<f64>,
    end: Vector3<f64>,
    tangent: Vector3<f64>,
    length: f64,
}

impl Line {
    /// The line from `start` to `end`.
    pub fn new(start: Vector3<f64>, end: Vector3<f64>) -> Result<Self, LineError> {
        let way = end - start;
        let length = way.norm();
        if !length.is_finite() {
            return Err(LineError::NotFinite);
        }
        if length <= SHORTEST {
            return Err(LineError::ZeroLength { length });
        }
        Ok(Self {
            start,
            end,
            tangent: way / length,
            length,
        })
    }

    /// Start \[mm\].
    pub fn start(&self) -> Vector3<f64> {
        self.start
    }

    /// End \[mm\].
    pub fn end(&self) -> Vector3<f64> {
        self.end
    }

    /// Direction of travel, length 1.
    pub fn tangent(&self) -> Vector3<f64> {
        self.tangent
    }

    /// Length \[mm\].
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Point \[mm\] and its derivatives over the length `s` \[mm\] gone; exactly the end at the full length.
    pub fn at(&self, s: f64) -> Moving {
        let part = s / self.length;
        Moving {
            value: self.start * (1.0 - part) + self.end * part,
            first: self.tangent,
            second: Vector3::zeros(),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_line_hits_both_ends_and_refuses_none() {
        let (a, b) = (Vector3::new(0.1, 0.7, -3.0), Vector3::new(10.3, -2.0, 1e-3));
        let line = Line::new(a, b).unwrap();
        assert_eq!(line.at(0.0).value, a);
        assert_eq!(line.at(line.length()).value, b);
        let step = line.at(5.0).value - line.at(4.0).value;
        assert!((step - line.at(4.5).first).norm() < 1e-14);
        let error = Line::new(a, a).unwrap_err();
        assert!(error.to_string().starts_with("zero length"));
        assert_eq!(Line::new(a, b * f64::NAN).unwrap_err(), LineError::NotFinite);
    }
}
