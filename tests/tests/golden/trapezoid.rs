//! The classic speed profile: trapezoid of speed, sampled and smoothed by a moving mean (mathematics 0.4.2). What the
//! machines run is planned by [`shared::trajectory::Planner`].

use shared::trajectory::SpeedState;

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
    pub fn build(length: f64, velocity: f64, acceleration: f64) -> Self {
        let length = length.max(0.0);
        let reach = velocity * velocity / acceleration;
        let (peak, cruise) = if reach > length {
            ((acceleration * length).sqrt(), 0.0)
        } else {
            (velocity, (length - reach) / velocity)
        };
        Self {
            length,
            peak,
            acceleration,
            ramp: peak / acceleration,
            cruise,
        }
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
    pub fn build(trapezoid: Trapezoid, period: f64, window: usize) -> Self {
        Self {
            trapezoid,
            period,
            window,
            last: (trapezoid.duration() / period - 1e-9).ceil().max(0.0) as usize,
        }
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
