//! The classic speed profile, for comparison: trapezoid of speed, sampled and smoothed by a moving mean
//! (mathematics 0.4.2). What the machines run is planned by the [`super::Planner`].

use super::SpeedState;
use thiserror::Error;

/// Why there is no trapezoid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum TrapezoidError {
    /// Speed or acceleration is not above zero, or a number is not finite.
    #[error("limits: a speed of {velocity} mm/s and an acceleration of {acceleration} mm/s² make no profile")]
    Limits {
        /// Speed \[mm/s\].
        velocity: f64,
        /// Acceleration \[mm/s²\].
        acceleration: f64,
    },
    /// The length is infinite or not a number.
    #[error("length: {length} mm is no length of a move")]
    Length {
        /// Length \[mm\].
        length: f64,
    },
    /// The sampling makes no sense.
    #[error("sampling: a period of {period} s and a mean over {window} samples are no filter")]
    Sampling {
        /// Period \[s\].
        period: f64,
        /// Samples under the mean.
        window: usize,
    },
}

/// Path length over time with constant acceleration, speed and deceleration, from rest to rest; without the
/// middle part if the length is short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    length: f64,
    peak: f64,
    acceleration: f64,
    ramp: f64,
    cruise: f64,
}

impl Trapezoid {
    /// The profile over `length` \[mm\] (nothing if it is not above zero) at most at `velocity` \[mm/s\] and
    /// with `acceleration` \[mm/s²\].
    pub fn build(length: f64, velocity: f64, acceleration: f64) -> Result<Self, TrapezoidError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !(positive(velocity) && positive(acceleration)) {
            return Err(TrapezoidError::Limits {
                velocity,
                acceleration,
            });
        }
        if !length.is_finite() {
            return Err(TrapezoidError::Length { length });
        }
        let length = length.max(0.0);
        let reach = velocity * velocity / acceleration;
        let (peak, cruise) = if reach > length {
            (libm::sqrt(acceleration * length), 0.0)
        } else {
            (velocity, (length - reach) / velocity)
        };
        Ok(Self {
            length,
            peak,
            acceleration,
            ramp: peak / acceleration,
            cruise,
        })
    }

    /// Length of the move \[mm\].
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Highest speed \[mm/s\].
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// Time of acceleration, and as long again of deceleration \[s\].
    pub fn ramp(&self) -> f64 {
        self.ramp
    }

    /// Time at constant speed \[s\].
    pub fn cruise(&self) -> f64 {
        self.cruise
    }

    /// Time from rest to rest \[s\].
    pub fn duration(&self) -> f64 {
        2.0 * self.ramp + self.cruise
    }

    /// Path length, speed and acceleration at the time `t` \[s\]; at rest before the start and after the end.
    pub fn at(&self, t: f64) -> SpeedState {
        let a = self.acceleration;
        let left = self.duration() - t;
        if t <= 0.0 {
            SpeedState::default()
        } else if left <= 0.0 {
            SpeedState {
                s: self.length,
                ..SpeedState::default()
            }
        } else if t < self.ramp {
            SpeedState {
                s: a * t * t / 2.0,
                v: a * t,
                a,
            }
        } else if left < self.ramp {
            SpeedState {
                s: self.length - a * left * left / 2.0,
                v: a * left,
                a: -a,
            }
        } else {
            SpeedState {
                s: self.peak * (t - self.ramp / 2.0),
                v: self.peak,
                a: 0.0,
            }
        }
    }
}

/// Samples of a trapezoid under a moving mean: continuous acceleration, jerk at most acceleration / (window ·
/// period), twice that where a move is too short to reach its speed, and the exact length at the end. Filtering
/// the length leaves the path as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothedTrapezoid {
    trapezoid: Trapezoid,
    period: f64,
    window: usize,
    /// Index of the sample that has reached the end.
    last: usize,
}

impl SmoothedTrapezoid {
    /// Samples `trapezoid` every `period` \[s\] and takes the mean over `window` of them.
    pub fn build(trapezoid: Trapezoid, period: f64, window: usize) -> Result<Self, TrapezoidError> {
        if !(period.is_finite() && period > 0.0) || window == 0 {
            return Err(TrapezoidError::Sampling { period, window });
        }
        Ok(Self {
            trapezoid,
            period,
            window,
            last: libm::ceil(trapezoid.duration() / period - 1e-9).max(0.0) as usize,
        })
    }

    /// Number of samples until the end is reached.
    pub fn samples(&self) -> usize {
        self.last + self.window
    }

    /// Path length of sample `k` \[mm\]: the mean of the samples k, k−1, … of the trapezoid.
    pub fn sample(&self, k: usize) -> f64 {
        let sampled = |i: usize| {
            if i >= self.last {
                self.trapezoid.length
            } else {
                self.trapezoid.at(i as f64 * self.period).s
            }
        };
        let sum: f64 = (0..self.window).map(|j| sampled(k.saturating_sub(j))).sum();
        sum / self.window as f64
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;
    use std::vec::Vec;

    /// A long, a short and no move.
    fn moves() -> [Trapezoid; 3] {
        [200.0, 0.5, 0.0].map(|length| Trapezoid::build(length, 40.0, 500.0).unwrap())
    }

    #[test]
    fn speed_and_acceleration_are_derivatives_within_the_limits() {
        for profile in moves() {
            let h = 1e-6;
            for i in 0..=1000 {
                let t = profile.duration() * f64::from(i) / 1000.0;
                let [before, now, after] = [t - h, t, t + h].map(|t| profile.at(t));
                // At a corner the mean of two accelerations, each at most 500, stands for the slope.
                assert!(((after.s - before.s) / (2.0 * h) - now.v).abs() < 500.0 * h + 1e-7);
                assert!((after.v - before.v).abs() < 1000.0 * h * (1.0 + 1e-6));
                assert!(now.v <= 40.0);
            }
            assert_eq!(profile.at(profile.duration()).s, profile.length());
            assert_eq!(profile.at(-1.0), SpeedState::default());
        }
    }

    #[test]
    fn smoothing_limits_the_jerk_and_keeps_the_end() {
        for profile in moves() {
            let (period, window) = (0.001, 20);
            let smoothed = SmoothedTrapezoid::build(profile, period, window).unwrap();
            let s: Vec<f64> = (0..smoothed.samples()).map(|k| smoothed.sample(k)).collect();
            assert_eq!(smoothed.sample(smoothed.samples() - 1), profile.length());
            for four in s.windows(4) {
                let jerk = (four[3] - 3.0 * four[2] + 3.0 * four[1] - four[0]) / (period * period * period);
                // Acceleration over the time of the mean, twice where a short move turns it round.
                assert!(
                    jerk.abs() <= 2.0 * 500.0 / (period * window as f64) * (1.0 + 1e-3),
                    "{jerk}"
                );
            }
        }
    }

    #[test]
    fn what_is_no_profile_is_refused_with_the_reason() {
        let refused = |trapezoid: Result<Trapezoid, TrapezoidError>| trapezoid.unwrap_err().to_string();
        assert!(refused(Trapezoid::build(1.0, 0.0, 9.0)).starts_with("limits: a speed of 0 mm/s"));
        assert!(refused(Trapezoid::build(1.0, 1.0, f64::NAN)).starts_with("limits"));
        assert!(refused(Trapezoid::build(f64::INFINITY, 1.0, 1.0)).starts_with("length"));
        for (period, window) in [(0.0, 5), (f64::NAN, 5), (0.001, 0)] {
            assert!(SmoothedTrapezoid::build(moves()[0], period, window).is_err());
        }
    }
}
