//! Cyclic data: small, self-contained, the newest wins.

use crate::io::{AXES, LEVELS, MOTORS, SIDES, SLIDES, SwitchedLines};
use crate::state::{State, TrackerFault, TrackerState};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most ticks in one telemetry datagram.
pub const TELEMETRY_BATCH: usize = 5;

/// Samples on their way into a telemetry datagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch<T> {
    samples: Vec<T, TELEMETRY_BATCH>,
}

impl<T> Default for Batch<T> {
    fn default() -> Self {
        Self { samples: Vec::new() }
    }
}

impl<T> Batch<T> {
    /// Takes the next sample; the full batch, once it is.
    pub fn push(&mut self, sample: T) -> Option<Vec<T, TELEMETRY_BATCH>> {
        // There is room: a full batch left with the sample that filled it.
        let stored = self.samples.push(sample).is_ok();
        debug_assert!(stored);
        self.samples.is_full().then(|| core::mem::take(&mut self.samples))
    }
}

/// All datagrams.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[expect(clippy::large_enum_variant, reason = "a datagram lives in one buffer, once")]
pub enum Datagram {
    /// Motion → tracker, every ms.
    PathState(PathState),
    /// Tracker → motion, every ms.
    Permit(Permit),
    /// Tracker → PC, at every strobe.
    Capture(Capture),
    /// PC → tracker, the answer to a capture.
    Measurement(Measurement),
    /// Motion → PC.
    MotionTelemetry(MotionTelemetry),
    /// Tracker → PC.
    TrackerTelemetry(TrackerTelemetry),
    /// PC or tracker → a board: what time is it there?
    ClockRequest(ClockRequest),
    /// The board's answer.
    ClockReply(ClockReply),
}

/// Where the motion board is on its path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PathState {
    /// Counts path ticks; a gap is a lost datagram.
    pub tick: u32,
    /// Motion clock at the tick the values belong to \[µs\].
    pub time_us: u64,
    /// Motion clock when the datagram left \[µs\].
    pub sent_us: u64,
    /// Number of the path.
    pub path_id: u32,
    /// Path position at the tick \[mm\].
    pub s_mm: f64,
    /// Path speed \[mm/s\].
    pub speed_mm_s: f64,
    /// Measured pose at the tick: position \[mm\], T, N.
    pub pose: [f64; 9],
    /// The path asks for tracking.
    pub tracking: bool,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Rate of the superimposed offset of the pose: along M and N \[mm/s\], about T \[rad/s\].
    pub superimposed_rate: [f64; 3],
}

/// Whether the tracker lets the beams burn. Where the path tracks, the motion board opens a gate only on this, and
/// closes it [`PERMIT_US`] after the path state that the last one answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Permit {
    /// [`PathState::tick`] of the newest path state that the tracker had: the permit is as old as that.
    pub tick: u32,
    /// [`PathState::path_id`] of it.
    pub path_id: u32,
    /// Of beam 1 and 2.
    pub sides: [BeamPermit; SIDES],
}

/// A permit is this long valid after the tick of the path state that it answers \[µs\].
pub const PERMIT_US: u32 = 5000;

/// What a beam may do where the path tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum BeamPermit {
    /// Nothing: the slides do not follow the seam, or the tracker has a fault.
    #[default]
    No,
    /// Stay on, but not continue: the seam is followed, but the spot is not on it yet, or not known to be.
    Keep,
    /// Go on: the seam was seen where the spot is, and both slides of the side are on it.
    Open,
}

/// A strobe: both cameras were triggered, the slides latched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Capture {
    /// Counts strobes.
    pub number: u32,
    /// Tracker clock at the strobe \[µs\].
    pub time_us: u64,
    /// The same on the motion board's clock, as the tracker relates them \[µs\].
    pub motion_time_us: u64,
    /// Path position at the strobe \[mm\].
    pub s_mm: f64,
    /// Number of the path.
    pub path_id: u32,
    /// Slides at the strobe, from the encoders \[mm\].
    pub slides_mm: [f64; SLIDES],
    /// Slides at the strobe, as only a simulated machine can know \[mm\].
    pub truth_mm: Option<[f64; SLIDES]>,
}

/// What the PC saw in a capture's images.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Measurement {
    /// Number of the capture.
    pub capture: u32,
    /// Side 1 and 2; `None` where no seam was seen.
    pub sides: [Option<SideMeasurement>; SIDES],
}

/// Where one camera saw the seam, relative to its head's working point moved ahead by the lead.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct SideMeasurement {
    /// Along T, positive ahead: how far the seen point lies beyond the plane of the lead \[mm\].
    pub along_mm: f64,
    /// Along U \[mm\].
    pub delta_u_mm: f64,
    /// Along V \[mm\].
    pub delta_v_mm: f64,
}

/// A few path ticks of the motion board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct MotionTelemetry {
    /// Consecutive ticks, oldest first.
    pub samples: Vec<MotionSample, TELEMETRY_BATCH>,
}

/// One path tick of the motion board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct MotionSample {
    /// Path tick.
    pub tick: u32,
    /// Motion clock at the tick \[µs\].
    pub time_us: u64,
    /// State of the board.
    pub state: State,
    /// Number of the path.
    pub path_id: u32,
    /// Path position at the tick \[mm\].
    pub s_mm: f64,
    /// Path speed \[mm/s\].
    pub speed_mm_s: f64,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Digital outputs that are on, bit 0 the first.
    pub outputs: u8,
    /// Inputs of the process that are high, bit 0 the first.
    pub inputs: u8,
    /// What is commanded at the tick, as parts of full scale: power of the beams that are open, analog outputs.
    pub levels: [f32; LEVELS],
    /// Lines that were switched in the millisecond before the tick, by the board's clock after that began.
    pub switched: SwitchedLines,
    /// Measured axis positions at the tick (mm, rad).
    pub axes: [f64; AXES],
    /// Motor positions as only a simulated machine can know (mm, rad).
    pub truth: Option<[f64; MOTORS]>,
    /// Largest |following error| of each motor since the last sample (mm, rad).
    pub following_error: [f32; MOTORS],
    /// Largest |X1 − X2 − square offset| since the last sample \[mm\].
    pub skew_mm: f32,
    /// What the ticks took; `None` where the board has no processor of its own, as in the simulation.
    pub load: Option<BoardLoad>,
}

/// Execution times of the motion board's ticks, without what interrupted them \[processor cycles; on an emulated
/// board, whose time advances by instructions alone, instructions\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct BoardLoad {
    /// Cycles in a microsecond.
    pub cycles_per_us: u16,
    /// Of the path tick before this one: interpolation, kinematics, filter.
    pub path_tick: u32,
    /// Of the longest servo tick since the last sample.
    pub servo_tick: u32,
    /// Of the longest turn of planning that ended since then.
    pub planning: u32,
    /// Turns of planning that had not ended at the next path tick, since the board was switched on.
    pub planning_missed: u32,
}

/// A few control ticks of the tracker board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TrackerTelemetry {
    /// Consecutive ticks, oldest first.
    pub samples: Vec<TrackerSample, TELEMETRY_BATCH>,
}

/// One control tick of the tracker board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TrackerSample {
    /// Control tick.
    pub tick: u32,
    /// Tracker clock at the tick \[µs\].
    pub time_us: u64,
    /// State of the board.
    pub state: TrackerState,
    /// First fault since the last reset; if it is there while the state is tracking, no beam has a permit.
    pub fault: Option<TrackerFault>,
    /// Slides, from the encoders \[mm\].
    pub slides_mm: [f64; SLIDES],
    /// Slides, as only a simulated machine can know \[mm\].
    pub truth_mm: Option<[f64; SLIDES]>,
    /// Where the control law wants the slides \[mm\].
    pub target_mm: [f64; SLIDES],
    /// Commands as sent to the converter.
    pub dac: [i16; SLIDES],
}

/// Asks a board for its clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ClockRequest {
    /// The asker's clock when it asked \[µs\].
    pub asked_us: u64,
}

/// A board's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ClockReply {
    /// From the request.
    pub asked_us: u64,
    /// The board's clock when the request arrived \[µs\].
    pub received_us: u64,
    /// The board's clock when the reply left \[µs\].
    pub replied_us: u64,
}
