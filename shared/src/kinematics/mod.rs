//! Machines: from the pose of the tool to the axes and back.
//!
//! One file a machine: its geometry as it stands in the machine file, and the [`Chain`] that is built of it.
//! A machine becomes one of Seamwright's by its line in the list below; firmware, dry run and planners then
//! know it as [`Kinematics`].
//!
//! Every machine uses some of the axes X Y Z \[mm\] A B C \[rad\]. An axis that it does not have stands at 0.

#[macro_use]
mod registry;

mod dual_beam;
mod limits;

pub use dual_beam::{DualBeam, DualBeamConfig};
pub(crate) use limits::AXIS_OWNERS;
pub use limits::{AXIS_UNIT, AxisLimits, feed_limit, violations};

use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::parameter::ParameterError;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

machines! {
    /// The ten-axis dual-beam laser welder: X Y Z, then C, B, A.
    "dual-beam-gantry" DualBeamGantry: DualBeamConfig => DualBeam,
}

/// Axes that realise a pose in motion (mm, rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisMotion {
    /// Positions.
    pub position: [f64; AXES],
    /// First derivatives.
    pub velocity: [f64; AXES],
    /// Second derivatives.
    pub acceleration: [f64; AXES],
}

impl AxisMotion {
    /// From derivatives over path length to derivatives over time, at path speed `v` \[mm/s\] and path
    /// acceleration `a` \[mm/s²\].
    pub fn at_speed(&self, v: f64, a: f64) -> Self {
        let (first, second) = (&self.velocity, &self.acceleration);
        Self {
            position: self.position,
            velocity: first.map(|rate| rate * v),
            acceleration: core::array::from_fn(|axis| second[axis] * (v * v) + first[axis] * a),
        }
    }
}

/// What a machine is: the way from its axes to the tool and back.
///
/// A [`Pose`] stands in the frame of the work. Machines whose tool is a body of revolution realise its
/// position and its N; T is then free, and what they say of it is written at their `forward`.
pub trait Chain {
    /// Which of X Y Z A B C the machine has.
    const FITTED: [bool; AXES];

    /// Pose of the tool for `axes`.
    fn forward(&self, axes: &[f64; AXES]) -> Pose;

    /// Axes that realise `pose`. Where several do, and where a rotary axis may stand a turn further, those
    /// nearest to `near`, the axes just before. They may lie outside the travel: see [`violations`].
    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError>;

    /// Velocities and accelerations of the axes standing at `axes`, for a tool that moves by `motion`.
    fn derivatives(
        &self,
        axes: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError>;

    /// [`Chain::inverse`] and [`Chain::derivatives`] at once, for the tick.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let position = self.inverse(pose, near)?;
        let (velocity, acceleration) = self.derivatives(&position, motion)?;
        Ok(AxisMotion {
            position,
            velocity,
            acceleration,
        })
    }

    /// Axis rates for tip velocity `v` \[mm/s\] and angular velocity `omega` \[rad/s\] at `axes`. With
    /// derivatives over path length in place of those over time it gives q′(s).
    fn rates(
        &self,
        axes: &[f64; AXES],
        v: &Vector3<f64>,
        omega: &Vector3<f64>,
    ) -> Result<[f64; AXES], KinematicsError> {
        let motion = PoseMotion {
            velocity: *v,
            angular_velocity: *omega,
            acceleration: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
        };
        Ok(self.derivatives(axes, &motion)?.0)
    }
}

/// Why no axes realise a pose, or its motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum KinematicsError {
    /// The x axis of the tool is parallel to an axis that turns it.
    #[error("gimbal lock")]
    GimbalLock,
}
