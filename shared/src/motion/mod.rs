//! The motion board's controller: servo loops, path, homing, beams and the state machine above them.
//!
//! [`ServoLoops`] runs in the servo tick, [`MotionController`] in the path tick and for the PC's requests;
//! between them pass one [`ServoOrder`] and one [`ServoReport`] a millisecond. Firmware, simulation and
//! tests use the same two structs.

mod aside;
mod beams;
mod config;
mod controller;
mod fault;
mod homing;
mod machine;
mod overlap;
mod permit;
mod readback;
mod segment;
pub(crate) mod sensible;
mod servo;
mod state;
mod vibration;

pub use beams::EVENTS;
pub use config::{
    AxisConfig, BeamConfig, GantryConfig, HomeConfig, MotionConfig, MotorConfig, ReadbackConfig,
};
pub use controller::{MotionController, PathTickInput, PathTickOutput};
pub use fault::{Fault, NoPermit};
pub use machine::Machine;
pub use permit::BeamLease;
pub use readback::DARK;
pub use segment::{PATH_PERIOD_S, SERVO_PERIOD_S, SERVO_TICKS_PER_PATH_TICK};
pub use servo::{ServoLoops, ServoOrder, ServoReport, ServoSetup};
pub use state::{Event, State};

use vibration::Vibration;
