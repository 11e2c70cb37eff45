//! Changes of speed.

use super::SpeedState;

/// Changes of speed with no acceleration at both ends: jerk, constant acceleration if it is reached, jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
}

impl Ramps {
    /// Time of the jerk at each end, for a change by `change`.
    fn rise(&self, change: f64) -> f64 {
        libm::fmin(
            self.acceleration / self.jerk,
            libm::sqrt(libm::fmax(change, 0.0) / self.jerk),
        )
    }

    /// Time of a change by `change`.
    pub(super) fn time(&self, change: f64) -> f64 {
        let rise = self.rise(change);
        if rise > 0.0 {
            change / (self.jerk * rise) + rise
        } else {
            0.0
        }
    }

    /// Way of a change between two speeds, in either direction.
    pub(super) fn length(&self, low: f64, high: f64) -> f64 {
        (low + high) / 2.0 * self.time(high - low)
    }

    /// The state a time `t` after the start of the way up from `low` to `high`, s from there.
    pub(super) fn at(&self, low: f64, high: f64, t: f64) -> SpeedState {
        let rise = self.rise(high - low);
        let left = self.time(high - low) - t;
        if t < rise {
            SpeedState {
                s: t * (low + self.jerk * t * t / 6.0),
                v: low + self.jerk * t * t / 2.0,
                a: self.jerk * t,
            }
        } else if left < rise {
            SpeedState {
                s: self.length(low, high) - left * (high - self.jerk * left * left / 6.0),
                v: high - self.jerk * left * left / 2.0,
                a: self.jerk * left,
            }
        } else {
            let (a, flat) = (self.jerk * rise, t - rise);
            let v = low + a * rise / 2.0;
            SpeedState {
                s: rise * (low + a * rise / 6.0) + flat * (v + a * flat / 2.0),
                v: v + a * flat,
                a,
            }
        }
    }

    /// `wanted`, or what of it can be reached from `from` within `length`; a lower speed is not looked at.
    pub(super) fn within_reach(&self, from: f64, wanted: f64, length: f64) -> f64 {
        if wanted <= from || self.length(from, wanted) <= length {
            wanted
        } else {
            self.reach(from, length)
        }
    }

    /// Highest speed that can be reached from `low` within `length`.
    fn reach(&self, low: f64, length: f64) -> f64 {
        let Self { acceleration, jerk } = *self;
        let rise = acceleration / jerk;
        let short = (2.0 * low + acceleration * rise) * rise;
        if length >= short {
            // Way: change²/2a + change·(low/a + rise/2) + low·rise, solved without cancellation.
            let half = low + acceleration * rise / 2.0;
            let rest = 2.0 * acceleration * (length - low * rise);
            return low + rest / (half + libm::sqrt(half * half + rest));
        }
        // Way: (2·low + j·x²)·x with the time x of the jerk. It is convex, so Newton from above never passes the
        // solution, and starts at most a factor of 1.5 off.
        let mut x = libm::fmin(libm::cbrt(length / jerk), length / (2.0 * low));
        for _ in 0..NEWTON_STEPS {
            x -= (x * (2.0 * low + jerk * x * x) - length) / (2.0 * low + 3.0 * jerk * x * x);
        }
        if x > 0.0 { low + jerk * x * x } else { low }
    }

    /// Highest speed, up to `limit`, that lies within reach of both ends of a stretch.
    pub(super) fn peak(&self, entry: f64, exit: f64, limit: f64, length: f64) -> f64 {
        let ways = |peak: f64| self.length(entry, peak) + self.length(exit, peak);
        let base = libm::fmax(entry, exit);
        if ways(limit) <= length {
            return limit;
        }
        // In the root x of what is above the base, the ways are convex again, and so Newton comes from above.
        let highest = libm::fmin(limit, self.reach(base, length));
        let mut x = libm::sqrt(libm::fmax(highest - base, 0.0));
        for _ in 0..MOST_NEWTON_STEPS {
            let peak = base + x * x;
            let excess = ways(peak) - length;
            if excess <= 0.0 {
                break;
            }
            let next = x - excess / (self.slope(entry, peak, x) + self.slope(exit, peak, x));
            // Below the last digits nothing moves any more.
            if !(next >= 0.0 && next < x) {
                x = libm::fmax(libm::fmin(next, x), 0.0);
                break;
            }
            x = next;
        }
        base + x * x
    }

    /// How the way from `low` to `peak` grows with x, of which peak is the square above a base.
    fn slope(&self, low: f64, peak: f64, x: f64) -> f64 {
        let change = peak - low;
        let rise = self.rise(change);
        // dT/dΔ is 1/(j·rise) with and without constant acceleration.
        let by_time = if rise > 0.0 {
            (low + peak) / 2.0 / (self.jerk * rise)
        } else {
            0.0
        };
        2.0 * x * (self.time(change) / 2.0 + by_time)
    }
}

/// Newton steps of a cubic equation from a start at most a factor of 1.5 off: the fifth is exact.
const NEWTON_STEPS: usize = 6;
/// Newton steps for a peak; a handful does, unless the ways nearly fill the stretch.
const MOST_NEWTON_STEPS: usize = 60;
