//! The five-axis machine with an A/C head: X Y Z, then C, A (mathematics 2.5).
//!
//! The head turns about C (vertical, in the ram), then tilts about A: R = Rz(C)·Rx(A), T = R·ex, N = R·ez. The
//! nozzle is a body of revolution: it realises P and N = (sinC sinA, −cosC sinA, cosA). T is then the axis of A.
//!
//! An N has two solutions, (A, C) and (−A, C + π), each with any number of turns of C. Those within the travel of A
//! and C compete, and the one with the smallest way of C wins: N may pass the vertical by a change of A's sign.
//! At the vertical itself C stays.

use super::tool_axis::{POLE, Tilt, TiltMotion, axis_in_motion};
use super::{AxisLimits, AxisMotion, Chain, KinematicsError, xyz};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::{ParameterError, check, length_of_machine};
use crate::units::{next_to, round_half_away};
use core::f64::consts::PI;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

const A: usize = 3;
const C: usize = 5;

/// Geometry of the A/C head \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct AcHeadConfig {
    /// C axis to A axis, in the frame that turns with C.
    #[serde(deserialize_with = "xyz")]
    pub o1_mm: [f64; 3],
    /// A axis to the focus, in the frame after A: z < 0.
    #[serde(deserialize_with = "xyz")]
    pub o2_mm: [f64; 3],
}

impl AcHeadConfig {
    /// Axis of its joint of this number, from the work to the tool.
    pub fn joint(&self, number: usize) -> Option<usize> {
        [0, 1, 2, C, A].get(number).copied()
    }

    /// Checks the geometry: every number one of a machine, and the focus below the A axis. The travel of A and C in `limits`
    /// decides which solutions there are.
    pub fn build(&self, limits: &[AxisLimits; AXES]) -> Result<AcHead, ParameterError> {
        check("kinematics", "o2_mm", self.o2_mm[2], |z| z < 0.0)?;
        Ok(AcHead {
            o1: length_of_machine("kinematics", "o1_mm", &self.o1_mm)?,
            o2: length_of_machine("kinematics", "o2_mm", &self.o2_mm)?,
            limits_a: limits[A],
            limits_c: limits[C],
        })
    }
}

/// Kinematics of the A/C head, ready for the tick.
#[derive(Clone, Debug, PartialEq)]
pub struct AcHead {
    o1: Vector3<f64>,
    o2: Vector3<f64>,
    limits_a: AxisLimits,
    limits_c: AxisLimits,
}

/// A, C, and their sines and cosines.
struct Angles {
    a: f64,
    c: f64,
    /// d = (sinC, −cosC, 0).
    tilt: Tilt,
}

impl Angles {
    fn of_axes(a: f64, c: f64) -> Self {
        let (sin, cos) = libm::sincos(a);
        let (sin_c, cos_c) = libm::sincos(c);
        Self {
            a,
            c,
            tilt: Tilt {
                sin,
                cos,
                toward: Vector3::new(sin_c, -cos_c, 0.0),
            },
        }
    }

    /// Rz(C)·v.
    fn about_c(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = (self.tilt.toward.x, -self.tilt.toward.y);
        Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    }

    /// Rz(C)·Rx(A)·v.
    fn about_ca(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = (self.tilt.sin, self.tilt.cos);
        self.about_c(&Vector3::new(v.x, cos * v.y - sin * v.z, sin * v.y + cos * v.z))
    }
}

impl AcHead {
    /// By how much X Y Z must move so that the focus stays in place while A and C go from one pair to another
    /// \[rad\] (mathematics 2.5). Apply it in every tick: between two compensated ends the focus is off.
    pub fn compensation(&self, from: [f64; 2], to: [f64; 2]) -> Vector3<f64> {
        let arm = |[a, c]: [f64; 2]| self.arm(&Angles::of_axes(a, c));
        let ((from_1, from_2), (to_1, to_2)) = (arm(from), arm(to));
        (from_1 + from_2) - (to_1 + to_2)
    }

    /// C axis to A axis, and A axis to focus, in the world frame.
    fn arm(&self, angles: &Angles) -> (Vector3<f64>, Vector3<f64>) {
        (angles.about_c(&self.o1), angles.about_ca(&self.o2))
    }

    /// The solution for N that is nearest to `near` (mathematics 2.5).
    fn solve(&self, normal: &Vector3<f64>, near: &[f64; AXES]) -> Result<Angles, KinematicsError> {
        let s = libm::sqrt(normal.x * normal.x + normal.y * normal.y);
        if s < POLE {
            let a = if normal.z < 0.0 { PI } else { 0.0 };
            if !self.limits_a.contains(a) {
                return Err(KinematicsError::OutOfRange { axis: A });
            }
            if !self.limits_c.contains(near[C]) {
                return Err(KinematicsError::OutOfRange { axis: C });
            }
            return Ok(Angles::of_axes(a, near[C]));
        }
        let a = libm::atan2(s, normal.z);
        let c = libm::atan2(normal.x, -normal.y);
        let mut best: Option<([f64; 2], f64, f64)> = None;
        let mut axis = A;
        for (a, c) in [(a, c), (-a, c + PI)] {
            if !self.limits_a.contains(a) {
                continue;
            }
            axis = C;
            let nearest = next_to(c, near[C]);
            for c in [nearest, nearest - 2.0 * PI, nearest + 2.0 * PI] {
                if !self.limits_c.contains(c) {
                    continue;
                }
                // Ways of C that differ only by rounding are equal; then the way of A decides.
                let way = [
                    round_half_away(libm::fabs(c - near[C]) * 1e12),
                    libm::fabs(a - near[A]),
                ];
                if best.is_none_or(|(best, ..)| way < best) {
                    best = Some((way, a, c));
                }
            }
        }
        let (_, a, c) = best.ok_or(KinematicsError::OutOfRange { axis })?;
        let sign = libm::copysign(1.0, a);
        Ok(Angles {
            a,
            c,
            tilt: Tilt {
                sin: sign * s,
                cos: normal.z,
                toward: Vector3::new(normal.x, normal.y, 0.0) * (sign / s),
            },
        })
    }

    fn position(&self, pose: &Pose, angles: &Angles) -> [f64; AXES] {
        let (r1, r2) = self.arm(angles);
        let p = pose.position - (r1 + r2);
        [p.x, p.y, p.z, angles.a, 0.0, angles.c]
    }

    fn motion(
        &self,
        angles: &Angles,
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let TiltMotion { tilt, turn } = self.angle_motion(angles, motion)?;
        let a_axis = angles.tilt.across();
        let (r1, r2) = self.arm(angles);
        let omega_1 = Vector3::new(0.0, 0.0, turn[0]);
        let omega_2 = omega_1 + a_axis * tilt[0];
        let alpha_1 = Vector3::new(0.0, 0.0, turn[1]);
        let alpha_2 = alpha_1 + a_axis * tilt[1] + omega_1.cross(&a_axis) * tilt[0];
        let (u1, u2) = (omega_1.cross(&r1), omega_2.cross(&r2));
        let p = motion.velocity - (u1 + u2);
        let p_acc = motion.acceleration
            - (alpha_1.cross(&r1) + omega_1.cross(&u1))
            - (alpha_2.cross(&r2) + omega_2.cross(&u2));
        Ok((
            [p.x, p.y, p.z, tilt[0], 0.0, turn[0]],
            [p_acc.x, p_acc.y, p_acc.z, tilt[1], 0.0, turn[1]],
        ))
    }

    fn angle_motion(&self, angles: &Angles, motion: &PoseMotion) -> Result<TiltMotion, KinematicsError> {
        let normal = axis_in_motion(&angles.tilt.normal(), motion);
        angles.tilt.rates(&normal, [0.0; 2], C)
    }
}

impl Chain for AcHead {
    /// T is the axis of A.
    fn forward(&self, q: &[f64; AXES]) -> Pose {
        let angles = Angles::of_axes(q[A], q[C]);
        let (r1, r2) = self.arm(&angles);
        Pose {
            position: Vector3::new(q[0], q[1], q[2]) + r1 + r2,
            tangent: angles.tilt.across(),
            normal: angles.tilt.normal(),
        }
    }

    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        let angles = self.solve(&pose.normal, near)?;
        Ok(self.position(pose, &angles))
    }

    fn derivatives(
        &self,
        q: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        self.motion(&Angles::of_axes(q[A], q[C]), motion)
    }

    /// Two arc tangents and, away from the pole, no other trigonometry.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let angles = self.solve(&pose.normal, near)?;
        let (velocity, acceleration) = self.motion(&angles, motion)?;
        Ok(AxisMotion {
            position: self.position(pose, &angles),
            velocity,
            acceleration,
        })
    }
}
