//! What a board reads at its connectors, as it reads it: for the day on which it is wired.

use crate::io::{ESTOP_CHANNELS, MOTORS, SIDES};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Inputs of a board, before any parameter is applied to them. Bit 0 is the first motor or slide: X1, X2, Y, Z, A, B, C of the
/// motion board, U1, V1, U2, V2 of the tracker board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Inputs {
    /// Counts of gratings or encoders since power-up.
    pub counts: [i64; MOTORS],
    /// Counts at the reference mark that was seen last.
    pub marks: [Option<i64>; MOTORS],
    /// Limit switches at the positive ends that are open.
    pub limit_plus: u8,
    /// Limit switches at the negative ends that are open.
    pub limit_minus: u8,
    /// Drives that do not say that they are ready.
    pub drive_fault: u8,
    /// A converter did not read back what it was told; the board's log says which. All outputs are off until a reset.
    pub converter_failed: bool,
    /// Channels of the emergency stop that are open.
    pub estop: [bool; ESTOP_CHANNELS],
    /// Sources that report a fault; motion board.
    pub laser_fault: [bool; SIDES],
    /// Inputs of the process that are on; motion board.
    pub process: u8,
}

impl Inputs {
    /// Nothing was read yet.
    pub const NONE: Self = Self {
        counts: [0; MOTORS],
        marks: [None; MOTORS],
        limit_plus: 0,
        limit_minus: 0,
        drive_fault: 0,
        converter_failed: false,
        estop: [false; ESTOP_CHANNELS],
        laser_fault: [false; SIDES],
        process: 0,
    };
}
