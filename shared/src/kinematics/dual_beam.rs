//! The dual-beam gantry: X Y Z, then C, B, A (SPEC 0.2, 0.3).
//!
//! The order of the axes is X Y Z A B C everywhere, in mm and rad. The head turns about C (vertical, in the
//! ram), then B, then A, which is the direction of travel T: R = Rz(C)·Ry(B)·Rx(A), T = R·ex, N = R·ez.
//! Inside |B| ≤ 30° and |C| ≤ 90° the solution is unique and regular, so there is no branch to choose.

use super::{AxisLimits, AxisMotion, Chain, KinematicsError};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::{ParameterError, check};
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Geometry of the dual-beam gantry \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct DualBeamConfig {
    /// C axis to B axis, in the frame that turns with C.
    pub o1_mm: [f64; 3],
    /// B axis to A axis, in the frame after B.
    pub o2_mm: [f64; 3],
    /// A axis to the virtual tip D, in the plate frame: (tx, ty, −L).
    pub o3_mm: [f64; 3],
}

impl DualBeamConfig {
    /// Checks the geometry: every number finite, and the tip below the A axis. The solution is unique within
    /// any travel, so the limits of the axes do not matter.
    pub fn build(&self, _limits: &[AxisLimits; AXES]) -> Result<DualBeam, ParameterError> {
        let vector = |name, v: &[f64; 3]| -> Result<Vector3<f64>, ParameterError> {
            for &x in v {
                check("kinematics", name, x, |_| true)?;
            }
            Ok(Vector3::new(v[0], v[1], v[2]))
        };
        check("kinematics", "o3_mm", self.o3_mm[2], |z| z < 0.0)?;
        Ok(DualBeam {
            o1: vector("o1_mm", &self.o1_mm)?,
            o2: vector("o2_mm", &self.o2_mm)?,
            o3: vector("o3_mm", &self.o3_mm)?,
        })
    }
}

/// Kinematics of the dual-beam gantry, ready for the tick.
#[derive(Clone, Debug, PartialEq)]
pub struct DualBeam {
    o1: Vector3<f64>,
    o2: Vector3<f64>,
    o3: Vector3<f64>,
}

/// Sines and cosines of A, B, C: all that the segments and rates need.
struct Turn {
    sin_a: f64,
    cos_a: f64,
    sin_b: f64,
    cos_b: f64,
    sin_c: f64,
    cos_c: f64,
}

/// The three segments from the C axis to the tip, in the world frame.
struct Segments {
    r1: Vector3<f64>,
    r2: Vector3<f64>,
    r3: Vector3<f64>,
}

impl Turn {
    fn of_axes(q: &[f64; AXES]) -> Self {
        let (sin_a, cos_a) = libm::sincos(q[3]);
        let (sin_b, cos_b) = libm::sincos(q[4]);
        let (sin_c, cos_c) = libm::sincos(q[5]);
        Self {
            sin_a,
            cos_a,
            sin_b,
            cos_b,
            sin_c,
            cos_c,
        }
    }

    /// The same without any trigonometry: T and N hold the sines and cosines as products.
    fn of_pose(pose: &Pose) -> Result<Self, KinematicsError> {
        let t = &pose.tangent;
        let cos_b = libm::sqrt(t.x * t.x + t.y * t.y);
        if cos_b < 1e-9 {
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

    /// Rx(A)·v.
    fn about_a(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            v.x,
            self.cos_a * v.y - self.sin_a * v.z,
            self.sin_a * v.y + self.cos_a * v.z,
        )
    }

    /// Ry(B)·v.
    fn about_b(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_b * v.x + self.sin_b * v.z,
            v.y,
            -self.sin_b * v.x + self.cos_b * v.z,
        )
    }

    /// Rz(C)·v.
    fn about_c(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_c * v.x - self.sin_c * v.y,
            self.sin_c * v.x + self.cos_c * v.y,
            v.z,
        )
    }

    /// Rz(−C)·v.
    fn back_c(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.cos_c * v.x + self.sin_c * v.y,
            self.cos_c * v.y - self.sin_c * v.x,
            v.z,
        )
    }
}

impl DualBeam {
    fn segments(&self, turn: &Turn) -> Segments {
        Segments {
            r1: turn.about_c(&self.o1),
            r2: turn.about_c(&turn.about_b(&self.o2)),
            r3: turn.about_c(&turn.about_b(&turn.about_a(&self.o3))),
        }
    }

    fn position(pose: &Pose, turn: &Turn, segments: &Segments) -> [f64; AXES] {
        let p = pose.position - (segments.r1 + segments.r2 + segments.r3);
        [
            p.x,
            p.y,
            p.z,
            libm::atan2(turn.sin_a, turn.cos_a),
            libm::atan2(turn.sin_b, turn.cos_b),
            libm::atan2(turn.sin_c, turn.cos_c),
        ]
    }

    /// The closed forms of SPEC 0.3.
    fn motion(turn: &Turn, segments: &Segments, motion: &PoseMotion) -> ([f64; AXES], [f64; AXES]) {
        let (v, omega) = (&motion.velocity, &motion.angular_velocity);
        let (acc, alpha) = (&motion.acceleration, &motion.angular_acceleration);
        let Segments { r1, r2, r3 } = segments;
        let per_cos_b = 1.0 / turn.cos_b;
        let b_axis = Vector3::new(-turn.sin_c, turn.cos_c, 0.0);

        let w = turn.back_c(omega);
        let a_rate = w.x * per_cos_b;
        let b_rate = w.y;
        let c_rate = w.z + a_rate * turn.sin_b;
        let omega_1 = Vector3::new(0.0, 0.0, c_rate);
        let omega_2 = omega_1 + b_axis * b_rate;
        // ω_i × r_i is needed again for the centripetal parts.
        let (u1, u2, u3) = (omega_1.cross(r1), omega_2.cross(r2), omega.cross(r3));
        let p = v - (u1 + u2 + u3);

        let mut w = turn.back_c(alpha) - omega_1.cross(&w);
        w.x += a_rate * turn.sin_b * b_rate;
        let a_acc = w.x * per_cos_b;
        let b_acc = w.y;
        let c_acc = w.z + a_acc * turn.sin_b + a_rate * turn.cos_b * b_rate;
        let alpha_1 = Vector3::new(0.0, 0.0, c_acc);
        let alpha_2 = alpha_1 + b_axis * b_acc + omega_1.cross(&b_axis) * b_rate;
        let p_acc = acc
            - (alpha_1.cross(r1) + omega_1.cross(&u1))
            - (alpha_2.cross(r2) + omega_2.cross(&u2))
            - (alpha.cross(r3) + omega.cross(&u3));

        (
            [p.x, p.y, p.z, a_rate, b_rate, c_rate],
            [p_acc.x, p_acc.y, p_acc.z, a_acc, b_acc, c_acc],
        )
    }
}

impl Chain for DualBeam {
    const FITTED: [bool; AXES] = [true; AXES];

    /// Pose of the plate for axes `q` (SPEC 0.2).
    fn forward(&self, q: &[f64; AXES]) -> Pose {
        let turn = Turn::of_axes(q);
        let Segments { r1, r2, r3 } = self.segments(&turn);
        Pose {
            position: Vector3::new(q[0], q[1], q[2]) + r1 + r2 + r3,
            tangent: turn.about_c(&turn.about_b(&Vector3::x())),
            normal: turn.about_c(&turn.about_b(&Vector3::new(0.0, -turn.sin_a, turn.cos_a))),
        }
    }

    /// SPEC 0.2, steps 2 and 3; step 1 is [`Pose::new`]. The solution is unique, so `_near` does not matter.
    fn inverse(&self, pose: &Pose, _near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        let turn = Turn::of_pose(pose)?;
        let segments = self.segments(&turn);
        Ok(Self::position(pose, &turn, &segments))
    }

    fn derivatives(
        &self,
        q: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let turn = Turn::of_axes(q);
        let segments = self.segments(&turn);
        Ok(Self::motion(&turn, &segments, motion))
    }

    /// Three arc tangents and no other trigonometry.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        _near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let turn = Turn::of_pose(pose)?;
        let segments = self.segments(&turn);
        let (velocity, acceleration) = Self::motion(&turn, &segments, motion);
        Ok(AxisMotion {
            position: Self::position(pose, &turn, &segments),
            velocity,
            acceleration,
        })
    }
}
