//! What the axes of a machine touch, and the input that a touch closes.

use crate::config::TouchConfig;
use shared::io::{Bits, MOTOR_AXIS, MOTORS};

/// Axes that a body is told in: X, Y, Z.
const LINEAR: usize = 3;

impl TouchConfig {
    /// The inputs `process` with this one on while X, Y and Z stand inside a body, and off else; by the true positions of the motors
    /// that are there. Of two on an axis the mean counts, and an axis without a motor stands at 0.
    pub(crate) fn read(&self, mut process: Bits, positions: &[Option<f64>; MOTORS]) -> Bits {
        let mut sums = [(0.0, 0.0); LINEAR];
        for (position, axis) in positions.iter().zip(MOTOR_AXIS) {
            if let (Some(position), Some((sum, count))) = (position, sums.get_mut(axis)) {
                *sum += position;
                *count += 1.0;
            }
        }
        let at = sums.map(|(sum, count): (f64, f64)| sum / count.max(1.0));
        let touches = self.bodies.iter().any(|body| {
            let limits = body.from.into_iter().zip(body.to);
            at.into_iter()
                .zip(limits)
                .all(|(at, (from, to))| (from..=to).contains(&at))
        });
        process.set(usize::from(self.input).wrapping_sub(1), touches);
        process
    }
}
