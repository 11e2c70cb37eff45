//! Where the tool of a machine is whose axes are neither straight nor square.

use crate::config::GeometryConfig;
use shared::io::{AXES, MOTOR_AXIS, MOTORS};
use shared::kinematics::AXIS_UNIT;

/// Axes that stand at these positions of their motors: of two on an axis the mean counts, and an axis without a motor stands
/// at 0.
pub(crate) fn axes(positions: &[Option<f64>; MOTORS]) -> [f64; AXES] {
    let mut sums = [(0.0, 0.0); AXES];
    for (position, axis) in positions.iter().zip(MOTOR_AXIS) {
        if let Some(position) = position {
            let (sum, count): &mut (f64, f64) = &mut sums[axis];
            *sum += position;
            *count += 1.0;
        }
    }
    sums.map(|(sum, count)| sum / f64::max(count, 1.0))
}

impl GeometryConfig {
    /// Adds the error at `axes` to what the motors move, `positions` (mm, rad).
    pub(crate) fn add(&self, axes: &[f64; AXES], positions: &mut [Option<f64>; MOTORS]) {
        let (motor, axis) = (usize::from(self.motor), usize::from(self.axis));
        let (Some(Some(position)), Some(along)) = (positions.get_mut(motor), axes.get(axis)) else {
            return;
        };
        let along = along / AXIS_UNIT[axis];
        *position += AXIS_UNIT[MOTOR_AXIS[motor]] * (self.slope * along + self.wave.at(along));
    }
}
