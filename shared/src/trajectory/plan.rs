//! The speed along a path with steps of its limit, jerk-limited from rest to rest.

use super::ramp::Ramps;
use super::{SpeedError, SpeedLimits, SpeedState};
use heapless::Vec;

/// From a path length on, at most this speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedStep {
    /// Path length \[mm\].
    pub s: f64,
    /// Speed \[mm/s\].
    pub velocity: f64,
}

/// A stretch with one limit of speed: from `entry` up to `peak`, on at `peak`, and down to the entry of the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Leg {
    /// Time from the start of the plan \[s\].
    begin: f64,
    /// Path length where it begins \[mm\].
    s: f64,
    /// Speed there; the acceleration is zero \[mm/s\].
    entry: f64,
    /// Highest speed \[mm/s\].
    peak: f64,
}

/// s over time from rest to rest, never faster than the limit in force: what slows down has done so where its
/// step begins, what speeds up begins there. There is room for `N` different limits.
///
/// At a step the acceleration is zero. A stretch too short for its speed is passed more slowly.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedPlan<const N: usize> {
    legs: Vec<Leg, N>,
    ramps: Ramps,
    duration: f64,
    end: f64,
}

impl<const N: usize> SpeedPlan<N> {
    /// At rest at 0.
    pub const fn new() -> Self {
        Self {
            legs: Vec::new(),
            ramps: Ramps {
                acceleration: 1.0,
                jerk: 1.0,
            },
            duration: 0.0,
            end: 0.0,
        }
    }

    /// A plan with one limit of speed.
    pub fn rest_to_rest(start: f64, end: f64, limits: &SpeedLimits) -> Result<Self, SpeedError> {
        let mut plan = Self::new();
        plan.plan(start, end, limits, core::iter::empty())?;
        Ok(plan)
    }

    /// Plans anew, from rest at `start` to rest at `end` \[mm\], which is reached exactly. `steps` are in order of
    /// s; before the first of them, `limits` has the speed. On an error the plan is one of no use: at rest at
    /// `start`.
    ///
    /// The work grows with the number of steps: at most some 1500 instructions each, a tenth of that where there
    /// is room for the ramps.
    pub fn plan(
        &mut self,
        start: f64,
        end: f64,
        limits: &SpeedLimits,
        steps: impl Iterator<Item = SpeedStep>,
    ) -> Result<(), SpeedError> {
        (self.duration, self.end) = (0.0, start);
        self.legs.clear();
        limits.check()?;
        let length = end - start;
        if !(length.is_finite() && length >= 0.0) {
            return Err(SpeedError::Range);
        }
        self.ramps = Ramps {
            acceleration: limits.acceleration,
            jerk: limits.jerk,
        };
        self.divide(start, end, limits.velocity, steps)?;
        self.pass_steps(end);
        let duration = self.time(end);
        // Limits that are finite each can be out of all proportion together.
        if !duration.is_finite() {
            self.legs.clear();
            return Err(SpeedError::Limits);
        }
        (self.duration, self.end) = (duration, end);
        Ok(())
    }

    /// Makes a leg of every stretch between `start` and `end` with a limit of its own, which it gets as its peak.
    fn divide(
        &mut self,
        start: f64,
        end: f64,
        velocity: f64,
        steps: impl Iterator<Item = SpeedStep>,
    ) -> Result<(), SpeedError> {
        let mut before = f64::NEG_INFINITY;
        let first = SpeedStep { s: start, velocity };
        self.take(first, end)?;
        for step in steps {
            let sound = step.s.is_finite() && step.velocity.is_finite() && step.velocity > 0.0;
            if !sound || step.s < before {
                self.legs.clear();
                return Err(SpeedError::Step);
            }
            before = step.s;
            self.take(step, end)?;
        }
        Ok(())
    }

    fn take(&mut self, step: SpeedStep, end: f64) -> Result<(), SpeedError> {
        let SpeedStep { s, velocity } = step;
        if s >= end {
            return Ok(());
        }
        // What does not lie beyond the last step takes its place.
        if let Some(last) = self.legs.last_mut().filter(|last| s <= last.s) {
            last.peak = velocity;
            return Ok(());
        }
        let leg = Leg {
            begin: 0.0,
            s,
            entry: 0.0,
            peak: velocity,
        };
        self.legs.push(leg).map_err(|_| {
            self.legs.clear();
            SpeedError::TooManySteps { capacity: N as u16 }
        })
    }

    /// Speed at every step: no higher than on both sides of it, and within reach of those before and after.
    fn pass_steps(&mut self, end: f64) {
        let ramps = self.ramps;
        let mut limit: f64 = 0.0;
        for leg in &mut self.legs {
            leg.entry = libm::fmin(limit, leg.peak);
            limit = leg.peak;
        }
        let (mut exit, mut stop) = (0.0, end);
        for leg in self.legs.iter_mut().rev() {
            leg.entry = ramps.within_reach(exit, leg.entry, stop - leg.s);
            (exit, stop) = (leg.entry, leg.s);
        }
        for i in 1..self.legs.len() {
            let (from, to) = (self.legs[i - 1], &mut self.legs[i]);
            to.entry = ramps.within_reach(from.entry, to.entry, to.s - from.s);
        }
    }

    /// Peaks that can be reached, and when every leg begins; returns when the last one ends.
    fn time(&mut self, end: f64) -> f64 {
        let ramps = self.ramps;
        let mut begin = 0.0;
        for i in 0..self.legs.len() {
            let next = self.legs.get(i + 1);
            let (stop, exit) = next.map_or((end, 0.0), |next| (next.s, next.entry));
            let leg = &mut self.legs[i];
            let length = stop - leg.s;
            leg.begin = begin;
            leg.peak = ramps.peak(leg.entry, exit, leg.peak, length);
            let on_ramps = ramps.length(leg.entry, leg.peak) + ramps.length(exit, leg.peak);
            let steady = libm::fmax(length - on_ramps, 0.0) / leg.peak;
            begin += ramps.time(leg.peak - leg.entry) + steady + ramps.time(leg.peak - exit);
        }
        begin
    }

    /// The state a time `t` \[s\] after the start; at rest at [`Self::end`] from [`Self::duration`] on.
    pub fn at(&self, t: f64) -> SpeedState {
        let t = libm::fmax(t, 0.0);
        let after = self.legs.partition_point(|leg| leg.begin <= t);
        let (Some(leg), true) = (
            after.checked_sub(1).map(|index| &self.legs[index]),
            t < self.duration,
        ) else {
            return SpeedState {
                s: self.end,
                v: 0.0,
                a: 0.0,
            };
        };
        let next = self.legs.get(after);
        let (stop, exit, end) = next.map_or((self.duration, 0.0, self.end), |next| {
            (next.begin, next.entry, next.s)
        });
        let (gone, left) = (t - leg.begin, stop - t);
        let up = self.ramps.time(leg.peak - leg.entry);
        if gone < up {
            let ramp = self.ramps.at(leg.entry, leg.peak, gone);
            SpeedState {
                s: leg.s + ramp.s,
                ..ramp
            }
        } else if left < self.ramps.time(leg.peak - exit) {
            // The way down is the way up, seen from its end.
            let ramp = self.ramps.at(exit, leg.peak, left);
            SpeedState {
                s: end - ramp.s,
                v: ramp.v,
                a: -ramp.a,
            }
        } else {
            SpeedState {
                s: leg.s + self.ramps.length(leg.entry, leg.peak) + leg.peak * (gone - up),
                v: leg.peak,
                a: 0.0,
            }
        }
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

impl<const N: usize> Default for SpeedPlan<N> {
    fn default() -> Self {
        Self::new()
    }
}
