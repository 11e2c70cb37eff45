//! The output filter: a mean over the last milliseconds, which turns steps of acceleration into limited jerk.

use super::limits::MAX_FILTER;
use crate::io::AXES;
use crate::kinematics::AxisMotion;
use crate::trajectory::SpeedState;

/// A mean over a fixed number of ticks, the same for all, so that what moves together stays together.
///
/// It is linear: the mean of the velocities is the velocity of the mean.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    position: Mean<AXES>,
    velocity: Mean<AXES>,
    acceleration: Mean<AXES>,
    /// s, v and a.
    along: Mean<3>,
    length: usize,
    /// One divided by it.
    per_length: f64,
    /// Where the oldest values are.
    head: usize,
}

/// Means of `N` values.
#[derive(Clone, Debug)]
struct Mean<const N: usize> {
    ring: [[f64; N]; MAX_FILTER],
    /// Sum over the ring.
    sum: [f64; N],
    /// Sum of what was written since the last wrap; becomes `sum` at the next, so rounding cannot add up.
    fresh: [f64; N],
}

impl Filter {
    pub const fn new() -> Self {
        Self {
            position: Mean::NONE,
            velocity: Mean::NONE,
            acceleration: Mean::NONE,
            along: Mean::NONE,
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
        self.position.settle(self.length, &axes.position);
        self.velocity.settle(self.length, &axes.velocity);
        self.acceleration.settle(self.length, &axes.acceleration);
        self.along.settle(self.length, &[along.s, along.v, along.a]);
    }

    /// Takes the newest values.
    pub fn push(&mut self, axes: &AxisMotion, along: &SpeedState) {
        let oldest = self.head;
        self.position.push(&axes.position, oldest);
        self.velocity.push(&axes.velocity, oldest);
        self.acceleration.push(&axes.acceleration, oldest);
        self.along.push(&[along.s, along.v, along.a], oldest);
        self.head += 1;
        if self.head >= self.length {
            self.head = 0;
            self.position.wrap();
            self.velocity.wrap();
            self.acceleration.wrap();
            self.along.wrap();
        }
    }

    /// Mean of the axes.
    pub fn axes(&self) -> AxisMotion {
        AxisMotion {
            position: self.position.mean(self.per_length),
            velocity: self.velocity.mean(self.per_length),
            acceleration: self.acceleration.mean(self.per_length),
        }
    }

    /// Mean along the path.
    pub fn along(&self) -> SpeedState {
        let [s, v, a] = self.along.mean(self.per_length);
        SpeedState { s, v, a }
    }
}

impl<const N: usize> Mean<N> {
    const NONE: Self = Self {
        ring: [[0.0; N]; MAX_FILTER],
        sum: [0.0; N],
        fresh: [0.0; N],
    };

    fn settle(&mut self, length: usize, values: &[f64; N]) {
        self.ring[..length].fill(*values);
        self.sum = values.map(|value| value * length as f64);
        self.fresh = [0.0; N];
    }

    /// Puts `values` in the place of the oldest.
    #[inline]
    fn push(&mut self, values: &[f64; N], oldest: usize) {
        let oldest = &mut self.ring[oldest];
        self.sum = core::array::from_fn(|i| self.sum[i] + (values[i] - oldest[i]));
        self.fresh = core::array::from_fn(|i| self.fresh[i] + values[i]);
        *oldest = *values;
    }

    /// Before the first place of the ring is written again.
    fn wrap(&mut self) {
        self.sum = self.fresh;
        self.fresh = [0.0; N];
    }

    fn mean(&self, per_length: f64) -> [f64; N] {
        self.sum.map(|sum| sum * per_length)
    }
}
