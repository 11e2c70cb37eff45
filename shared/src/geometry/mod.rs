//! Curves, frames and attitude in the work frame.

mod motion;
mod pose;

pub use motion::{Moving, PoseMotion, frame_rates, pose_in_motion};
pub use pose::{Pose, PoseError};
