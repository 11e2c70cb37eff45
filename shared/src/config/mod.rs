//! Parameters of each board from the machine file, as they are sent to the board.
//!
//! What belongs to one law or one machine stands beside it: motors, gantry and reference marks in [`crate::control`], axes
//! and geometry in [`crate::kinematics`].

mod deviation;
mod motion;
mod tracker;

pub(crate) use deviation::smooth;
pub use deviation::{
    DEVIATION_POINTS, DEVIATION_POINTS_IN_ALL, DEVIATIONS, DeviationConfig, MOST_DEVIATION,
    STEEPEST_DEVIATION,
};
pub use motion::{
    AnalogConfig, BeamConfig, MotionConfig, OutputConfig, ProcessInputConfig, ProcessIo, ReadbackConfig,
};
pub use tracker::{HeadConfig, SlideConfig, TrackerConfig, TrackingConfig};
