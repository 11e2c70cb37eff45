//! A pose in motion: derivatives of the location data, and the angular velocity they mean.

use super::pose::{SHORTEST, length_across};
use super::{Pose, PoseError};
use nalgebra::Vector3;

/// Derivatives of a pose over time or over path length: velocity and acceleration of its point and its frame
/// (mm, rad; world frame).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMotion {
    /// Velocity of D.
    pub velocity: Vector3<f64>,
    /// Angular velocity ω of the frame.
    pub angular_velocity: Vector3<f64>,
    /// Acceleration of D.
    pub acceleration: Vector3<f64>,
    /// Angular acceleration α of the frame.
    pub angular_acceleration: Vector3<f64>,
}

impl PoseMotion {
    /// From derivatives over path length to derivatives over time, at path speed `v` \[mm/s\] and path
    /// acceleration `a` \[mm/s²\].
    pub fn at_speed(&self, v: f64, a: f64) -> Self {
        Self {
            velocity: self.velocity * v,
            angular_velocity: self.angular_velocity * v,
            acceleration: self.acceleration * (v * v) + self.velocity * a,
            angular_acceleration: self.angular_acceleration * (v * v) + self.angular_velocity * a,
        }
    }
}

/// A vector with its first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// The vector.
    pub value: Vector3<f64>,
    /// First derivative.
    pub first: Vector3<f64>,
    /// Second derivative.
    pub second: Vector3<f64>,
}

/// Makes a pose in motion of a position and two directions of any length: as [`Pose::new`], with the exact
/// derivatives of what it does.
///
/// With M = N × T and T, N made a frame: ω = T×Ṫ − T(Ṅ·M) (mathematics 0.3); α is its derivative. What the
/// given directions move along T and N only changes their lengths.
pub fn pose_in_motion(
    position: &Moving,
    tangent: &Moving,
    normal: &Moving,
) -> Result<(Pose, PoseMotion), PoseError> {
    // Not finite if a component is not.
    let sum = |v: &Moving| (v.value + v.first + v.second).sum();
    if !(sum(position) + sum(tangent) + sum(normal)).is_finite() {
        return Err(PoseError::NotFinite);
    }
    let length = tangent.value.norm();
    if length <= SHORTEST {
        return Err(PoseError::ZeroVector);
    }
    let per_length = 1.0 / length;
    let t = tangent.value * per_length;
    let lengthening = t.dot(&tangent.first);
    let t_1 = (tangent.first - t * lengthening) * per_length;
    // But for its part along T.
    let t_2 = (tangent.second - t_1 * (2.0 * lengthening)) * per_length;

    // The part of the normal perpendicular to T, which N has the direction of, is `normal` − T·`along`.
    let along = normal.value.dot(&t);
    let across = normal.value - t * along;
    let width = length_across(&normal.value, &across)?;
    let per_width = 1.0 / width;
    let n = across * per_width;
    let m = n.cross(&t);
    // Ṫ = M·yaw + N·pitch.
    let (yaw, pitch) = (t_1.dot(&m), t_1.dot(&n));
    let along_1 = normal.first.dot(&t) + normal.value.dot(&t_1);
    let widening = normal.first.dot(&n) - along * pitch;
    // Parts of Ṅ and N̈ along M.
    let n_1 = (normal.first.dot(&m) - along * yaw) * per_width;
    let n_2 = normal.second.dot(&m) - 2.0 * along_1 * yaw - along * t_2.dot(&m);
    let n_2 = (n_2 - 2.0 * widening * n_1) * per_width;
    let pose = Pose {
        position: position.value,
        tangent: t,
        normal: n,
    };
    let motion = PoseMotion {
        velocity: position.first,
        angular_velocity: t.cross(&t_1) - t * n_1,
        acceleration: position.second,
        // (Ṅ·M)˙ = N̈·M + Ṅ·Ṁ, and Ṅ·Ṁ = yaw·pitch.
        angular_acceleration: t.cross(&t_2) - t_1 * n_1 - t * (n_2 + yaw * pitch),
    };
    Ok((pose, motion))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vector of changing length and direction.
    fn along(t: f64, phase: f64) -> Vector3<f64> {
        Vector3::new(
            1.0 + t * t,
            libm::sin(2.0 * t + phase),
            0.5 - 0.3 * t * t * t + phase,
        )
    }

    fn moving(t: f64, phase: f64) -> Moving {
        Moving {
            value: along(t, phase),
            first: Vector3::new(2.0 * t, 2.0 * libm::cos(2.0 * t + phase), -0.9 * t * t),
            second: Vector3::new(2.0, -4.0 * libm::sin(2.0 * t + phase), -1.8 * t),
        }
    }

    fn at(t: f64) -> (Pose, PoseMotion) {
        pose_in_motion(&moving(t, 1.0), &moving(t, 0.0), &moving(t, 2.0)).unwrap()
    }

    /// The frame is that of the values, turns by ω, and ω changes by α, as differences see it.
    #[test]
    fn the_frame_of_changing_directions_has_exact_rates() {
        let h = 1e-5;
        for k in 0..20 {
            let t = f64::from(k) * 0.1 - 1.0;
            let (pose, motion) = at(t);
            let still = Pose::new(along(t, 1.0), along(t, 0.0), along(t, 2.0)).unwrap();
            assert!((pose.tangent - still.tangent).norm() < 1e-15);
            assert!((pose.normal - still.normal).norm() < 1e-15);
            let [before, after] = [at(t - h), at(t + h)];
            let omega = motion.angular_velocity;
            for (direction, before, after) in [
                (pose.tangent, before.0.tangent, after.0.tangent),
                (pose.normal, before.0.normal, after.0.normal),
            ] {
                let rate = (after - before) / (2.0 * h);
                assert!((omega.cross(&direction) - rate).norm() < 1e-7, "ω at {t}");
            }
            let alpha = (after.1.angular_velocity - before.1.angular_velocity) / (2.0 * h);
            assert!((motion.angular_acceleration - alpha).norm() < 1e-6, "α at {t}");
        }
    }

    #[test]
    fn a_motion_that_is_not_finite_or_without_a_frame_is_refused() {
        let (position, tangent, normal) = (moving(0.3, 1.0), moving(0.3, 0.0), moving(0.3, 2.0));
        let refused =
            |tangent: &Moving, normal: &Moving| pose_in_motion(&position, tangent, normal).unwrap_err();
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut other = normal;
            other.second.y = bad;
            assert_eq!(refused(&tangent, &other), PoseError::NotFinite);
            let mut other = tangent;
            other.value.z = bad;
            assert_eq!(refused(&other, &normal), PoseError::NotFinite);
        }
        let none = Moving {
            value: Vector3::zeros(),
            ..normal
        };
        assert_eq!(refused(&none, &normal), PoseError::ZeroVector);
        assert_eq!(refused(&tangent, &none), PoseError::ZeroNormal);
        assert_eq!(refused(&tangent, &tangent), PoseError::NormalParallelTangent);
    }
}
