//! What the servo loops are asked for: path, speed and kinematics put together once a path tick.

use super::{Path, SpeedState};
use crate::geometry::{Pose, PoseError};
use crate::io::AXES;
use crate::kinematics::{DualBeam, KinematicsError};
use thiserror::Error;

/// References of the axes at one path tick (X Y Z A B C; mm, rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisReference {
    /// Positions.
    pub position: [f64; AXES],
    /// Velocities.
    pub velocity: [f64; AXES],
    /// Accelerations.
    pub acceleration: [f64; AXES],
    /// The pose these positions realise.
    pub pose: Pose,
}

/// Why there is no reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ReferenceError {
    /// The path has no knots.
    #[error("the path is empty")]
    EmptyPath,
    /// The path is no pose there.
    #[error("the path is no pose there: {0}")]
    Pose(#[from] PoseError),
    /// The machine cannot realise the pose.
    #[error("the machine cannot take the pose: {0}")]
    Kinematics(#[from] KinematicsError),
}

/// The references at `state` of `path`: the pose at s, its axes, and their rates and accelerations by the
/// chain rule (SPEC 0.3, 0.4).
pub fn reference<const N: usize>(
    kinematics: &DualBeam,
    path: &Path<N>,
    state: SpeedState,
) -> Result<AxisReference, ReferenceError> {
    let point = path.at(state.s).ok_or(ReferenceError::EmptyPath)?;
    let (pose, motion) = point.pose_in_motion()?;
    let axes = kinematics.inverse_motion(&pose, &motion.at_speed(state.v, state.a))?;
    Ok(AxisReference {
        position: axes.position,
        velocity: axes.velocity,
        acceleration: axes.acceleration,
        pose,
    })
}
