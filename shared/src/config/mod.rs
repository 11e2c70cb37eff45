//! Parameters of each board from the machine file, as they are sent to the board.
//!
//! What belongs to one law or one machine stands beside it: motors, gantry and reference marks in [`crate::control`], axes
//! and geometry in [`crate::kinematics`].

mod motion;
mod tracker;

pub use motion::{
    AnalogConfig, BeamConfig, MotionConfig, OutputConfig, ProcessInputConfig, ProcessIo, ReadbackConfig,
};
pub use tracker::{HeadConfig, SlideConfig, TrackerConfig, TrackingConfig};
