//! The friction-stir gantry: table X, then Y, Z, C, B (mathematics 4.1).
//!
//! Work frame: that of the plate on the table, at home with the tip of the pin in its origin and Z up. The table
//! carries the work, so the tool moves by sx = −X over it, sy = Y and sz = Z. The head turns about C, then tilts
//! about B, and the pin hangs l4 from the point where both axes meet:
//!
//! P = (sx, sy, sz) + Rz(C)·Ry(B)·(0, 0, l4) − (0, 0, l4), N = Rz(C)·Ry(B)·ez = (cosC sinB, sinC sinB, cosB).
//!
//! The pin is a body of revolution: it realises P and N. It leans backwards along the weld, which either sign of B
//! allows; the machine's setting decides. With B > 0 the heading is opposite to the direction that C gives,
//! T = −Rz(C)·Ry(B)·ex; with B < 0 it is T = Rz(C)·Ry(B)·ex. With the pin upright C follows T.

use super::tool_axis::{POLE, Tilt, axis_in_motion};
use super::{AxisLimits, AxisMotion, Chain, KinematicsError};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::{LARGEST_MACHINE_MM, ParameterError, check};
use crate::units::next_to;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

const B: usize = 4;
const C: usize = 5;

/// Geometry of the friction-stir gantry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct StirGantryConfig {
    /// From the point where the axes C and B meet to the tip of the pin, along the tool axis: negative, the pin
    /// hangs \[mm\].
    pub l4_mm: f64,
    /// Sign of B with which the pin leans backwards.
    pub tilt: StirTilt,
}

/// Sign of the angle B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[serde(rename_all = "kebab-case")]
pub enum StirTilt {
    /// B ≥ 0, and C = heading + 180°.
    Positive,
    /// B ≤ 0, and C = heading.
    Negative,
}

impl StirGantryConfig {
    /// Axis of its joint of this number, from the work to the tool.
    pub fn joint(&self, number: usize) -> Option<usize> {
        [0, 1, 2, C, B].get(number).copied()
    }

    /// Checks the geometry: the pin hangs. The travel of B in `limits` decides which tilts there are.
    pub fn build(&self, limits: &[AxisLimits; AXES]) -> Result<StirGantry, ParameterError> {
        Ok(StirGantry {
            l4: check("kinematics", "l4_mm", self.l4_mm, |l4| {
                (-LARGEST_MACHINE_MM..0.0).contains(&l4)
            })?,
            sign: match self.tilt {
                StirTilt::Positive => 1.0,
                StirTilt::Negative => -1.0,
            },
            limits_b: limits[B],
        })
    }
}

/// Kinematics of the friction-stir gantry, ready for the tick.
#[derive(Clone, Debug, PartialEq)]
pub struct StirGantry {
    l4: f64,
    /// Sign of B.
    sign: f64,
    limits_b: AxisLimits,
}

/// B, C, and their sines and cosines.
struct Angles {
    b: f64,
    c: f64,
    /// d = (cosC, sinC, 0).
    tilt: Tilt,
}

impl Angles {
    fn of_axes(b: f64, c: f64) -> Self {
        let (sin, cos) = libm::sincos(b);
        let (sin_c, cos_c) = libm::sincos(c);
        Self {
            b,
            c,
            tilt: Tilt {
                sin,
                cos,
                toward: Vector3::new(cos_c, sin_c, 0.0),
            },
        }
    }
}

impl StirGantry {
    fn solve(&self, pose: &Pose, near: &[f64; AXES]) -> Result<Angles, KinematicsError> {
        let (normal, tangent) = (&pose.normal, &pose.tangent);
        if normal.z <= 0.0 {
            return Err(KinematicsError::BelowHorizon);
        }
        let s = libm::sqrt(normal.x * normal.x + normal.y * normal.y);
        // N gives the direction of C where the pin leans, and T where it stands upright: both point backwards
        // with B > 0.
        let (b, cos, toward) = if s < POLE {
            let level = libm::sqrt(tangent.x * tangent.x + tangent.y * tangent.y);
            (
                0.0,
                1.0,
                Vector3::new(tangent.x, tangent.y, 0.0) * (-self.sign / level),
            )
        } else {
            let b = libm::atan2(s, normal.z) * self.sign;
            (
                b,
                normal.z,
                Vector3::new(normal.x, normal.y, 0.0) * (self.sign / s),
            )
        };
        if !self.limits_b.contains(b) {
            return Err(KinematicsError::OutOfRange { axis: B });
        }
        Ok(Angles {
            b,
            c: next_to(libm::atan2(toward.y, toward.x), near[C]),
            tilt: Tilt {
                sin: if s < POLE { 0.0 } else { s * self.sign },
                cos,
                toward,
            },
        })
    }

    /// From the tool's displacement s to its tip: l4·(N − ez).
    fn arm(&self, angles: &Angles) -> Vector3<f64> {
        (angles.tilt.normal() - Vector3::z()) * self.l4
    }

    fn position(&self, pose: &Pose, angles: &Angles) -> [f64; AXES] {
        let s = pose.position - self.arm(angles);
        [-s.x, s.y, s.z, 0.0, angles.b, angles.c]
    }

    fn motion(
        &self,
        angles: &Angles,
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let normal = axis_in_motion(&angles.tilt.normal(), motion);
        // Of an upright pin, C follows T.
        let with_t = [motion.angular_velocity.z, motion.angular_acceleration.z];
        let angle = angles.tilt.rates(&normal, with_t, C)?;
        let s = motion.velocity - normal.first * self.l4;
        let s_acc = motion.acceleration - normal.second * self.l4;
        Ok((
            [-s.x, s.y, s.z, 0.0, angle.tilt[0], angle.turn[0]],
            [-s_acc.x, s_acc.y, s_acc.z, 0.0, angle.tilt[1], angle.turn[1]],
        ))
    }
}

impl Chain for StirGantry {
    /// T is the heading with which the pin leans backwards.
    fn forward(&self, q: &[f64; AXES]) -> Pose {
        let angles = Angles::of_axes(q[B], q[C]);
        let Tilt { sin, cos, toward } = angles.tilt;
        Pose {
            position: Vector3::new(-q[0], q[1], q[2]) + self.arm(&angles),
            tangent: Vector3::new(toward.x * cos, toward.y * cos, -sin) * -self.sign,
            normal: angles.tilt.normal(),
        }
    }

    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        let angles = self.solve(pose, near)?;
        Ok(self.position(pose, &angles))
    }

    fn derivatives(
        &self,
        q: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        self.motion(&Angles::of_axes(q[B], q[C]), motion)
    }

    /// Two arc tangents and no other trigonometry.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let angles = self.solve(pose, near)?;
        let (velocity, acceleration) = self.motion(&angles, motion)?;
        Ok(AxisMotion {
            position: self.position(pose, &angles),
            velocity,
            acceleration,
        })
    }
}
