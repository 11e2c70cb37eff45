//! Arcs as a program gives them: about an axis, evenly to another height, another radius, over any number of turns.

use curves::nurbs::Curve;
use nalgebra::Vector3;
use shared::geometry::{Moving, rotate};
use std::f64::consts::TAU;
use thiserror::Error;

/// Radii below this \[mm\] have no direction, and ends nearer than this, but for their radii, mean a full turn.
const SMALLEST: f64 = 1e-6;

/// Why there is no arc.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SpiralError {
    /// The axis has no direction.
    #[error("the axis of the arc is zero")]
    Axis,
    /// An end lies on the axis.
    #[error("the arc begins {start} mm and ends {end} mm from its axis; both must be above zero")]
    Radius {
        /// Radius at the start \[mm\].
        start: f64,
        /// Radius at the end \[mm\].
        end: f64,
    },
}

/// Radius and height go evenly with the angle; the angle \[rad\] is its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spiral {
    /// On the axis, as high as the start.
    centre: Vector3<f64>,
    axis: Vector3<f64>,
    /// Unit vector from the axis to the start.
    out: Vector3<f64>,
    radius: [f64; 2],
    rise: f64,
    sweep: f64,
}

impl Spiral {
    /// From `from` to `to` about the axis `normal` through `centre`: counter-clockwise with `turn` extra turns, or, if
    /// that is negative, clockwise with −1 − `turn` extra turns. Ends in one direction from the axis mean a full turn.
    pub fn new(
        from: Vector3<f64>,
        to: Vector3<f64>,
        centre: Vector3<f64>,
        normal: Vector3<f64>,
        turn: i32,
    ) -> Result<Self, SpiralError> {
        let length = normal.norm();
        if length < SMALLEST {
            return Err(SpiralError::Axis);
        }
        let clockwise = turn < 0;
        let extra = if clockwise { -1 - turn } else { turn };
        let axis = if clockwise { -normal } else { normal } / length;
        let across = |point: Vector3<f64>| {
            let arm = point - centre;
            arm - axis * arm.dot(&axis)
        };
        let (start, end) = (across(from), across(to));
        let radius = [start.norm(), end.norm()];
        if radius[0] < SMALLEST || radius[1] < SMALLEST {
            return Err(SpiralError::Radius {
                start: radius[0],
                end: radius[1],
            });
        }
        let angle = axis.dot(&start.cross(&end)).atan2(start.dot(&end));
        let part = if angle.abs() * radius[0] <= SMALLEST {
            TAU
        } else {
            angle.rem_euclid(TAU)
        };
        Ok(Self {
            centre: from - start,
            axis,
            out: start / radius[0],
            radius,
            rise: (to - from).dot(&axis),
            sweep: part + TAU * f64::from(extra),
        })
    }

    /// How the radius changes from start to end \[mm\].
    pub fn widening(&self) -> f64 {
        self.radius[1] - self.radius[0]
    }

    /// Angle from start to end \[rad\].
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// On the axis, as high as the start \[mm\].
    pub fn centre(&self) -> Vector3<f64> {
        self.centre
    }

    /// Unit axis; it goes right-handed about that.
    pub fn axis(&self) -> Vector3<f64> {
        self.axis
    }
}

impl Curve for Spiral {
    fn domain(&self) -> [f64; 2] {
        [0.0, self.sweep]
    }

    fn at(&self, angle: f64) -> Moving {
        let angle = angle.clamp(0.0, self.sweep);
        let out = rotate(&self.axis, angle, &self.out);
        let along = self.axis.cross(&out);
        let per_radian = self.widening() / self.sweep;
        let radius = self.radius[0] + per_radian * angle;
        let climb = self.axis * (self.rise / self.sweep);
        Moving {
            value: self.centre + out * radius + climb * angle,
            first: out * per_radian + along * radius + climb,
            second: along * (2.0 * per_radian) - out * radius,
        }
    }

    fn next_break(&self, _: f64) -> f64 {
        self.sweep
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counted_as_programs_count_them() {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let zero = Vector3::zeros();
        for (to, turn, quarters) in [
            (y, 0, 1.0),
            (y, 1, 5.0),
            (y, -1, 3.0),
            (y, -3, 11.0),
            (x, 0, 4.0),
            (x, -1, 4.0),
            (x, -5, 20.0),
            (x, 1, 8.0),
        ] {
            let spiral = Spiral::new(x, to, zero, z * 3.0, turn).expect("an arc");
            assert!((spiral.sweep() - quarters * TAU / 4.0).abs() < 1e-12, "{turn}");
            assert!((spiral.at(spiral.sweep()).value - to).norm() < 1e-12);
            let sense = spiral.at(0.0).first.dot(&y);
            assert_eq!(sense > 0.0, turn >= 0);
        }
        assert_eq!(Spiral::new(x, y, zero, zero, 0), Err(SpiralError::Axis));
        assert!(Spiral::new(x, zero, zero, z, 0).is_err());
    }

    #[test]
    fn radius_and_height_go_evenly() {
        let (from, to) = (Vector3::new(7.0, 2.0, 1.0), Vector3::new(2.0, 8.0, 5.0));
        let centre = Vector3::new(2.0, 2.0, 77.0);
        let spiral = Spiral::new(from, to, centre, Vector3::z(), 2).expect("an arc");
        assert!((spiral.at(spiral.sweep()).value - to).norm() < 1e-12);
        for i in 0..=10 {
            let part = f64::from(i) / 10.0;
            let u = spiral.sweep() * part;
            let point = spiral.at(u);
            let arm = point.value - centre;
            assert!((arm.xy().norm() - 5.0 - part).abs() < 1e-12);
            assert!((point.value.z - 1.0 - 4.0 * part).abs() < 1e-12);
            if (1..10).contains(&i) {
                let h = 1e-5;
                let (before, after) = (spiral.at(u - h), spiral.at(u + h));
                assert!(((after.value - before.value) / (2.0 * h) - point.first).norm() < 1e-8);
                assert!(((after.first - before.first) / (2.0 * h) - point.second).norm() < 1e-8);
            }
        }
    }
}
