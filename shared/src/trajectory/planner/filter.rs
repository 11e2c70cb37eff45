//! The output filter: a mean over the last milliseconds, which turns steps of acceleration into limited jerk.

use super::limits::MAX_FILTER;
use crate::io::AXES;
use crate::kinematics::AxisMotion;
use crate::trajectory::SpeedState;

/// Values that are filtered together: position, velocity and acceleration of the axes and along the path.
const VALUES: usize = 3 * AXES + 3;

/// A mean over a fixed number of ticks, the same for all, so that what moves together stays together.
///
/// It is linear: the mean of the velocities is the velocity of the mean.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    ring: [[f64; VALUES]; MAX_FILTER],
    /// Sum over the ring.
    sum: [f64; VALUES],
    /// Sum of what was written since the last wrap; becomes `sum` at the next, so rounding cannot add up.
    fresh: [f64; VALUES],
    length: usize,
    head: usize,
}

impl Filter {
    pub const fn new() -> Self {
        Self {
            ring: [[0.0; VALUES]; MAX_FILTER],
            sum: [0.0; VALUES],
            fresh: [0.0; VALUES],
            length: 1,
            head: 0,
        }
    }

    /// At rest for longer than it remembers.
    pub fn settle(&mut self, length: usize, axes: &AxisMotion, along: &SpeedState) {
        self.length = length.clamp(1, MAX_FILTER);
        self.head = 0;
        self.fresh = [0.0; VALUES];
        let values = pack(axes, along);
        self.ring[..self.length].fill(values);
        self.sum = values.map(|value| value * self.length as f64);
    }

    /// Takes the newest values, gives the means.
    pub fn push(&mut self, axes: &AxisMotion, along: &SpeedState) -> (AxisMotion, SpeedState) {
        let values = pack(axes, along);
        let oldest = &mut self.ring[self.head];
        for i in 0..VALUES {
            self.sum[i] += values[i] - oldest[i];
            self.fresh[i] += values[i];
        }
        *oldest = values;
        self.head += 1;
        if self.head >= self.length {
            self.head = 0;
            self.sum = self.fresh;
            self.fresh = [0.0; VALUES];
        }
        let per_length = 1.0 / self.length as f64;
        unpack(&self.sum.map(|sum| sum * per_length))
    }
}

fn pack(axes: &AxisMotion, along: &SpeedState) -> [f64; VALUES] {
    let mut values = [0.0; VALUES];
    values[..AXES].copy_from_slice(&axes.position);
    values[AXES..2 * AXES].copy_from_slice(&axes.velocity);
    values[2 * AXES..3 * AXES].copy_from_slice(&axes.acceleration);
    values[3 * AXES..].copy_from_slice(&[along.s, along.v, along.a]);
    values
}

fn unpack(values: &[f64; VALUES]) -> (AxisMotion, SpeedState) {
    let part = |from: usize| core::array::from_fn(|axis| values[from + axis]);
    let axes = AxisMotion {
        position: part(0),
        velocity: part(AXES),
        acceleration: part(2 * AXES),
    };
    let along = SpeedState {
        s: values[3 * AXES],
        v: values[3 * AXES + 1],
        a: values[3 * AXES + 2],
    };
    (axes, along)
}
