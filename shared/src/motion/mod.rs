//! The motion board's controller: servo loops, path, homing, beams and the state machine above them.
//!
//! [`ServoLoops`] runs in the servo tick, [`MotionController`] in the path tick and for the PC's requests;
//! between them pass one [`ServoOrder`] and one [`ServoReport`] a millisecond. Firmware, simulation and
//! tests use the same two structs.

mod beams;
mod compensation;
mod controller;
mod excitation;
mod homing;
mod levels;
mod machine;
mod outputs;
mod overlap;
mod permit;
mod process_inputs;
mod readback;
mod segment;
mod sensible;
mod servo;
mod superimposed;
mod vibration;

pub use beams::EVENTS;
pub use controller::{ControllerAccess, MotionController, PathTickInput, PathTickOutput, answer};
pub use excitation::{Chirp, Way};
pub use machine::Machine;
pub use permit::BeamLease;
pub use readback::DARK;
pub use sensible::{check_coupling, check_gains, most_following_error_base, vibration_limit};
pub use servo::{ServoLoops, ServoOrder, ServoReport, ServoSetup};

use vibration::Vibration;
