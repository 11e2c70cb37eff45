//! The attitude Rz(C)·Ry(B)·Rx(A): roll A, pitch B, yaw C, and their rates (mathematics 0.2, 0.3).
//!
//! Machines whose T and N determine all three angles share it. The attitude is held as sines and cosines: a pose
//! gives them without any trigonometry.

use super::KinematicsError;
use crate::geometry::Pose;
use nalgebra::Vector3;

/// cos B below which T stands along the C axis.
const LOCKED: f64 = 1e-9;

/// Sines and cosines of roll A, pitch B and yaw C.
#[derive(Clone, Copy, Debug)]
pub(super) struct RollPitchYaw {
    sin_a: f64,
    cos_a: f64,
    sin_b: f64,
    cos_b: f64,
    sin_c: f64,
    cos_c: f64,
}

/// First and second derivatives of roll, pitch and yaw.
pub(super) struct AngleMotion {
    pub(super) velocity: [f64; 3],
    pub(super) acceleration: [f64; 3],
}

/// What turning at `rate` about Z moves `r` by: ω×r.
pub(super) fn across_z(rate: f64, r: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-rate * r.y, rate * r.x, 0.0)
}

impl RollPitchYaw {
    pub(super) fn of_angles(a: f64, b: f64, c: f64) -> Self {
        let (sin_a, cos_a) = libm::sincos(a);
        let (sin_b, cos_b) = libm::sincos(b);
        let (sin_c, cos_c) = libm::sincos(c);
        Self {
            sin_a,
            cos_a,
            sin_b,
            cos_b,
            sin_c,
            cos_c,
        }
    }

    /// The solution with |B| < 90°: T and N hold the sines and cosines as products.
    pub(super) fn of_pose(pose: &Pose) -> Result<Self, KinematicsError> {
        let t = &pose.tangent;
        let cos_b = libm::sqrt(t.x * t.x + t.y * t.y);
        if cos_b < LOCKED {
            return Err(KinematicsError::GimbalLock);
        }
        let m_z = pose.normal.x * t.y - pose.normal.y * t.x;
        let per_cos_b = 1.0 / cos_b;
        Ok(Self {
            sin_a: m_z * per_cos_b,
            cos_a: pose.normal.z * per_cos_b,
            sin_b: -t.z,
            cos_b,
            sin_c: t.y * per_cos_b,
            cos_c: t.x * per_cos_b,
        })
    }

    /// A, B, C.
    pub(super) fn angles(&self) -> [f64; 3] {
        [
            libm::atan2(self.sin_a, self.cos_a),
            libm::atan2(self.sin_b, self.cos_b),
            libm::atan2(self.sin_c, self.cos_c),
        ]
    }

    /// T = R·ex.
    pub(super) fn tangent(&self) -> Vector3<f64> {
        self.about_c(&Vector3::new(self.cos_b, 0.0, -self.sin_b))
    }

    /// N = R·ez.
    pub(super) fn normal(&self) -> Vector3<f64> {
        self.about_c(&self.about_b(&Vector3::new(0.0, -self.sin_a, self.cos_a)))
    }

    /// The axis of B: Rz(C)·ey.
    pub(super) fn pitch_axis(&self) -> Vector3<f64> {
        Vector3::new(-self.sin_c, self.cos_c, 0.0)
    }

    /// Rx(A)·v.
    pub(super) fn about_a(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            v.x,
            self.cos_a * v.y - self.sin_a * v.z,
            self.sin_a * v.y + self.cos_a * v.z,
        )
    }

    /// Ry(B)·v.
    pub(super) fn about_b(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_b * v.x + self.sin_b * v.z,
            v.y,
            -self.sin_b * v.x + self.cos_b * v.z,
        )
    }

    /// Ry(−B)·v.
    pub(super) fn back_b(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_b * v.x - self.sin_b * v.z,
            v.y,
            self.sin_b * v.x + self.cos_b * v.z,
        )
    }

    /// Rz(C)·v.
    pub(super) fn about_c(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_c * v.x - self.sin_c * v.y,
            self.sin_c * v.x + self.cos_c * v.y,
            v.z,
        )
    }

    /// Rz(−C)·v.
    pub(super) fn back_c(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_c * v.x + self.sin_c * v.y,
            self.cos_c * v.y - self.sin_c * v.x,
            v.z,
        )
    }

    /// How the angles move where the attitude turns by ω and α (mathematics 0.3).
    pub(super) fn rates(
        &self,
        omega: &Vector3<f64>,
        alpha: &Vector3<f64>,
    ) -> Result<AngleMotion, KinematicsError> {
        if libm::fabs(self.cos_b) < LOCKED {
            return Err(KinematicsError::GimbalLock);
        }
        let per_cos_b = 1.0 / self.cos_b;

        let w = self.back_c(omega);
        let a_rate = w.x * per_cos_b;
        let b_rate = w.y;
        let c_rate = w.z + a_rate * self.sin_b;

        let mut w = self.back_c(alpha) - across_z(c_rate, &w);
        w.x += a_rate * self.sin_b * b_rate;
        let a_acc = w.x * per_cos_b;
        let b_acc = w.y;
        let c_acc = w.z + a_acc * self.sin_b + a_rate * self.cos_b * b_rate;
        Ok(AngleMotion {
            velocity: [a_rate, b_rate, c_rate],
            acceleration: [a_acc, b_acc, c_acc],
        })
    }
}
