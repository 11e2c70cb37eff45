//! Servo laws: position loops, gantry, trips, and the search for reference marks.
//!
//! Each law has the human numbers of the machine file, coefficients made from them by a fallible `build`, and a state. Inside everything is mm or rad and seconds.

mod biquad;
mod config;
mod derivative;
mod emergency_stop;
mod friction;
mod gantry;
mod loop_filter;
mod movement;
mod pid;
mod reference_search;
pub(crate) mod sensible;
mod trip;

pub use config::{FrictionConfig, GantryConfig, HomeConfig, LowPassConfig, MotorConfig, NotchConfig};
pub use emergency_stop::{DISCREPANCY_US, EmergencyStop};
pub use friction::{Friction, FrictionState};
pub use gantry::{Gantry, GantryOutput, GantryState, Ram};
pub use loop_filter::{LoopFilter, LoopFilterState, NOTCHES};
pub use movement::{MOST_OFFSET, MovementCheck, MovementState};
pub use pid::{Pid, PidState, Setpoint};
pub use reference_search::{ReferenceSearch, SearchInput, SearchProgress, SearchState};
pub use trip::{EncoderCheck, FollowingTrip};

use thiserror::Error;

/// Drives of either board stay on for so long without a session \[s\]: time for a PC to come back after a
/// short loss.
pub(crate) const UNATTENDED_S: u8 = 2;

/// An input of a control law is infinite or not a number; the state is as before, hold the last output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("an input of the control law is not finite")]
pub struct NotFinite;
