//! The output filter: a mean over the last milliseconds, which turns steps of acceleration into limited jerk.

use super::limits::MAX_FILTER;
use crate::io::AXES;
use crate::kinematics::AxisMotion;
use crate::trajectory::SpeedState;

/// Position, velocity and acceleration of the axes, and s, v and a.
type Values = [f64; 3 * AXES + 3];

/// A mean over a fixed number of ticks, the same for all, so that what moves together stays together.
///
/// It is linear: the mean of the velocities is the velocity of the mean.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    ring: [Values; MAX_FILTER],
    /// Sum over the ring.
    sum: Values,
    /// Sum of what was written since the last wrap; becomes `sum` at the next, so rounding cannot add up.
    fresh: Values,
    length: usize,
    /// One divided by it.
    per_length: f64,
    /// Where the oldest values are.
    head: usize,
}

impl Filter {
    pub const fn new() -> Self {
        let none = [0.0; 3 * AXES + 3];
        Self {
            ring: [none; MAX_FILTER],
            sum: none,
            fresh: none,
            length: 1,
            per_length: 1.0,
            head: 0,
        }
    }

    /// At rest for longer than it remembers.
    pub fn settle(&mut self, length: usize, axes: &AxisMotion, along: &SpeedState) {
        self.length = length.clamp(1, MAX_FILTER);
        self.per_length = 1.0 / self.length as f64;
        self.head = 0;
        let values = values(axes, along);
        self.ring[..self.length].fill(values);
        self.sum = values.map(|value| value * self.length as f64);
        self.fresh = values.map(|_| 0.0);
    }

    /// Takes the newest values.
    pub fn push(&mut self, axes: &AxisMotion, along: &SpeedState) {
        let values = values(axes, along);
        let oldest = &mut self.ring[self.head];
        for (i, value) in values.into_iter().enumerate() {
            self.sum[i] += value - oldest[i];
            self.fresh[i] += value;
        }
        *oldest = values;
        self.head += 1;
        if self.head >= self.length {
            self.head = 0;
            self.sum = self.fresh;
            self.fresh = [0.0; 3 * AXES + 3];
        }
    }

    /// Mean of the axes.
    pub fn axes(&self) -> AxisMotion {
        AxisMotion {
            position: self.mean(0),
            velocity: self.mean(AXES),
            acceleration: self.mean(2 * AXES),
        }
    }

    /// Mean along the path.
    pub fn along(&self) -> SpeedState {
        let [s, v, a] = self.mean(3 * AXES);
        SpeedState { s, v, a }
    }

    /// Mean of `N` values, from the one at `first` on.
    fn mean<const N: usize>(&self, first: usize) -> [f64; N] {
        core::array::from_fn(|i| self.sum[first + i] * self.per_length)
    }
}

fn values(axes: &AxisMotion, along: &SpeedState) -> Values {
    let mut values = [0.0; 3 * AXES + 3];
    values[..AXES].copy_from_slice(&axes.position);
    values[AXES..2 * AXES].copy_from_slice(&axes.velocity);
    values[2 * AXES..3 * AXES].copy_from_slice(&axes.acceleration);
    values[3 * AXES..].copy_from_slice(&[along.s, along.v, along.a]);
    values
}
