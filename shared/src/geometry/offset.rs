//! Offset of a pose from another one.

use super::Pose;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// How far a pose stands beside another one, in the frame T, M, N of that: shifted along M and N, and turned about T
/// through its own D (mathematics 0.7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct PoseOffset {
    /// Along M, to the left of travel \[mm\].
    pub lateral_mm: f64,
    /// Along N, away from the work \[mm\].
    pub normal_mm: f64,
    /// About T, right-handed \[rad\].
    pub about_tangent_rad: f64,
}

impl PoseOffset {
    /// The pose itself.
    pub const NONE: Self = Self {
        lateral_mm: 0.0,
        normal_mm: 0.0,
        about_tangent_rad: 0.0,
    };

    /// From its three numbers, in their order.
    pub const fn of([lateral_mm, normal_mm, about_tangent_rad]: [f64; 3]) -> Self {
        Self {
            lateral_mm,
            normal_mm,
            about_tangent_rad,
        }
    }

    /// Its three numbers, in their order.
    pub const fn numbers(&self) -> [f64; 3] {
        [self.lateral_mm, self.normal_mm, self.about_tangent_rad]
    }

    /// The pose beside `pose`.
    pub fn beside(&self, pose: &Pose) -> Pose {
        let left = pose.lateral();
        let (s, c) = self.turn();
        Pose {
            position: pose.position + left * self.lateral_mm + pose.normal * self.normal_mm,
            tangent: pose.tangent,
            normal: pose.normal * c - left * s,
        }
    }

    /// This offset and then `next`, which is one of the pose that is already beside.
    pub fn then(&self, next: &Self) -> Self {
        let (s, c) = self.turn();
        let (m, n) = (next.lateral_mm, next.normal_mm);
        Self {
            lateral_mm: self.lateral_mm + m * c - n * s,
            normal_mm: self.normal_mm + m * s + n * c,
            about_tangent_rad: self.about_tangent_rad + next.about_tangent_rad,
        }
    }

    /// Velocity \[mm/s\] of a point at `from_tip` \[mm\] from D of `pose`, if this is a rate \[mm/s, rad/s\].
    pub fn velocity_at(&self, pose: &Pose, from_tip: &Vector3<f64>) -> Vector3<f64> {
        let tip = pose.lateral() * self.lateral_mm + pose.normal * self.normal_mm;
        tip + pose.tangent.cross(from_tip) * self.about_tangent_rad
    }

    fn turn(&self) -> (f64, f64) {
        let angle = self.about_tangent_rad;
        (libm::sin(angle), libm::cos(angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose() -> Pose {
        Pose::new(
            Vector3::new(1.0, 2.0, 3.0),
            Vector3::new(1.0, 0.2, -0.1),
            Vector3::new(0.1, 0.3, 1.0),
        )
        .unwrap()
    }

    #[test]
    fn two_offsets_in_a_row_are_one_and_the_pose_stays_one() {
        let (first, second) = (
            PoseOffset::of([1.5, -0.7, 0.3]),
            PoseOffset::of([-0.4, 2.0, -0.8]),
        );
        let twice = second.beside(&first.beside(&pose()));
        let once = first.then(&second).beside(&pose());
        assert!((twice.position - once.position).norm() < 1e-14);
        assert!((twice.normal - once.normal).norm() < 1e-15);
        assert!(once.normal.dot(&once.tangent).abs() < 1e-15 && (once.normal.norm() - 1.0).abs() < 1e-15);
        assert_eq!(PoseOffset::NONE.beside(&pose()), pose());
    }

    #[test]
    fn a_rate_moves_points_as_small_offsets_do() {
        let rate = PoseOffset::of([3.0, -2.0, 0.4]);
        let h = 1e-6;
        let step = PoseOffset::of(rate.numbers().map(|r| r * h));
        let moved = step.beside(&pose());
        // A point fixed to the tool, 4 mm along N and 2 mm along M of it.
        let point = |p: &Pose| p.position + p.normal * 4.0 + p.lateral() * 2.0;
        let from_tip = point(&pose()) - pose().position;
        let expected = (point(&moved) - point(&pose())) / h;
        assert!((rate.velocity_at(&pose(), &from_tip) - expected).norm() < 1e-5);
    }
}
