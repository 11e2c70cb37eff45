//! The dual-beam gantry: X Y Z, then C, B, A (mathematics 0.2, 0.3).
//!
//! The order of the axes is X Y Z A B C everywhere, in mm and rad. The head turns about C (vertical, in the
//! ram), then B, then A, which is the direction of travel T: R = Rz(C)·Ry(B)·Rx(A), T = R·ex, N = R·ez.
//! Inside |B| ≤ 30° and |C| ≤ 90° the solution is unique and regular, so there is no branch to choose.

use super::rpy::{RollPitchYaw, across_z};
use super::{AxisLimits, AxisMotion, Chain, KinematicsError, xyz};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::{ParameterError, check, length_of_machine};
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Geometry of the dual-beam gantry \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct DualBeamConfig {
    /// C axis to B axis, in the frame that turns with C.
    #[serde(deserialize_with = "xyz")]
    pub o1_mm: [f64; 3],
    /// B axis to A axis, in the frame after B.
    #[serde(deserialize_with = "xyz")]
    pub o2_mm: [f64; 3],
    /// A axis to the virtual tip D, in the plate frame: (tx, ty, −L).
    #[serde(deserialize_with = "xyz")]
    pub o3_mm: [f64; 3],
}

impl DualBeamConfig {
    /// Axis of its joint of this number, from the work to the tool.
    pub fn joint(&self, number: usize) -> Option<usize> {
        [0, 1, 2, 5, 4, 3].get(number).copied()
    }

    /// Checks the geometry: every number one of a machine, and the tip below the A axis. The solution is unique within
    /// any travel, so the limits of the axes do not matter.
    pub fn build(&self, _limits: &[AxisLimits; AXES]) -> Result<DualBeam, ParameterError> {
        check("kinematics", "o3_mm", self.o3_mm[2], |z| z < 0.0)?;
        Ok(DualBeam {
            o1: length_of_machine("kinematics", "o1_mm", &self.o1_mm)?,
            o2: length_of_machine("kinematics", "o2_mm", &self.o2_mm)?,
            o3: length_of_machine("kinematics", "o3_mm", &self.o3_mm)?,
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

/// The three segments from the C axis to the tip, in the world frame.
struct Segments {
    r1: Vector3<f64>,
    r2: Vector3<f64>,
    r3: Vector3<f64>,
}

impl DualBeam {
    fn segments(&self, turn: &RollPitchYaw) -> Segments {
        Segments {
            r1: turn.about_c(&self.o1),
            r2: turn.about_c(&turn.about_b(&self.o2)),
            r3: turn.about_c(&turn.about_b(&turn.about_a(&self.o3))),
        }
    }

    fn position(pose: &Pose, turn: &RollPitchYaw, segments: &Segments) -> [f64; AXES] {
        let p = pose.position - (segments.r1 + segments.r2 + segments.r3);
        let [a, b, c] = turn.angles();
        [p.x, p.y, p.z, a, b, c]
    }

    /// The closed forms of mathematics 0.3.
    fn motion(
        turn: &RollPitchYaw,
        segments: &Segments,
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let (omega, alpha) = (&motion.angular_velocity, &motion.angular_acceleration);
        let Segments { r1, r2, r3 } = segments;
        let angles = turn.rates(omega, alpha)?;
        let [a_rate, b_rate, c_rate] = angles.velocity;
        let [a_acc, b_acc, c_acc] = angles.acceleration;
        let b_axis = turn.pitch_axis();

        let omega_2 = b_axis * b_rate + Vector3::new(0.0, 0.0, c_rate);
        // ω_i × r_i is needed again for the centripetal parts.
        let (u1, u2, u3) = (across_z(c_rate, r1), omega_2.cross(r2), omega.cross(r3));
        let p = motion.velocity - (u1 + u2 + u3);

        let alpha_2 = b_axis * b_acc + across_z(c_rate * b_rate, &b_axis) + Vector3::new(0.0, 0.0, c_acc);
        let p_acc = motion.acceleration
            - (across_z(c_acc, r1) + across_z(c_rate, &u1))
            - (alpha_2.cross(r2) + omega_2.cross(&u2))
            - (alpha.cross(r3) + omega.cross(&u3));

        Ok((
            [p.x, p.y, p.z, a_rate, b_rate, c_rate],
            [p_acc.x, p_acc.y, p_acc.z, a_acc, b_acc, c_acc],
        ))
    }
}

impl Chain for DualBeam {
    /// Pose of the plate for axes `q` (mathematics 0.2).
    fn forward(&self, q: &[f64; AXES]) -> Pose {
        let turn = RollPitchYaw::of_angles(q[3], q[4], q[5]);
        let Segments { r1, r2, r3 } = self.segments(&turn);
        Pose {
            position: Vector3::new(q[0], q[1], q[2]) + r1 + r2 + r3,
            tangent: turn.tangent(),
            normal: turn.normal(),
        }
    }

    /// Steps 2 and 3 of mathematics 0.2; step 1 is [`Pose::new`]. One solution only: `_near` is not used.
    fn inverse(&self, pose: &Pose, _near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        let turn = RollPitchYaw::of_pose(pose)?;
        let segments = self.segments(&turn);
        Ok(Self::position(pose, &turn, &segments))
    }

    fn derivatives(
        &self,
        q: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let turn = RollPitchYaw::of_angles(q[3], q[4], q[5]);
        let segments = self.segments(&turn);
        Self::motion(&turn, &segments, motion)
    }

    /// Three arc tangents and no other trigonometry.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        _near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let turn = RollPitchYaw::of_pose(pose)?;
        let segments = self.segments(&turn);
        let (velocity, acceleration) = Self::motion(&turn, &segments, motion)?;
        Ok(AxisMotion {
            position: Self::position(pose, &turn, &segments),
            velocity,
            acceleration,
        })
    }
}
