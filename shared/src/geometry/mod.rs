//! Curves, frames and attitude in the work frame.

mod attitude;
mod motion;
mod pose;
mod spline;

pub use attitude::{AttitudeError, angle, interpolate, rotate};
pub use motion::{Moving, PoseMotion, frame_rates, pose_in_motion};
pub use pose::{Pose, PoseError};
pub use spline::{NaturalSpline, SplineError};
