//! A way from rest to rest, limited in jerk.

use super::{SpeedLimits, SpeedState};

/// s over time from rest at 0 to rest at a length: up to the highest speed that the limits and the length allow, and
/// down as it came up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestToRest {
    length: f64,
    limits: SpeedLimits,
    /// Highest speed \[mm/s\].
    peak: f64,
    /// Time of the way up, and of all \[s\].
    rise: f64,
    duration: f64,
}

impl RestToRest {
    /// Over `length` \[mm\], not below 0, inside `limits`, all above 0.
    pub fn new(length: f64, limits: &SpeedLimits) -> Self {
        let peak = libm::fmin(limits.velocity, limits.reach(length / 2.0));
        let rise = limits.rise(peak);
        let steady = if peak > 0.0 {
            libm::fmax(length / peak - rise, 0.0)
        } else {
            0.0
        };
        Self {
            length,
            limits: *limits,
            peak,
            rise,
            duration: 2.0 * rise + steady,
        }
    }

    /// Time from rest to rest \[s\].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The state a time `t` \[s\] after the start; at rest at the end from [`Self::duration`] on.
    pub fn at(&self, t: f64) -> SpeedState {
        let left = self.duration - t;
        if left <= 0.0 {
            SpeedState::at_rest(self.length)
        } else if t < self.rise {
            self.limits.rising(self.peak, libm::fmax(t, 0.0))
        } else if left < self.rise {
            // The way down is the way up, seen from its end.
            let up = self.limits.rising(self.peak, left);
            SpeedState {
                s: self.length - up.s,
                v: up.v,
                a: -up.a,
            }
        } else {
            SpeedState {
                s: self.peak * (t - self.rise / 2.0),
                v: self.peak,
                a: 0.0,
            }
        }
    }
}

impl SpeedLimits {
    /// Way from rest to the speed, or from it to rest \[mm\].
    pub fn ramp(&self) -> f64 {
        self.velocity / 2.0 * self.rise(self.velocity)
    }

    /// Time of the jerk at each end of the way up to `peak` \[s\].
    fn jerking(&self, peak: f64) -> f64 {
        libm::fmin(self.acceleration / self.jerk, libm::sqrt(peak / self.jerk))
    }

    /// Time from rest to `peak` \[s\]: jerk, constant acceleration if it is reached, jerk.
    fn rise(&self, peak: f64) -> f64 {
        let jerking = self.jerking(peak);
        if jerking > 0.0 {
            peak / (self.jerk * jerking) + jerking
        } else {
            0.0
        }
    }

    /// Highest speed that can be reached from rest within `length` \[mm/s\].
    fn reach(&self, length: f64) -> f64 {
        let full = self.acceleration / self.jerk;
        if length < self.acceleration * full * full {
            let jerking = libm::cbrt(length / self.jerk);
            return self.jerk * jerking * jerking;
        }
        // Way: v²/2a + v·a/2j, solved without cancellation.
        let half = self.acceleration * full / 2.0;
        let rest = 2.0 * self.acceleration * length;
        rest / (half + libm::sqrt(half * half + rest))
    }

    /// The state a time `t` after rest, on the way up to `peak`.
    fn rising(&self, peak: f64, t: f64) -> SpeedState {
        let jerk = self.jerk;
        let jerking = self.jerking(peak);
        let left = self.rise(peak) - t;
        if t < jerking {
            SpeedState {
                s: jerk * t * t * t / 6.0,
                v: jerk * t * t / 2.0,
                a: jerk * t,
            }
        } else if left < jerking {
            SpeedState {
                s: peak / 2.0 * (t + left) - left * (peak - jerk * left * left / 6.0),
                v: peak - jerk * left * left / 2.0,
                a: jerk * left,
            }
        } else {
            let (a, flat) = (jerk * jerking, t - jerking);
            let v = a * jerking / 2.0;
            SpeedState {
                s: jerking * a * jerking / 6.0 + flat * (v + a * flat / 2.0),
                v: v + a * flat,
                a,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;

    fn limits() -> impl Strategy<Value = SpeedLimits> {
        (0.1..400.0f64, 1.0..5000.0f64, 10.0..200_000.0f64).prop_map(|(velocity, acceleration, jerk)| {
            SpeedLimits {
                velocity,
                acceleration,
                jerk,
            }
        })
    }

    /// Lengths from a micrometre to metres, small ones as often as large ones.
    fn length() -> impl Strategy<Value = f64> {
        (-3.0..4.0f64).prop_map(|exponent| libm::pow(10.0, exponent))
    }

    proptest! {
        /// In fine steps: never backwards, within the limits (relative tolerance 1e-6), continuous in s, v and a.
        #[test]
        fn limits_are_kept_and_the_end_is_met(length in length(), limits in limits()) {
            let way = RestToRest::new(length, &limits);
            let dt = way.duration() / 4000.0;
            let mut last = way.at(0.0);
            prop_assert_eq!(last, SpeedState::at_rest(0.0));
            for k in 1..=4000 {
                let now = way.at(dt * f64::from(k));
                prop_assert!(now.s >= last.s - 1e-9 && now.v >= -1e-6, "backwards: {:?}", now);
                prop_assert!(now.v <= limits.velocity * (1.0 + 1e-6), "speed: {:?}", now);
                prop_assert!(now.a.abs() <= limits.acceleration * (1.0 + 1e-6), "acceleration: {:?}", now);
                let jerk = limits.jerk * dt * (1.0 + 1e-6) + 1e-6 * limits.acceleration + 1e-9;
                prop_assert!((now.a - last.a).abs() <= jerk, "jerk: {:?} {:?}", last, now);
                let v = last.v + (last.a + now.a) / 2.0 * dt;
                prop_assert!((now.v - v).abs() <= limits.jerk * dt * dt + 1e-6, "v: {:?} {:?}", last, now);
                let s = last.s + (last.v + now.v) / 2.0 * dt;
                prop_assert!((now.s - s).abs() <= limits.acceleration * dt * dt + 1e-6, "s: {:?} {:?}", last, now);
                last = now;
            }
            prop_assert_eq!(way.at(way.duration()), SpeedState::at_rest(length));
            // What the parts add up to, not only what the end is set to.
            let almost = way.at(way.duration() * (1.0 - 1e-15));
            prop_assert!((almost.s - length).abs() < 1e-8 && almost.v.abs() < 1e-6, "{:?}", almost);
        }
    }

    #[test]
    fn a_long_way_takes_the_time_of_the_textbook_and_none_takes_none() {
        let limits = SpeedLimits {
            velocity: 100.0,
            acceleration: 500.0,
            jerk: 5000.0,
        };
        let way = RestToRest::new(400.0, &limits);
        // v/a + a/j for each ramp, at half the speed on average: L/v + v/a + a/j.
        assert!((way.duration() - (4.0 + 0.2 + 0.1)).abs() < 1e-12);
        assert_eq!(way.at(2.0).v, 100.0);
        let none = RestToRest::new(0.0, &limits);
        assert_eq!((none.duration(), none.at(0.0)), (0.0, SpeedState::at_rest(0.0)));
    }

    /// Half of the way of two ramps is at speed.
    #[test]
    fn a_ramp_is_as_long_as_that_of_the_way() {
        for velocity in [9.6, 20.0, 60.0] {
            let limits = SpeedLimits {
                velocity,
                acceleration: 400.0,
                jerk: 8000.0,
            };
            let way = RestToRest::new(2.0 * limits.ramp(), &limits);
            let middle = way.at(way.duration() / 2.0);
            let off = (middle.s - limits.ramp()).abs();
            assert!(off < 1e-9 && (middle.v - velocity).abs() < 1e-6, "{middle:?}");
        }
    }
}
