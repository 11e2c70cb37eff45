//! The wire-arc robot: X Y Z and A at the torch, B (tilt) and C (turn) at the positioner that holds the part.
//!
//! ```text
//!                 X Y Z gantry                     z
//!                    │                             │   y
//!             ───────┴─────── A axis, ∥ x          │ ╱
//!                    │ torch (z < 0)               └──── x
//!                    ▼ wire tip w
//!               ┌────────┐ part, frame p
//!           ════╧════════╧════ turntable, turns by C
//!                   │ turntable vector
//!                   ⊗ tilt axis, ∥ y, tilts by B
//! ```
//!
//! Machine frame: the axes of the gantry, Z up. Looking against an axis, a positive angle turns left: with C > 0 the
//! part turns from x to y, with B > 0 the turntable's z axis leans towards x, with A > 0 the torch's tip moves
//! towards +y. With c = the point of the tilt axis, u = `turntable` (from there to the centre of the turntable, while
//! B = 0) and h = `torch` (from the A axis to the wire tip, while A = 0):
//!
//! - the torch brings the tip to w = (X, Y, Z) + Rx(A)·h, and its frame stands as Rx(A);
//! - the point p of the part stands at w = c + Ry(B)·(u + Rz(C)·p), and the part's frame as Ry(B)·Rz(C).
//!
//! The work frame is the part's. Seen from there the torch stands as R = Rz(−C)·Ry(−B)·Rx(A), T = R·ex, N = R·ez,
//! and the tip at p = Rz(−C)·(Ry(−B)·(w − c) − u). That is roll A, pitch −B and yaw −C: T and N determine all three
//! angles, and the solution with |B| < 90° is the only one. The positioner turns the travel T into the machine's x
//! direction, so the bead lies level along x and the torch tilts across it.
//!
//! Rates, outwards from the part: a point r that moves by ṙ in a frame turning by ω moves by ṙ + ω × r, and is
//! accelerated by r̈ + α × r + ω × (2 ṙ + ω × r); so p on the turntable, and u + Rz(C)·p on the tilt axis. The torch's
//! h is taken off: what remains is the motion of X Y Z.

use super::rpy::RollPitchYaw;
use super::{AxisLimits, AxisMotion, Chain, KinematicsError, xyz};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::{ParameterError, check, length_of_machine};
use crate::units::next_to;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

const C: usize = 5;

/// Geometry of the wire-arc robot \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct WireArcConfig {
    /// A axis to the tip of the wire, in the frame after A: z < 0.
    #[serde(deserialize_with = "xyz")]
    pub torch_mm: [f64; 3],
    /// A point of the tilt axis B, in the machine frame.
    #[serde(deserialize_with = "xyz")]
    pub tilt_axis_mm: [f64; 3],
    /// From that point to the centre of the turntable, in the frame after B.
    #[serde(deserialize_with = "xyz")]
    pub turntable_mm: [f64; 3],
}

impl WireArcConfig {
    /// Axis of its joint of this number, from the work to the tool.
    pub fn joint(&self, number: usize) -> Option<usize> {
        [C, 4, 0, 1, 2, 3].get(number).copied()
    }

    /// Checks the geometry: every number one of a machine, and the wire below the A axis. The solution is unique but for
    /// whole turns of C, so the limits of the axes do not matter.
    pub fn build(&self, _limits: &[AxisLimits; AXES]) -> Result<WireArc, ParameterError> {
        check("kinematics", "torch_mm", self.torch_mm[2], |z| z < 0.0)?;
        Ok(WireArc {
            torch: length_of_machine("kinematics", "torch_mm", &self.torch_mm)?,
            tilt_axis: length_of_machine("kinematics", "tilt_axis_mm", &self.tilt_axis_mm)?,
            turntable: length_of_machine("kinematics", "turntable_mm", &self.turntable_mm)?,
        })
    }
}

/// Kinematics of the wire-arc robot, ready for the tick.
#[derive(Clone, Debug, PartialEq)]
pub struct WireArc {
    torch: Vector3<f64>,
    tilt_axis: Vector3<f64>,
    turntable: Vector3<f64>,
}

/// Roll, pitch and yaw of the torch in the part's frame.
fn attitude(q: &[f64; AXES]) -> RollPitchYaw {
    RollPitchYaw::of_angles(q[3], -q[4], -q[5])
}

impl WireArc {
    /// The tip of the wire in the part's frame.
    fn tip(&self, torch: &RollPitchYaw, q: &[f64; AXES]) -> Vector3<f64> {
        let tip = Vector3::new(q[0], q[1], q[2]) + torch.about_a(&self.torch);
        let on_tilted = torch.about_b(&(tip - self.tilt_axis));
        torch.about_c(&(on_tilted - self.turntable))
    }

    /// From the tilt axis to the point `p` of the part, in the frame after B.
    fn on_tilted(&self, torch: &RollPitchYaw, p: &Vector3<f64>) -> Vector3<f64> {
        self.turntable + torch.back_c(p)
    }

    fn position(&self, pose: &Pose, torch: &RollPitchYaw, near: &[f64; AXES]) -> [f64; AXES] {
        let tip = self.tilt_axis + torch.back_b(&self.on_tilted(torch, &pose.position));
        let carriage = tip - torch.about_a(&self.torch);
        let [roll, pitch, yaw] = torch.angles();
        [
            carriage.x,
            carriage.y,
            carriage.z,
            roll,
            -pitch,
            next_to(-yaw, near[C]),
        ]
    }

    fn motion(
        &self,
        torch: &RollPitchYaw,
        p: &Vector3<f64>,
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let angles = torch.rates(&motion.angular_velocity, &motion.angular_acceleration)?;
        let [a_rate, b_rate, c_rate] = [angles.velocity[0], -angles.velocity[1], -angles.velocity[2]];
        let [a_acc, b_acc, c_acc] = [
            angles.acceleration[0],
            -angles.acceleration[1],
            -angles.acceleration[2],
        ];
        // Outwards: the part on the turntable, the turntable on the tilt axis.
        let turned =
            Turning::about(Vector3::z(), c_rate, c_acc).carry(p, &motion.velocity, &motion.acceleration);
        let tilted = Turning::about(Vector3::y(), b_rate, b_acc).carry(
            &self.on_tilted(torch, p),
            &torch.back_c(&turned.0),
            &torch.back_c(&turned.1),
        );
        let zero = Vector3::zeros();
        let arm =
            Turning::about(Vector3::x(), a_rate, a_acc).carry(&torch.about_a(&self.torch), &zero, &zero);
        let v = torch.back_b(&tilted.0) - arm.0;
        let a = torch.back_b(&tilted.1) - arm.1;
        Ok((
            [v.x, v.y, v.z, a_rate, b_rate, c_rate],
            [a.x, a.y, a.z, a_acc, b_acc, c_acc],
        ))
    }
}

/// A rotation about a fixed axis.
struct Turning {
    omega: Vector3<f64>,
    alpha: Vector3<f64>,
}

impl Turning {
    fn about(axis: Vector3<f64>, rate: f64, acceleration: f64) -> Self {
        Self {
            omega: axis * rate,
            alpha: axis * acceleration,
        }
    }

    /// Velocity and acceleration of the point `r` that itself moves by `v` and `a` in the turning frame. The axis
    /// is the same in both frames, so all may be given, and come, in the turning one.
    fn carry(&self, r: &Vector3<f64>, v: &Vector3<f64>, a: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let around = self.omega.cross(r);
        (
            v + around,
            a + self.alpha.cross(r) + self.omega.cross(&(v * 2.0 + around)),
        )
    }
}

impl Chain for WireArc {
    /// Pose of the torch in the part's frame.
    fn forward(&self, q: &[f64; AXES]) -> Pose {
        let torch = attitude(q);
        Pose {
            position: self.tip(&torch, q),
            tangent: torch.tangent(),
            normal: torch.normal(),
        }
    }

    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        Ok(self.position(pose, &RollPitchYaw::of_pose(pose)?, near))
    }

    fn derivatives(
        &self,
        q: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let torch = attitude(q);
        self.motion(&torch, &self.tip(&torch, q), motion)
    }

    /// Three arc tangents and no other trigonometry.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let torch = RollPitchYaw::of_pose(pose)?;
        let (velocity, acceleration) = self.motion(&torch, &pose.position, motion)?;
        Ok(AxisMotion {
            position: self.position(pose, &torch, near),
            velocity,
            acceleration,
        })
    }
}
