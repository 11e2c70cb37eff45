//! Requests of the PC and the answers of the boards.

use crate::io::{AXES, MOTORS, SLIDES};
use crate::motion::{Fault, MotionConfig, State};
use crate::parameter::ParameterError;
use crate::tracking::{TrackerConfig, TrackerFault, TrackerState};
use crate::trajectory::{CHANNELS, PathError, PathSpace};
use heapless::{String, Vec};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Most knots in one [`Request::LoadKnots`].
pub const LOAD_BATCH: usize = 6;

/// What the PC may ask. A board answers [`Refusal::NotMine`] to what belongs to the other one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[expect(
    clippy::large_enum_variant,
    reason = "boards do not allocate; one request exists at a time"
)]
pub enum Request {
    /// First request of every session; answered by [`Response::Identity`] even if the hash differs, after
    /// which a board refuses everything else.
    Hello {
        /// [`super::SCHEMA_HASH`] of the PC.
        schema_hash: u64,
    },
    /// Send telemetry and captures to this UDP port of the PC (its address is the one it connected from).
    Subscribe {
        /// UDP port of the PC.
        port: u16,
    },
    /// Answered by [`Response::MotionStatus`] or [`Response::TrackerStatus`]; also keeps the session alive.
    Status,
    /// Parameters of the machine; motion board, only in state off.
    ConfigureMotion(MotionConfig),
    /// Parameters of the machine; tracker board, only in state off.
    ConfigureTracker(TrackerConfig),
    /// Send path states to the tracker board at this address.
    PathStatesTo {
        /// IPv4 address.
        address: [u8; 4],
        /// UDP port.
        port: u16,
    },
    /// Switch the drives on and find the reference marks.
    Home,
    /// Switch the drives off, beams too, at once.
    Disable,
    /// Forget the fault; state off if its cause is gone.
    Reset,
    /// Start a new path: forget the knots and events of the last one.
    ClearPath {
        /// Number of the new path, repeated in [`super::PathState`].
        id: u32,
        /// What its knots are; in axis space no beam and no tracking can be asked for.
        space: PathSpace,
    },
    /// Append knots, `s_mm` strictly increasing. Both boards get the same knots.
    LoadKnots(Vec<Knot, LOAD_BATCH>),
    /// Append an event to the path, `s_mm` not decreasing; motion board.
    LoadEvent(PathEvent),
    /// Run the loaded path from its first knot to its last, from rest to rest; motion board, state idle. The
    /// axes must stand where the path begins.
    Run {
        /// Path speed, until an event changes it \[mm/s\].
        speed_mm_s: f64,
        /// Path acceleration \[mm/s²\].
        acceleration_mm_s2: f64,
        /// Path jerk \[mm/s³\].
        jerk_mm_s3: f64,
    },
    /// Beams off and controlled stop on the path; can resume.
    Hold,
    /// Go on along the path after a hold.
    Resume,
    /// Beams off and controlled stop on the path; the path is given up. While homing: drives off.
    Stop,
}

/// A board's answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Response {
    /// Accepted.
    Done,
    /// Not accepted; nothing changed.
    Refused(Refusal),
    /// Who answers.
    Identity(Identity),
    /// State of the motion board.
    MotionStatus(MotionStatus),
    /// State of the tracker board.
    TrackerStatus(TrackerStatus),
}

/// Which of the two boards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Role {
    /// Motion board.
    Motion,
    /// Tracker board.
    Tracker,
}

/// Who a board is. This type and [`Request::Hello`] stay as they are, so that versions can differ politely.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// [`super::SCHEMA_HASH`] of the board.
    pub schema_hash: u64,
    /// Which board.
    pub role: Role,
    /// Version of the firmware.
    pub firmware: String<16>,
    /// Name of the board crate.
    pub board: String<24>,
    /// The machine behind the axes is simulated on the board; its truth is in the telemetry.
    pub simulated_machine: bool,
}

impl Identity {
    /// A board of this table: `firmware` is a version and `board` the name of a board crate; what does not fit
    /// is left empty.
    pub fn new(role: Role, firmware: &str, board: &str, simulated_machine: bool) -> Self {
        Self {
            schema_hash: super::SCHEMA_HASH,
            role,
            firmware: String::try_from(firmware).unwrap_or_default(),
            board: String::try_from(board).unwrap_or_default(),
            simulated_machine,
        }
    }
}

/// Why a request was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema, Error)]
pub enum Refusal {
    /// The schema hashes differ, or no Hello was sent.
    #[error("PC and board speak different versions of the protocol; flash both from one build")]
    WrongSchema,
    /// The request belongs to the other board.
    #[error("the request belongs to the other board; are the two addresses swapped?")]
    NotMine,
    /// The bytes are no request of this table.
    #[error("the board could not decode the request")]
    Malformed,
    /// No configuration was sent yet.
    #[error("the board has no machine parameters yet")]
    NotConfigured,
    /// Not possible in this state.
    #[error("not possible in state {state:?}")]
    WrongState {
        /// State of the motion board.
        state: State,
    },
    /// Not possible in this state.
    #[error("not possible in state {state:?}")]
    WrongTrackerState {
        /// State of the tracker board.
        state: TrackerState,
    },
    /// The emergency stop is still pressed, or a drive still reports a fault.
    #[error(
        "the cause of the fault is still there: release the emergency stop, clear the drives' faults, then reset"
    )]
    CauseRemains,
    /// A field of the configuration makes no sense.
    #[error("a machine parameter is out of range: {0}")]
    Parameter(ParameterError),
    /// The axes have no reference yet.
    #[error("the axes are not homed")]
    NotHomed,
    /// The path is full.
    #[error("the path has more than {capacity} knots")]
    PathFull {
        /// What fits.
        capacity: u16,
    },
    /// s does not increase, or a value is not finite.
    #[error("knot {index} of the path is out of order or not finite")]
    BadKnot {
        /// Number of the knot.
        index: u16,
    },
    /// An event is not finite, or not positive where it must be, or for a beam that does not exist, out of order, or there are too many.
    #[error("event {index} of the path makes no sense, is out of order or one too many")]
    BadEvent {
        /// Number of the event.
        index: u16,
    },
    /// Fewer than two knots, or limits that are not positive.
    #[error("no path to run: load at least two knots and positive limits")]
    NoPath,
    /// The axes do not stand at the start of the path.
    #[error("axis {} is {distance:.3} mm (or °) away from the start of the path", crate::io::AXIS_NAMES[*axis as usize])]
    NotAtStart {
        /// Index of the axis.
        axis: u8,
        /// How far.
        distance: f32,
    },
}

impl From<PathError> for Refusal {
    fn from(error: PathError) -> Self {
        match error {
            PathError::Full { capacity } => Self::PathFull { capacity },
            PathError::BadKnot { index } => Self::BadKnot { index },
        }
    }
}

/// A knot of the path: between two of them every channel is a cubic Hermite span over s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Knot {
    /// Path length \[mm\].
    pub s_mm: f64,
    /// Position of D (3) \[mm\], T (3), N (3), or the axes (6) and nothing (3), by the path's space; extension of the V slides that keeps the defocus (2) \[mm\].
    pub value: [f64; CHANNELS],
    /// Derivative of each channel over s.
    pub slope: [f64; CHANNELS],
}

/// Something that happens at a path position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PathEvent {
    /// Where.
    pub s_mm: f64,
    /// What.
    pub action: PathAction,
}

/// What happens at a path position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum PathAction {
    /// Open or close the gate of a beam.
    Beam {
        /// 0 or 1.
        side: u8,
        /// Open.
        on: bool,
    },
    /// Set the power of a beam.
    Power {
        /// 0 or 1.
        side: u8,
        /// Power \[W\].
        watt: f64,
    },
    /// Let the tracker follow the seam, or hold the slides at the plan.
    Tracking {
        /// Follow.
        on: bool,
    },
    /// From here on, go at most this fast along the path: the speed comes down before, or goes up from here.
    Speed {
        /// Path speed \[mm/s\].
        mm_s: f64,
    },
}

/// State of the motion board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct MotionStatus {
    /// What it is doing.
    pub state: State,
    /// First fault since the last reset.
    pub fault: Option<Fault>,
    /// All axes have their reference.
    pub homed: bool,
    /// Measured axis positions (mm, degrees).
    pub axes: [f64; AXES],
    /// Commanded axis positions (mm, degrees); as measured while the drives are off. A path starts here.
    pub reference: [f64; AXES],
    /// Number of the loaded path.
    pub path_id: u32,
    /// Position on it \[mm\].
    pub s_mm: f64,
    /// Knots loaded.
    pub knots: u16,
    /// Servo ticks since boot, and how many came too late to be served.
    pub servo_ticks: u32,
    /// Servo ticks lost.
    pub servo_lost: u32,
    /// Path ticks since boot.
    pub path_ticks: u32,
    /// Path ticks lost, or served too late for their references.
    pub path_lost: u32,
    /// Datagrams that could not be sent.
    pub unsent: u32,
    /// Vibration level of each motor's following error, for display only (log2 µm, rough arithmetic).
    pub vibration_level: [f32; MOTORS],
}

/// State of the tracker board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TrackerStatus {
    /// What it is doing.
    pub state: TrackerState,
    /// First fault since the last reset.
    pub fault: Option<TrackerFault>,
    /// All slides have their reference.
    pub homed: bool,
    /// Measured slide positions \[mm\].
    pub slides_mm: [f64; SLIDES],
    /// Number of the loaded path.
    pub path_id: u32,
    /// Knots loaded.
    pub knots: u16,
    /// Control ticks since boot.
    pub ticks: u32,
    /// Control ticks lost.
    pub lost: u32,
    /// Path states received, and how many never came.
    pub path_states: u32,
    /// Path states missing from the sequence.
    pub path_states_missing: u32,
    /// Residual of the clock relation \[µs\].
    pub clock_residual_us: f32,
    /// The relation is settled: enough samples, and a round trip.
    pub clock_settled: bool,
    /// Measurements used, per side.
    pub accepted: [u32; 2],
    /// Measurements rejected as outliers, per side.
    pub rejected: [u32; 2],
    /// Measurements whose capture was older than the history.
    pub too_old: u32,
    /// Datagrams that could not be sent.
    pub unsent: u32,
}
