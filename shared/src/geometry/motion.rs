//! A pose in motion: derivatives of the location data, and the angular velocity they mean.

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

impl Moving {
    /// The vector at length 1, with its exact derivatives; `length` is its length.
    fn normalised(&self, length: f64) -> Self {
        // v = r·u, differentiated twice; u·u′ = 0 and u·u″ = −u′·u′.
        let per_length = 1.0 / length;
        let value = self.value * per_length;
        let r1 = value.dot(&self.first);
        let first = (self.first - value * r1) * per_length;
        let r2 = value.dot(&self.second) + length * first.dot(&first);
        let second = (self.second - value * r2 - first * (2.0 * r1)) * per_length;
        Self { value, first, second }
    }

    /// The part perpendicular to the unit vector `u`, with its exact derivatives.
    fn across(&self, u: &Self) -> Self {
        let c = self.value.dot(&u.value);
        let c1 = self.first.dot(&u.value) + self.value.dot(&u.first);
        let c2 = self.second.dot(&u.value) + 2.0 * self.first.dot(&u.first) + self.value.dot(&u.second);
        Self {
            value: self.value - u.value * c,
            first: self.first - u.value * c1 - u.first * c,
            second: self.second - u.value * c2 - u.first * (2.0 * c1) - u.second * c,
        }
    }
}

/// Angular velocity and acceleration of the frame whose unit vectors T and N move as given:
/// ω = T×Ṫ − T(Ṅ·M) (SPEC 0.3) and its derivative.
pub fn frame_rates(tangent: &Moving, normal: &Moving) -> (Vector3<f64>, Vector3<f64>) {
    let (t, n) = (tangent, normal);
    let m = n.value.cross(&t.value);
    let about_t = -n.first.dot(&m);
    // Ṁ = Ṅ×T + N×Ṫ, and Ṅ·(Ṅ×T) = 0.
    let about_t_1 = -n.second.dot(&m) - n.first.dot(&n.value.cross(&t.first));
    let omega = t.value.cross(&t.first) + t.value * about_t;
    let alpha = t.value.cross(&t.second) + t.first * about_t + t.value * about_t_1;
    (omega, alpha)
}

/// Makes a pose in motion of a position and two directions of any length: as [`Pose::new`], with the exact
/// derivatives of what it does.
pub fn pose_in_motion(
    position: &Moving,
    tangent: &Moving,
    normal: &Moving,
) -> Result<(Pose, PoseMotion), PoseError> {
    // Checks the values; the derivatives are finite if they are.
    let finite = |v: &Moving| v.first.iter().chain(v.second.iter()).all(|x| x.is_finite());
    if !(finite(position) && finite(tangent) && finite(normal)) {
        return Err(PoseError::NotFinite);
    }
    let pose = Pose::new(position.value, tangent.value, normal.value)?;
    let t = tangent.normalised(tangent.value.norm());
    let across = normal.across(&t);
    let n = across.normalised(across.value.norm());
    let (angular_velocity, angular_acceleration) = frame_rates(&t, &n);
    Ok((
        pose,
        PoseMotion {
            velocity: position.first,
            angular_velocity,
            acceleration: position.second,
            angular_acceleration,
        },
    ))
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

    /// Derivatives of the frame agree with differences of the frame.
    #[test]
    fn normalised_and_perpendicular_vectors_have_exact_derivatives() {
        let frame = |t: f64| {
            let tangent = moving(t, 0.0);
            let tangent = tangent.normalised(tangent.value.norm());
            let across = moving(t, 2.0).across(&tangent);
            (tangent, across.normalised(across.value.norm()))
        };
        let h = 1e-5;
        for k in 0..20 {
            let t = f64::from(k) * 0.1 - 1.0;
            let (before, now, after) = (frame(t - h), frame(t), frame(t + h));
            assert!(now.0.value.dot(&now.1.value).abs() < 1e-15);
            for (before, now, after) in [(before.0, now.0, after.0), (before.1, now.1, after.1)] {
                let first = (after.value - before.value) / (2.0 * h);
                let second = (after.first - before.first) / (2.0 * h);
                assert!((first - now.first).norm() < 1e-7, "first at {t}");
                assert!((second - now.second).norm() < 1e-7, "second at {t}");
            }
        }
    }
}
