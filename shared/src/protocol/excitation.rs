//! Excitation of one motor and what was captured of it: how a machine is measured before its loops are set.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Servo ticks that are captured, and period of the excitation: 0.512 s, so that lines are 1.953 Hz apart.
pub const CAPTURE_TICKS: usize = 2048;
/// Most samples in one [`CapturePart`].
pub const CAPTURE_PART: usize = 64;

/// A chirp (linear, periodic in [`CAPTURE_TICKS`]) for all motors of an axis alike, of which the last period of one is captured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Excitation {
    /// Index of the motor that is captured.
    pub motor: u8,
    /// What the chirp is added to.
    pub excited: Excited,
    /// Amplitude: mm/s (°/s) of the command, mm (°) of the reference.
    pub amplitude: f64,
    /// Where it begins \[Hz\].
    pub from_hz: f64,
    /// Where it ends \[Hz\].
    pub to_hz: f64,
    /// Periods before the one that is captured, in which what was before dies away.
    pub settle_periods: u8,
    /// Meanwhile the motor goes so far and comes back (mm or °), in 4·`settle_periods` + 2 periods: on the way friction and play
    /// stay on one side. 0: it stays where it stands. Ended early on its way, it trips for its following error.
    pub way: f64,
    /// It ends where the motor is further than this from where it should be (mm or °), or than 32767 counts.
    pub max_travel: f64,
    /// It ends where the drive would be told more than this (mm/s or °/s).
    pub max_speed: f64,
}

/// What an excitation is added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Excited {
    /// The command to the drive, behind the position loop.
    Command,
    /// The reference of the position loop, without feed-forward.
    Reference,
}

/// Why an excitation ended before it was captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema, Error)]
pub enum ExcitationEnd {
    /// The PC asked for it.
    #[error("it was asked to end")]
    Asked,
    /// The motor went too far.
    #[error("the motor was further from its place than max_travel")]
    Travel,
    /// The drive would have been told too much.
    #[error("the drive would have been told more than max_speed")]
    Speed,
    /// Ticks were lost.
    #[error("the board lost ticks")]
    Gap,
    /// The drives went off, for a fault or because they had to.
    #[error("the drives went off")]
    DrivesOff,
}

/// How far a capture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum CaptureState {
    /// Nothing was excited yet.
    #[default]
    Empty,
    /// The motor is being excited.
    Running,
    /// All samples are there.
    Complete,
    /// It ended early; samples may be there.
    Ended(ExcitationEnd),
}

/// One servo tick of the motor that is excited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct CaptureSample {
    /// Code of the converter from this tick to the next, the excitation in it.
    pub command: i16,
    /// Counts at this tick, from where the motor should be without the chirp.
    pub counts: i32,
    /// Following error at this tick (mm or rad), the excitation in it; in steps of 0.0001, up to 3.2767.
    pub error: f32,
}

/// A part of what was captured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct CapturePart {
    /// How far the capture is.
    pub state: CaptureState,
    /// Samples that are there.
    pub taken: u16,
    /// Those from the one that was asked for.
    pub samples: Vec<CaptureSample, CAPTURE_PART>,
}
