//! Machines: from the pose of the tool to the axes and back. One file a machine.

mod dual_beam;
mod limits;

pub use dual_beam::{AxisMotion, DualBeam, DualBeamConfig};
pub use limits::{AXIS_UNIT, AxisLimits, feed_limit, violations};

use thiserror::Error;

/// Why no axes realise a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum KinematicsError {
    /// The direction of travel is vertical, parallel to the C axis.
    #[error("gimbal lock")]
    GimbalLock,
}
