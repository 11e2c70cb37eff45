//! Curves, frames and attitude in the work frame.

mod arc;
mod attitude;
mod line;
mod motion;
pub mod nurbs;
mod offset;
mod pose;

pub use arc::{Arc, ArcError, Turn};
pub use attitude::{angle, rotate};
pub use line::{Line, LineError};
pub use motion::{Moving, PoseMotion, pose_in_motion};
pub use offset::PoseOffset;
pub use pose::{Pose, PoseError};
