//! Superimposed motion: an offset of the pose from the planned one, blended in slowly (mathematics 0.7).
//!
//! It comes after planner and output filter, which know nothing of it. A blend is a polynomial of fifth degree, so
//! that its acceleration is continuous and its jerk bounded, and takes so long that no axis gets more than
//! [`SHARE`] of its limits besides the plan, and the tip no more than [`SPEED`].

use crate::geometry::PoseOffset;
use crate::io::AXES;
use crate::kinematics::{AxisLimits, AxisMotion, Kinematics, KinematicsError};
use crate::ticks::PATH_PERIOD_S;

/// Part of the limits of an axis that a blend may take besides the plan; the drives have more to spare than that.
const SHARE: f64 = 0.05;
/// Highest speed of the tip by a blend alone \[mm/s\].
const SPEED: f64 = 5.0;
/// Shortest blend \[s\].
const SHORTEST_S: f64 = 0.5;
/// A blend slows down to a stand, and gets up to speed again, in this time \[s\].
const RAMP_S: f64 = 0.1;
/// Highest speed, acceleration and jerk of 10τ³ − 15τ⁴ + 6τ⁵ over τ in 0…1.
const PEAK: [f64; 3] = [1.875, 5.773_503, 60.0];

/// Where the pose is beside the plan, and on its way to where.
#[derive(Clone, Debug, PartialEq)]
pub struct Superimposed {
    from: PoseOffset,
    to: PoseOffset,
    /// Where to go next, once the present blend is over or stands.
    wanted: Option<PoseOffset>,
    now: PoseOffset,
    /// Rates of its three numbers \[1/s\].
    rate: [f64; 3],
    /// How long the present blend takes, and how far it has come \[s\].
    duration: f64,
    time: f64,
    /// 0 where the blend stands, 1 where it goes.
    pace: f64,
    /// What it added to the axes at the last tick, and how fast that changed.
    added: [f64; AXES],
    added_rate: [f64; AXES],
}

impl Superimposed {
    /// On the plan.
    pub const NONE: Self = Self {
        from: PoseOffset::NONE,
        to: PoseOffset::NONE,
        wanted: None,
        now: PoseOffset::NONE,
        rate: [0.0; 3],
        duration: 0.0,
        time: 0.0,
        pace: 0.0,
        added: [0.0; AXES],
        added_rate: [0.0; AXES],
    };

    /// The pose is on the plan and stays there.
    pub fn is_none(&self) -> bool {
        self.now == PoseOffset::NONE && self.to == PoseOffset::NONE && self.wanted.is_none()
    }

    /// A tick of it changes something: the pose is beside the plan, or just was.
    pub fn acts(&self) -> bool {
        !self.is_none() || self.added_rate != [0.0; AXES]
    }

    /// Where it is.
    pub fn now(&self) -> PoseOffset {
        self.now
    }

    /// It moves beside the plan.
    pub fn moves(&self) -> bool {
        self.rate != [0.0; 3]
    }

    /// How fast it does \[mm/s, rad/s\].
    pub fn rate(&self) -> [f64; 3] {
        self.rate
    }

    /// From now on go to `to`.
    pub fn want(&mut self, to: PoseOffset) {
        let heads_for = self.wanted.unwrap_or(self.to);
        if to != heads_for {
            self.wanted = Some(to);
        }
    }

    /// What the axes stand at by the plan, if they are at `axes` now.
    pub fn planned(&self, axes: &[f64; AXES]) -> [f64; AXES] {
        core::array::from_fn(|axis| axes[axis] - self.added[axis])
    }

    /// One path tick: the axes for the pose beside the one of `planned`. A blend continues only where the
    /// machine `goes` along its path.
    ///
    /// # Errors
    /// The machine cannot take the pose.
    pub fn step(
        &mut self,
        kinematics: &Kinematics,
        limits: &[AxisLimits; AXES],
        planned: &AxisMotion,
        goes: bool,
    ) -> Result<AxisMotion, KinematicsError> {
        let pose = kinematics.forward(&planned.position);
        let at = |offset: &PoseOffset| kinematics.inverse(&offset.beside(&pose), &planned.position);
        if !self.moves()
            && let Some(to) = self.wanted.take()
        {
            let (from, to_axes) = (at(&self.now)?, at(&to)?);
            let (shift, lift) = (
                to.lateral_mm - self.now.lateral_mm,
                to.normal_mm - self.now.normal_mm,
            );
            let tip = PEAK[0] * libm::hypot(shift, lift) / SPEED;
            self.duration = libm::fmax(tip, duration(limits, |axis| to_axes[axis] - from[axis]));
            (self.from, self.to, self.time) = (self.now, to, 0.0);
        }
        self.advance(goes && self.wanted.is_none());
        let position = if self.now == PoseOffset::NONE {
            planned.position
        } else {
            at(&self.now)?
        };
        let mut axes = *planned;
        for axis in 0..AXES {
            let added = position[axis] - planned.position[axis];
            let rate = (added - self.added[axis]) / PATH_PERIOD_S;
            axes.position[axis] = position[axis];
            axes.velocity[axis] += rate;
            axes.acceleration[axis] += (rate - self.added_rate[axis]) / PATH_PERIOD_S;
            (self.added[axis], self.added_rate[axis]) = (added, rate);
        }
        Ok(axes)
    }

    /// The blend continues by a tick.
    fn advance(&mut self, goes: bool) {
        let step = PATH_PERIOD_S / RAMP_S;
        self.pace = (self.pace + if goes { step } else { -step }).clamp(0.0, 1.0);
        if self.time >= self.duration {
            // Where nothing is left to do, the next blend begins from rest.
            (self.now, self.rate, self.pace) = (self.to, [0.0; 3], 0.0);
            return;
        }
        // Without a step in its own derivative.
        let pace = self.pace * self.pace * (3.0 - 2.0 * self.pace);
        self.time = (self.time + pace * PATH_PERIOD_S).min(self.duration);
        let tau = self.time / self.duration;
        let part = tau * tau * tau * (10.0 - 15.0 * tau + 6.0 * tau * tau);
        let part_rate = 30.0 * tau * tau * (1.0 - tau) * (1.0 - tau) * pace / self.duration;
        let (from, to) = (self.from.numbers(), self.to.numbers());
        let way: [f64; 3] = core::array::from_fn(|i| to[i] - from[i]);
        self.now = PoseOffset::of(core::array::from_fn(|i| from[i] + part * way[i]));
        self.rate = way.map(|way| way * part_rate);
    }
}

/// How long a blend takes that moves the axes by `way` \[s\].
fn duration(limits: &[AxisLimits; AXES], way: impl Fn(usize) -> f64) -> f64 {
    let mut longest = SHORTEST_S;
    for (axis, limits) in limits.iter().enumerate() {
        let way = libm::fabs(way(axis));
        let times = [
            PEAK[0] * way / (SHARE * limits.velocity),
            libm::sqrt(PEAK[1] * way / (SHARE * limits.acceleration)),
            libm::cbrt(PEAK[2] * way / (SHARE * limits.jerk)),
        ];
        longest = times.into_iter().fold(longest, libm::fmax);
    }
    longest
}
