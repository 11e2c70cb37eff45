//! Speed over a curved path under a process window (mathematics 3.3, 3.4).

use thiserror::Error;

/// What limits the speed on a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveLimits {
    /// Highest speed \[mm/s\], on a straight line too.
    pub velocity: f64,
    /// Interpolation period \[s\]: the chord of one is what the error is counted for.
    pub period: f64,
    /// Largest distance \[mm\] between the chord of one period and the curve.
    pub chord_error: f64,
    /// Largest acceleration \[mm/s²\] across the path.
    pub normal_acceleration: f64,
    /// Largest jerk \[mm/s³\] that constant speed on a circle may cause.
    pub normal_jerk: f64,
}

/// Speeds between which the process works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessWindow {
    /// Lowest speed \[mm/s\].
    pub low: f64,
    /// Highest speed \[mm/s\].
    pub high: f64,
}

/// What a process window made of planned speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowPlan {
    /// The one speed \[mm/s\] wanted everywhere.
    pub constant: f64,
    /// Points at which the machine cannot keep the lowest speed. Above zero the process window **is** violated
    /// there: warn, and let wire feed and power follow the true speed, or round the corner with a radius of at
    /// least low² / normal acceleration.
    pub n_below: usize,
}

/// Why there is no speed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WindowError {
    /// A limit of speed, acceleration, jerk, error or time is not above zero.
    #[error("limits of a speed plan must be finite and above zero, not {0}")]
    Limit(f64),
    /// A radius of curvature is negative or not a number.
    #[error("a radius of curvature must be zero or more, not {0} mm")]
    Radius(f64),
    /// The window's lower speed is above its upper one.
    #[error("the process window from {low} to {high} mm/s is empty: swap its ends")]
    Empty {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// No planned speeds.
    #[error("no speeds are planned: there must be at least one")]
    NoSpeeds,
    /// A planned speed is negative or not a number.
    #[error("the speed planned at point {index} is {value} mm/s, but must be zero or more")]
    Speed {
        /// Which point, from 0.
        index: usize,
        /// What is planned.
        value: f64,
    },
}

fn positive(value: f64) -> Result<f64, WindowError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(WindowError::Limit(value))
    }
}

fn check_speed(index: usize, value: f64) -> Result<(), WindowError> {
    if value >= 0.0 {
        Ok(())
    } else {
        Err(WindowError::Speed { index, value })
    }
}

impl CurveLimits {
    /// Highest speed \[mm/s\] where the radius of curvature is `radius` \[mm\]; infinite on a straight line.
    ///
    /// It is the least of the highest speed, (2/T)·√(2ρε − ε²) (at ε ≥ ρ: 2ρ/T), √(a·ρ) and ∛(j·ρ²).
    pub fn speed(&self, radius: f64) -> Result<f64, WindowError> {
        let velocity = positive(self.velocity)?;
        let period = positive(self.period)?;
        let error = positive(self.chord_error)?;
        let acceleration = positive(self.normal_acceleration)?;
        let jerk = positive(self.normal_jerk)?;
        if radius.is_nan() || radius < 0.0 {
            return Err(WindowError::Radius(radius));
        }
        let half_chord = if error >= radius {
            radius
        } else {
            libm::sqrt(error * (2.0 * radius - error))
        };
        let limits = [
            2.0 / period * half_chord,
            libm::sqrt(acceleration * radius),
            libm::cbrt(jerk * radius * radius),
        ];
        Ok(limits.into_iter().fold(velocity, libm::fmin))
    }
}

impl ProcessWindow {
    /// Makes one speed of the planned ones where the machine can: the lowest planned speed if the process works
    /// at it, at most the upper end; otherwise the lower end, or less where the machine cannot do that.
    pub fn apply(&self, planned: &mut [f64]) -> Result<WindowPlan, WindowError> {
        let (low, high) = (positive(self.low)?, positive(self.high)?);
        if low > high {
            return Err(WindowError::Empty { low, high });
        }
        if planned.is_empty() {
            return Err(WindowError::NoSpeeds);
        }
        for (index, &value) in planned.iter().enumerate() {
            check_speed(index, value)?;
        }
        let slowest = planned.iter().copied().fold(f64::INFINITY, libm::fmin);
        let constant = if slowest >= low {
            libm::fmin(slowest, high)
        } else {
            low
        };
        let n_below = planned.iter().filter(|&&v| v < low).count();
        for v in planned {
            *v = libm::fmin(*v, constant);
        }
        Ok(WindowPlan { constant, n_below })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: CurveLimits = CurveLimits {
        velocity: 16.0,
        period: 0.001,
        chord_error: 0.001,
        normal_acceleration: 100.0,
        normal_jerk: 1000.0,
    };

    #[test]
    fn a_straight_line_is_as_fast_as_the_machine_and_a_corner_stands_still() {
        assert_eq!(LIMITS.speed(f64::INFINITY), Ok(16.0));
        assert_eq!(LIMITS.speed(0.0), Ok(0.0));
    }

    #[test]
    fn each_limit_rules_where_it_is_the_least() {
        let most = CurveLimits {
            velocity: 1e9,
            period: 1e-9,
            chord_error: 1e9,
            normal_acceleration: 1e30,
            normal_jerk: 1e30,
        };
        let near = |limits: CurveLimits, radius: f64, v: f64| {
            assert!((limits.speed(radius).unwrap() / v - 1.0).abs() < 1e-12);
        };
        near(
            CurveLimits {
                normal_acceleration: 50.0,
                ..most
            },
            2.0,
            10.0,
        );
        near(
            CurveLimits {
                normal_jerk: 250.0,
                ..most
            },
            2.0,
            10.0,
        );
        // A chord of 6 in a circle of radius 5 is 1 away from it; one of 10 is as far as a chord can be.
        let sagitta = CurveLimits {
            period: 2.0,
            chord_error: 1.0,
            ..most
        };
        near(sagitta, 5.0, 3.0);
        near(
            CurveLimits {
                chord_error: 7.0,
                ..sagitta
            },
            5.0,
            5.0,
        );
    }

    #[test]
    fn what_makes_no_sense_is_an_error() {
        let limits = CurveLimits {
            period: 0.0,
            ..LIMITS
        };
        assert_eq!(limits.speed(1.0), Err(WindowError::Limit(0.0)));
        assert_eq!(LIMITS.speed(-1.0), Err(WindowError::Radius(-1.0)));
        assert!(LIMITS.speed(f64::NAN).is_err());
        let window = |low, high| ProcessWindow { low, high };
        assert_eq!(
            window(5.0, 4.0).apply(&mut [1.0]),
            Err(WindowError::Empty { low: 5.0, high: 4.0 })
        );
        assert_eq!(window(4.0, 16.0).apply(&mut []), Err(WindowError::NoSpeeds));
        let nan = window(4.0, 16.0).apply(&mut [1.0, f64::NAN]).unwrap_err();
        assert_eq!(
            nan.to_string(),
            "the speed planned at point 1 is NaN mm/s, but must be zero or more"
        );
    }
}
