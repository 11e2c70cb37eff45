//! A stop on the path, as soon as the limits allow.

use super::{SpeedError, SpeedLimits, SpeedState};

/// A time of constant jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Segment {
    /// Time from the start of the profile.
    begin: f64,
    from: SpeedState,
    jerk: f64,
}

const SEGMENTS: usize = 3;

/// Speed and acceleration that count as none \[mm/s, mm/s²\].
const STILL: f64 = 1e-9;

/// s over time in at most three segments of constant jerk, at rest at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopProfile {
    segments: [Segment; SEGMENTS],
    duration: f64,
    end: f64,
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

impl StopProfile {
    /// From any state to rest in the shortest time, never going backwards. `limits.velocity` plays no part.
    ///
    /// Where the state is already braking so hard that the jerk limit would carry it through zero, it is
    /// brought to rest with the one jerk that ends there exactly: that is the rest of the braking it was in.
    pub fn build(from: SpeedState, limits: &SpeedLimits) -> Result<Self, SpeedError> {
        limits.check()?;
        let SpeedState { s, v, a } = from;
        // Rounding may leave a speed a hair below zero at the very end of a profile.
        if !(s.is_finite() && v.is_finite() && a.is_finite() && v > -1e-6) {
            return Err(SpeedError::Range);
        }
        let jerk = limits.jerk;
        let mut parts = [(0.0, 0.0); SEGMENTS];
        if v <= STILL && a <= STILL {
            return Ok(Self::of_parts(SpeedState { s, v: 0.0, a: 0.0 }, parts));
        }
        let v = libm::fmax(v, 0.0);
        if a < 0.0 && v <= a * a / (2.0 * jerk) {
            parts[0] = (-2.0 * v / a, a * a / (2.0 * v));
        } else {
            // Down to −peak, hold it, back to zero.
            let limit = libm::fmax(limits.acceleration, -a);
            let peak = libm::fmin(libm::sqrt(jerk * v + a * a / 2.0), limit);
            let hold = (v + a * a / (2.0 * jerk) - peak * peak / jerk) / peak;
            parts[0] = (libm::fmax((a + peak) / jerk, 0.0), -jerk);
            parts[1] = (libm::fmax(hold, 0.0), 0.0);
            parts[2] = (peak / jerk, jerk);
        }
        Ok(Self::of_parts(SpeedState { s, v, a }, parts))
    }

    /// Strings (time, jerk) together.
    fn of_parts(from: SpeedState, parts: [(f64, f64); SEGMENTS]) -> Self {
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
            end: state.s,
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
