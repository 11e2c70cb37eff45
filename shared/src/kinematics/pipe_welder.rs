//! The pipe-intersection welder: radial X, axial Z, torch tilt B, waist C (mathematics 1.3).
//!
//! Work frame: the branch pipe's, z along its axis Z_S, with the machine clamped around it. The arm stands at the
//! waist angle C from x; e_r = (cosC, sinC, 0) points outwards along it and e_θ = (−sinC, cosC, 0) along the weld.
//! The tilt axis is parallel to e_θ, at radius X and height Z. The torch tilts by B, the elevation of its axis:
//!
//! N = cosB·e_r + sinB·ez, T = e_θ, P = (X − torch·cosB)·e_r + (Z − torch·sinB)·ez.
//!
//! Four axes realise P and the part of N in the plane of e_r and ez; the part along e_θ is left out. P on the axis
//! of the pipe is the pole of C.

use super::tool_axis::{POLE, POLE_RATE, axis_in_motion};
use super::{AxisLimits, AxisMotion, Chain, KinematicsError};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::{LARGEST_MACHINE_MM, ParameterError, within};
use crate::units::next_to;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

const B: usize = 4;
const C: usize = 5;

/// Geometry of the pipe welder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct PipeWelderConfig {
    /// Tilt axis to the torch's tip \[mm\]; 0 where the torch tilts about its tip.
    pub torch_mm: f64,
}

impl PipeWelderConfig {
    /// Axis of its joint of this number, from the work to the tool.
    pub fn joint(&self, number: usize) -> Option<usize> {
        [C, 0, 2, B].get(number).copied()
    }

    /// Checks the geometry. There is no branch to choose, so the limits of the axes do not matter.
    pub fn build(&self, _limits: &[AxisLimits; AXES]) -> Result<PipeWelder, ParameterError> {
        Ok(PipeWelder {
            torch: within("kinematics", "torch_mm", self.torch_mm, 0.0..=LARGEST_MACHINE_MM)?,
        })
    }
}

/// Kinematics of the pipe welder, ready for the tick.
#[derive(Clone, Debug, PartialEq)]
pub struct PipeWelder {
    torch: f64,
}

/// The arm's direction and the tip's distance from the axis of the pipe.
struct Arm {
    c: f64,
    outward: Vector3<f64>,
    radius: f64,
}

/// The torch's elevation.
struct Torch {
    sin: f64,
    cos: f64,
    /// Length of N's part in the plane of the arm.
    in_plane: f64,
}

impl Arm {
    fn of_angle(c: f64, radius: f64) -> Self {
        let (sin, cos) = libm::sincos(c);
        Self {
            c,
            outward: Vector3::new(cos, sin, 0.0),
            radius,
        }
    }

    fn of_point(p: &Vector3<f64>, near: f64) -> Self {
        let radius = libm::sqrt(p.x * p.x + p.y * p.y);
        if radius < POLE {
            return Self::of_angle(near, radius);
        }
        Self {
            c: next_to(libm::atan2(p.y, p.x), near),
            outward: Vector3::new(p.x / radius, p.y / radius, 0.0),
            radius,
        }
    }

    /// e_θ.
    fn along(&self) -> Vector3<f64> {
        Vector3::new(-self.outward.y, self.outward.x, 0.0)
    }
}

impl Torch {
    fn of_normal(n: &Vector3<f64>, arm: &Arm) -> Result<Self, KinematicsError> {
        let outward = n.dot(&arm.outward);
        let in_plane = libm::sqrt(outward * outward + n.z * n.z);
        // N along e_θ has no elevation.
        if in_plane < POLE {
            return Err(KinematicsError::Pole { axis: B });
        }
        Ok(Self {
            sin: n.z / in_plane,
            cos: outward / in_plane,
            in_plane,
        })
    }
}

impl PipeWelder {
    fn position(&self, pose: &Pose, arm: &Arm, torch: &Torch, near: &[f64; AXES]) -> [f64; AXES] {
        [
            arm.radius + self.torch * torch.cos,
            0.0,
            pose.position.z + self.torch * torch.sin,
            0.0,
            next_to(libm::atan2(torch.sin, torch.cos), near[B]),
            arm.c,
        ]
    }

    /// The polar coordinates of P and of N in the turning plane of the arm, differentiated twice.
    fn motion(
        &self,
        normal: &Vector3<f64>,
        arm: &Arm,
        torch: &Torch,
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let (e_r, e_t) = (arm.outward, arm.along());
        let (v, a) = (&motion.velocity, &motion.acceleration);
        let (r1, across1) = (v.dot(&e_r), v.dot(&e_t));
        let (r2, across2) = (a.dot(&e_r), a.dot(&e_t));
        let [c1, c2] = if libm::fabs(arm.radius) < POLE {
            // From the axis of the pipe the tip can only leave outwards, along the arm.
            let stays = libm::fabs(across1) <= POLE_RATE && libm::fabs(across2) <= POLE_RATE;
            let outwards = r1 > POLE_RATE || (r1 >= -POLE_RATE && r2 >= -POLE_RATE);
            if !(stays && outwards) {
                return Err(KinematicsError::Pole { axis: C });
            }
            [0.0; 2]
        } else {
            let c1 = across1 / arm.radius;
            [c1, (across2 - 2.0 * r1 * c1) / arm.radius]
        };
        let radius2 = r2 + arm.radius * c1 * c1;

        let n = axis_in_motion(normal, motion);
        let n_t = n.value.dot(&e_t);
        let n_r1 = n.first.dot(&e_r) + c1 * n_t;
        let n_r2 = n.second.dot(&e_r) + 2.0 * c1 * n.first.dot(&e_t) + c2 * n_t - c1 * c1 * n.value.dot(&e_r);
        // n_r = h cosB, n_z = h sinB.
        let Torch { sin, cos, in_plane } = *torch;
        let h1 = n_r1 * cos + n.first.z * sin;
        let b1 = (n.first.z * cos - n_r1 * sin) / in_plane;
        let b2 = (n.second.z * cos - n_r2 * sin - 2.0 * h1 * b1) / in_plane;

        let arm_length = self.torch;
        Ok((
            [
                r1 - arm_length * sin * b1,
                0.0,
                v.z + arm_length * cos * b1,
                0.0,
                b1,
                c1,
            ],
            [
                radius2 - arm_length * (sin * b2 + cos * b1 * b1),
                0.0,
                a.z + arm_length * (cos * b2 - sin * b1 * b1),
                0.0,
                b2,
                c2,
            ],
        ))
    }
}

impl Chain for PipeWelder {
    /// T is e_θ, the direction in which the waist turns.
    fn forward(&self, q: &[f64; AXES]) -> Pose {
        let (sin, cos) = libm::sincos(q[B]);
        let arm = Arm::of_angle(q[C], q[0] - self.torch * cos);
        Pose {
            position: arm.outward * arm.radius + Vector3::z() * (q[2] - self.torch * sin),
            tangent: arm.along(),
            normal: arm.outward * cos + Vector3::z() * sin,
        }
    }

    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        let arm = Arm::of_point(&pose.position, near[C]);
        let torch = Torch::of_normal(&pose.normal, &arm)?;
        Ok(self.position(pose, &arm, &torch, near))
    }

    /// For an N that the machine realises. Of one that it does not, only [`Chain::inverse_motion`] knows.
    fn derivatives(
        &self,
        q: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let (sin, cos) = libm::sincos(q[B]);
        let arm = Arm::of_angle(q[C], q[0] - self.torch * cos);
        let torch = Torch {
            sin,
            cos,
            in_plane: 1.0,
        };
        let normal = arm.outward * cos + Vector3::z() * sin;
        self.motion(&normal, &arm, &torch, motion)
    }

    /// Two arc tangents and no other trigonometry.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let arm = Arm::of_point(&pose.position, near[C]);
        let torch = Torch::of_normal(&pose.normal, &arm)?;
        let (velocity, acceleration) = self.motion(&pose.normal, &arm, &torch, motion)?;
        Ok(AxisMotion {
            position: self.position(pose, &arm, &torch, near),
            velocity,
            acceleration,
        })
    }
}
