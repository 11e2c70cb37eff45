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
    #[error("a radius of curvature is zero or more, not {0} mm")]
    Radius(f64),
    /// The window's lower speed is above its upper one.
    #[error("the process window from {low} to {high} mm/s is empty: exchange its ends")]
    Empty {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// No planned speeds, or not as many of them as path lengths.
    #[error("{speeds} speeds planned at {places} places: there must be one for each, and at least one")]
    Count {
        /// Places on the path.
        places: usize,
        /// Speeds planned.
        speeds: usize,
    },
    /// A planned speed is negative or not a number.
    #[error("the speed planned at point {index} is {value} mm/s, but must be zero or more")]
    Speed {
        /// Which point, from 0.
        index: usize,
        /// What is planned.
        value: f64,
    },
    /// A path length is not finite or below the one before it.
    #[error("the path length goes back at point {index}, to {value} mm")]
    Order {
        /// Which point, from 0.
        index: usize,
        /// Its path length.
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
            return Err(WindowError::Count { places: 0, speeds: 0 });
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

/// Lowers `speeds` \[mm/s\] at the path lengths `s` \[mm\] until none needs more than `acceleration` \[mm/s²\]
/// from its neighbours, beginning at `start` and ending at `end` \[mm/s\] or less: v² changes by at most 2aΔs.
///
/// Places may coincide; their speeds then become equal.
pub fn limit_acceleration(
    s: &[f64],
    speeds: &mut [f64],
    acceleration: f64,
    start: f64,
    end: f64,
) -> Result<(), WindowError> {
    positive(acceleration)?;
    let n = speeds.len();
    if n == 0 || s.len() != n {
        return Err(WindowError::Count {
            places: s.len(),
            speeds: n,
        });
    }
    for (index, &value) in s.iter().enumerate() {
        if !value.is_finite() || index > 0 && value < s[index - 1] {
            return Err(WindowError::Order { index, value });
        }
    }
    for (index, &value) in speeds.iter().enumerate() {
        check_speed(index, value)?;
    }
    check_speed(0, start)?;
    check_speed(n - 1, end)?;
    speeds[0] = libm::fmin(speeds[0], start);
    speeds[n - 1] = libm::fmin(speeds[n - 1], end);
    let reachable = |from: f64, way: f64| libm::sqrt(from * from + 2.0 * acceleration * way);
    for i in 1..n {
        speeds[i] = libm::fmin(speeds[i], reachable(speeds[i - 1], s[i] - s[i - 1]));
    }
    for i in (1..n).rev() {
        speeds[i - 1] = libm::fmin(speeds[i - 1], reachable(speeds[i], s[i] - s[i - 1]));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::string::ToString;
    use std::vec::Vec;

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
        assert_eq!(
            window(4.0, 16.0).apply(&mut []),
            Err(WindowError::Count { places: 0, speeds: 0 })
        );
        let nan = window(4.0, 16.0).apply(&mut [1.0, f64::NAN]).unwrap_err();
        assert_eq!(
            nan.to_string(),
            "the speed planned at point 1 is NaN mm/s, but must be zero or more"
        );
        let passes =
            |s: &[f64], v: &[f64], a: f64, end: f64| limit_acceleration(s, &mut v.to_vec(), a, 0.0, end);
        assert_eq!(passes(&[0.0, 1.0], &[1.0, 1.0], 10.0, 0.0), Ok(()));
        assert_eq!(
            passes(&[0.0, 1.0], &[1.0], 10.0, 0.0),
            Err(WindowError::Count { places: 2, speeds: 1 })
        );
        assert_eq!(
            passes(&[], &[], 10.0, 0.0),
            Err(WindowError::Count { places: 0, speeds: 0 })
        );
        assert_eq!(
            passes(&[0.0, 2.0, 1.0], &[1.0; 3], 10.0, 0.0),
            Err(WindowError::Order { index: 2, value: 1.0 })
        );
        assert_eq!(passes(&[0.0], &[1.0], -1.0, 0.0), Err(WindowError::Limit(-1.0)));
        assert_eq!(
            passes(&[0.0, 1.0], &[1.0; 2], 1.0, -2.0),
            Err(WindowError::Speed {
                index: 1,
                value: -2.0
            })
        );
    }

    proptest! {
        #[test]
        fn acceleration_stays_in_its_limit_and_speeds_are_only_lowered_where_it_needs(
            steps in prop::collection::vec((prop_oneof![Just(0.0), 0.0..5.0f64], 0.0..100.0f64), 1..40),
            acceleration in 1.0..1000.0f64, start in 0.0..20.0f64, end in 0.0..20.0f64,
        ) {
            let mut s = Vec::new();
            for (step, _) in &steps {
                s.push(s.last().unwrap_or(&0.0) + step);
            }
            let planned: Vec<f64> = steps.iter().map(|step| step.1).collect();
            let mut v = planned.clone();
            limit_acceleration(&s, &mut v, acceleration, start, end).unwrap();
            let n = v.len();
            prop_assert!(v[0] <= start && v[n - 1] <= end);
            for i in 0..n {
                prop_assert!(v[i] <= planned[i] && v[i] >= 0.0);
                let change = |j: usize| v[i] * v[i] - v[j] * v[j] - 2.0 * acceleration * (s[i] - s[j]).abs();
                let neighbours = [i.checked_sub(1), (i + 1 < n).then_some(i + 1)];
                let changes: Vec<f64> = neighbours.into_iter().flatten().map(change).collect();
                prop_assert!(changes.iter().all(|c| *c <= 1e-9));
                // Lowered only if a neighbour or an end asks for it.
                let asked = [(0, start), (n - 1, end)].iter().any(|&(j, limit)| j == i && v[i] == limit);
                prop_assert!(v[i] == planned[i] || asked || changes.iter().any(|c| *c >= -1e-9));
            }
            let once = v.clone();
            limit_acceleration(&s, &mut v, acceleration, start, end).unwrap();
            prop_assert!(once.iter().zip(&v).all(|(a, b)| (a - b).abs() < 1e-9));
        }
    }
}
