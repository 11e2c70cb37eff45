//! The motion board's controller: servo loops, path, homing, beams and the state machine above them.

mod config;
mod fault;
mod state;

pub use config::{AxisConfig, BeamConfig, GantryConfig, HomeConfig, MotionConfig, MotorConfig};
pub use fault::Fault;
pub use state::State;
