//! The speed: how the path length s goes with time, jerk-limited from rest to rest or to a stop.

use thiserror::Error;

/// Limits along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimits {
    /// Speed \[mm/s\].
    pub velocity: f64,
    /// Acceleration and deceleration \[mm/s²\].
    pub acceleration: f64,
    /// Jerk \[mm/s³\].
    pub jerk: f64,
}

/// Path length and its derivatives over time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedState {
    /// Path length \[mm\].
    pub s: f64,
    /// Path speed \[mm/s\].
    pub v: f64,
    /// Path acceleration \[mm/s²\].
    pub a: f64,
}

/// Why there is no profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SpeedError {
    /// A limit is zero, negative or not finite, or they are so far apart that no time comes out.
    #[error("the limits of speed, acceleration and jerk must be positive")]
    Limits,
    /// The end lies before the start, or a number is not finite, or the path is traversed backwards.
    #[error("the speed profile must go forward between finite path lengths")]
    Range,
}

/// A time of constant jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Segment {
    /// Time from the start of the profile.
    begin: f64,
    from: SpeedState,
    jerk: f64,
}

const SEGMENTS: usize = 7;

/// Speed and acceleration that count as none \[mm/s, mm/s²\].
const STILL: f64 = 1e-9;

/// s over time in at most seven segments of constant jerk, at rest at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedProfile {
    segments: [Segment; SEGMENTS],
    duration: f64,
    end: f64,
}

impl SpeedLimits {
    fn check(&self) -> Result<(), SpeedError> {
        let ok = |x: f64| x.is_finite() && x > 0.0;
        if ok(self.velocity) && ok(self.acceleration) && ok(self.jerk) {
            Ok(())
        } else {
            Err(SpeedError::Limits)
        }
    }
}

impl SpeedState {
    /// The state after a time `t` of constant `jerk`.
    fn after(&self, t: f64, jerk: f64) -> Self {
        Self {
            s: self.s + t * (self.v + t * (self.a / 2.0 + t * jerk / 6.0)),
            v: self.v + t * (self.a + t * jerk / 2.0),
            a: self.a + t * jerk,
        }
    }
}

impl SpeedProfile {
    /// From rest at `start` to rest at `end` \[mm\] in the shortest time the limits allow; `end` is reached
    /// exactly. A short way is done at less speed, a very short one at less acceleration.
    pub fn rest_to_rest(start: f64, end: f64, limits: &SpeedLimits) -> Result<Self, SpeedError> {
        limits.check()?;
        let length = end - start;
        if !(length.is_finite() && length >= 0.0) {
            return Err(SpeedError::Range);
        }
        let SpeedLimits {
            velocity,
            acceleration,
            jerk,
        } = *limits;
        // Ramp from rest to `peak`: jerk for `rise`, constant acceleration for `flat`, −jerk for `rise`.
        let ramp = |peak: f64| {
            let rise = libm::fmin(acceleration / jerk, libm::sqrt(peak / jerk));
            (rise, libm::fmax(peak / (jerk * rise) - rise, 0.0))
        };
        let (mut rise, mut flat) = ramp(velocity);
        let mut cruise = length / velocity - (2.0 * rise + flat);
        if cruise < 0.0 {
            cruise = 0.0;
            let t = acceleration / jerk;
            // Both ramps together take peak·(peak/acceleration + t) if the acceleration is reached at all.
            if length > 2.0 * acceleration * t * t {
                let peak = acceleration / 2.0 * (libm::sqrt(t * t + 4.0 * length / acceleration) - t);
                rise = t;
                flat = libm::fmax(peak / acceleration - t, 0.0);
            } else {
                rise = libm::cbrt(length / (2.0 * jerk));
                flat = 0.0;
            }
        }
        let from = SpeedState {
            s: start,
            v: 0.0,
            a: 0.0,
        };
        let profile = Self::from_segments(
            from,
            [
                (rise, jerk),
                (flat, 0.0),
                (rise, -jerk),
                (cruise, 0.0),
                (rise, -jerk),
                (flat, 0.0),
                (rise, jerk),
            ],
            Some(end),
        );
        // Limits that are finite each can be out of all proportion together.
        if profile.duration.is_finite() {
            Ok(profile)
        } else {
            Err(SpeedError::Limits)
        }
    }

    /// From any state to rest in the shortest time, never going backwards. `limits.velocity` plays no part.
    ///
    /// Where the state is already braking so hard that the jerk limit would carry it through zero, it is
    /// brought to rest with the one jerk that ends there exactly: that is the rest of the braking it was in.
    pub fn stop(from: SpeedState, limits: &SpeedLimits) -> Result<Self, SpeedError> {
        limits.check()?;
        let SpeedState { s, v, a } = from;
        // Rounding may leave a speed a hair below zero at the very end of a profile.
        if !(s.is_finite() && v.is_finite() && a.is_finite() && v > -1e-6) {
            return Err(SpeedError::Range);
        }
        let jerk = limits.jerk;
        if v <= STILL && a <= STILL {
            let from = SpeedState { s, v: 0.0, a: 0.0 };
            return Ok(Self::from_segments(from, [(0.0, 0.0); SEGMENTS], Some(s)));
        }
        let v = libm::fmax(v, 0.0);
        let from = SpeedState { s, v, a };
        let mut segments = [(0.0, 0.0); SEGMENTS];
        if a < 0.0 && v <= a * a / (2.0 * jerk) {
            segments[0] = (-2.0 * v / a, a * a / (2.0 * v));
        } else {
            // Down to −peak, hold it, back to zero.
            let limit = libm::fmax(limits.acceleration, -a);
            let peak = libm::fmin(libm::sqrt(jerk * v + a * a / 2.0), limit);
            let hold = (v + a * a / (2.0 * jerk) - peak * peak / jerk) / peak;
            segments[0] = (libm::fmax((a + peak) / jerk, 0.0), -jerk);
            segments[1] = (libm::fmax(hold, 0.0), 0.0);
            segments[2] = (peak / jerk, jerk);
        }
        Ok(Self::from_segments(from, segments, None))
    }

    /// Strings (time, jerk) together; the end is where they lead unless it is known exactly.
    fn from_segments(from: SpeedState, parts: [(f64, f64); SEGMENTS], end: Option<f64>) -> Self {
        let mut segments = [Segment::default(); SEGMENTS];
        let (mut begin, mut state) = (0.0, from);
        for (segment, (time, jerk)) in segments.iter_mut().zip(parts) {
            *segment = Segment {
                begin,
                from: state,
                jerk,
            };
            state = state.after(time, jerk);
            begin += time;
        }
        Self {
            segments,
            duration: begin,
            end: end.unwrap_or(state.s),
        }
    }

    /// The state a time `t` \[s\] after the start; at rest at [`Self::end`] from [`Self::duration`] on.
    pub fn at(&self, t: f64) -> SpeedState {
        if t >= self.duration {
            return SpeedState {
                s: self.end,
                v: 0.0,
                a: 0.0,
            };
        }
        let after = self
            .segments
            .iter()
            .skip(1)
            .take_while(|segment| segment.begin <= t)
            .count();
        let segment = &self.segments[after];
        segment
            .from
            .after(libm::fmax(t - segment.begin, 0.0), segment.jerk)
    }

    /// Time from start to rest \[s\].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Path length at rest \[mm\].
    pub fn end(&self) -> f64 {
        self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Goes through a profile in fine steps: never backwards, within the limits (relative tolerance 1e-6),
    /// and continuous in s and v.
    fn keeps_limits(profile: &SpeedProfile, limits: &SpeedLimits) -> Result<(), TestCaseError> {
        let steps = 4000;
        let dt = profile.duration() / f64::from(steps);
        let mut last = profile.at(0.0);
        for k in 1..=steps {
            let now = profile.at(dt * f64::from(k));
            prop_assert!(now.s >= last.s - 1e-9 && now.v >= -1e-6, "backwards: {now:?}");
            prop_assert!(now.v <= limits.velocity * (1.0 + 1e-6), "speed: {now:?}");
            prop_assert!(
                now.a.abs() <= limits.acceleration * (1.0 + 1e-6),
                "acceleration: {now:?}"
            );
            // Differences of a state that would jump if a segment did not fit the next.
            let slack = 1e-6 * limits.acceleration + 1e-9;
            prop_assert!(
                (now.a - last.a).abs() <= limits.jerk * dt * (1.0 + 1e-6) + slack,
                "jerk: {last:?} {now:?}"
            );
            let v = last.v + (last.a + now.a) / 2.0 * dt;
            prop_assert!(
                (now.v - v).abs() <= limits.jerk * dt * dt + 1e-6,
                "speed jumps: {last:?} {now:?}"
            );
            let s = last.s + (last.v + now.v) / 2.0 * dt;
            prop_assert!(
                (now.s - s).abs() <= limits.acceleration * dt * dt + 1e-6,
                "s jumps: {last:?} {now:?}"
            );
            last = now;
        }
        Ok(())
    }

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
        #[test]
        fn rest_to_rest_keeps_its_limits_and_ends_exactly(start in -1e3..1e3f64, length in length(), limits in limits()) {
            let end = start + length;
            let profile = SpeedProfile::rest_to_rest(start, end, &limits).unwrap();
            keeps_limits(&profile, &limits)?;
            prop_assert_eq!(profile.at(0.0), SpeedState { s: start, v: 0.0, a: 0.0 });
            prop_assert_eq!(profile.at(profile.duration()), SpeedState { s: end, v: 0.0, a: 0.0 });
            // What the segments add up to, not only what the end is set to.
            let almost = profile.at(profile.duration() * (1.0 - 1e-15));
            prop_assert!((almost.s - end).abs() < 1e-8 && almost.v.abs() < 1e-6, "{:?}", almost);
        }

        #[test]
        fn a_stop_anywhere_keeps_the_limits_and_never_passes_the_programmed_end(
            length in length(), limits in limits(), part in 0.0..1.0f64,
        ) {
            let profile = SpeedProfile::rest_to_rest(0.0, length, &limits).unwrap();
            let from = profile.at(part * profile.duration());
            let stop = SpeedProfile::stop(from, &limits).unwrap();
            keeps_limits(&stop, &limits)?;
            prop_assert!(stop.end() >= from.s && stop.end() <= length + 1e-8, "{} {}", stop.end(), length);
            prop_assert!(stop.duration() <= (1.0 - part) * profile.duration() + 1e-6);
            let almost = stop.at(stop.duration() * (1.0 - 1e-15));
            prop_assert!((almost.s - stop.end()).abs() < 1e-8 && almost.v.abs() < 1e-6, "{:?}", almost);
        }

        #[test]
        fn a_stop_gentler_than_the_braking_in_progress_still_never_goes_backwards(
            v in 0.0..400.0f64, a in -5000.0..5000.0f64, limits in limits(),
        ) {
            let stop = SpeedProfile::stop(SpeedState { s: 0.0, v, a }, &limits).unwrap();
            let mut last = 0.0;
            for k in 0..=1000 {
                let now = stop.at(stop.duration() * f64::from(k) / 1000.0);
                prop_assert!(now.v >= -1e-6 && now.s >= last - 1e-9, "{:?}", now);
                prop_assert!(now.a >= -limits.acceleration.max(-a) * (1.0 + 1e-9), "{:?}", now);
                last = now.s;
            }
        }
    }

    #[test]
    fn a_long_way_takes_the_time_of_the_textbook() {
        let limits = SpeedLimits {
            velocity: 100.0,
            acceleration: 500.0,
            jerk: 5000.0,
        };
        let profile = SpeedProfile::rest_to_rest(0.0, 400.0, &limits).unwrap();
        // v/a + a/j for each ramp, at half the speed on average: L/v + v/a + a/j.
        assert!((profile.duration() - (4.0 + 0.2 + 0.1)).abs() < 1e-12);
        assert_eq!(profile.at(2.0).v, 100.0);
    }

    #[test]
    fn nowhere_to_go_takes_no_time_and_backwards_is_refused() {
        let limits = SpeedLimits {
            velocity: 100.0,
            acceleration: 500.0,
            jerk: 5000.0,
        };
        let profile = SpeedProfile::rest_to_rest(7.0, 7.0, &limits).unwrap();
        assert_eq!((profile.duration(), profile.at(0.0).s), (0.0, 7.0));
        assert_eq!(
            SpeedProfile::rest_to_rest(7.0, 6.9, &limits),
            Err(SpeedError::Range)
        );
        assert_eq!(
            SpeedProfile::rest_to_rest(0.0, 1.0, &SpeedLimits { jerk: 0.0, ..limits }),
            Err(SpeedError::Limits)
        );
        let backwards = SpeedState {
            s: 0.0,
            v: -1.0,
            a: 0.0,
        };
        assert_eq!(SpeedProfile::stop(backwards, &limits), Err(SpeedError::Range));
    }
}
