//! Curves, frames and attitude in the work frame.

mod pose;

pub use pose::{Pose, PoseError};
