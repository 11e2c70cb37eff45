//! Requests of the PC and the answers of the boards.

use super::element::{BadElement, PathElement};
use super::excitation::{CapturePart, Excitation};
use super::inputs::Inputs;
use crate::config::{DeviationConfig, MotionConfig, TrackerConfig};
use crate::geometry::PoseOffset;
use crate::io::{AXES, MOTORS, SIDES, SLIDE_NAMES, SLIDES};
use crate::parameter::ParameterError;
use crate::state::{Fault, State, TrackerFault, TrackerState};
use crate::trajectory::{Knot, PathError, PathSpace, Played, PushError};
use heapless::{String, Vec};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Most knots in one [`Request::LoadKnots`].
pub const LOAD_BATCH: usize = 6;
/// Most elements in one [`Request::LoadElements`].
pub const LOAD_ELEMENTS: usize = 4;
/// Most events in one [`Request::LoadEvents`].
pub const LOAD_EVENTS: usize = 32;
/// What moves by hold-to-run goes on for so long after it was last asked for \[ms\].
pub const HOLD_TO_RUN_MS: u32 = 150;

/// What the PC may ask. A board answers [`Refusal::NotMine`] to what belongs to the other one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Request {
    /// First request of every session; answered by [`Response::Identity`] even if the hash differs, after
    /// which a board refuses everything else.
    Hello {
        /// [`super::SCHEMA_HASH`] of the PC.
        schema_hash: u64,
    },
    /// Send telemetry and captures to this UDP port of the PC (its address is the one it connected from), and take
    /// datagrams from there; answered by [`Response::Session`].
    Subscribe {
        /// UDP port of the PC.
        port: u16,
    },
    /// Answered by [`Response::MotionStatus`] or [`Response::TrackerStatus`]; as any request it renews the lease of
    /// the session.
    Status,
    /// What the board reads at its connectors; answered by [`Response::Inputs`], in any state. The motion board tells on a path what it
    /// read before it.
    Inputs,
    /// Parameters of the machine; motion board, only in state off.
    ConfigureMotion(MotionConfig),
    /// A table of measured deviations to make up for, beside those of other axes and motors; motion board, only in state off, after
    /// [`Request::ConfigureMotion`], which forgets all.
    Compensate(DeviationConfig),
    /// Parameters of the machine; tracker board, only in state off.
    ConfigureTracker(TrackerConfig),
    /// Send path states to the tracker board at this address, and take permits from there.
    PathStatesTo {
        /// IPv4 address.
        address: [u8; 4],
        /// UDP port.
        port: u16,
        /// Number of the tracker board's session, which the datagrams of both boards carry.
        session: u32,
    },
    /// Switch the drives on and find the reference marks.
    Home,
    /// Switch the drives off, beams too, at once.
    Disable,
    /// Forget the fault; state off if its cause is gone.
    Reset,
    /// Forget the knots of the last path, a new one begins; tracker board.
    ClearPath {
        /// Number of the new path, repeated in [`super::PathState`].
        id: u32,
        /// What its knots are.
        space: PathSpace,
    },
    /// Append knots of the path that is tracked, `s_mm` strictly increasing; tracker board.
    LoadKnots(Vec<Knot, LOAD_BATCH>),
    /// Move the slides there and keep them there, until another path begins or tracking does; tracker board, state
    /// ready.
    MoveSlides {
        /// U1, V1, U2, V2, inside their travel \[mm\].
        target_mm: [f64; SLIDES],
        /// By hold-to-run: for [`HOLD_TO_RUN_MS`] only, unless asked for again, and no faster than this \[mm/s\]. Then they come
        /// to rest, and stay.
        hold_to_run: Option<f64>,
    },
    /// Move the pose so far beside the planned one, slowly, for as long as the path asks for tracking; motion board,
    /// on a path that does. Takes the place of the last offset.
    OffsetPose(PoseOffset),
    /// Begin a path where the axes stand, which are homed; motion board, state idle. Forgets the last one.
    BeginPath {
        /// Number of the new path, repeated in [`super::PathState`].
        id: u32,
        /// What the channels of its elements are; in axis space no beam and no tracking can be asked for.
        space: PathSpace,
        /// Path length where it begins \[mm\].
        start_s_mm: f64,
        /// Limits along all of it.
        limits: PathLimits,
    },
    /// Append elements to the path, before or while it runs; answered by [`Response::Room`]. Those before one that
    /// is refused are taken.
    LoadElements {
        /// They continue where the last one ends; the first one begins where the axes stand.
        elements: Vec<PathElement, LOAD_ELEMENTS>,
        /// The path is complete; its last element comes to rest.
        last: bool,
    },
    /// Append events to the path, `s_mm` not decreasing, before or while it runs, but before it comes there;
    /// answered by [`Response::Room`]. None is taken if one is refused.
    LoadEvents(Vec<PathEvent, LOAD_EVENTS>),
    /// Run the path from where it begins to the end of its last element; motion board, state idle. Where elements
    /// come too late, the machine waits on the path.
    Run,
    /// Run the path, as [`Request::Run`] does, for [`HOLD_TO_RUN_MS`]; on a path that runs like that, for as long again from now
    /// on. Where that does not come in time, as [`Request::Stop`].
    HoldToRun,
    /// Run the path, as [`Request::Run`] does, until an input of the process is `on` (or off): then as [`Request::Stop`], and
    /// [`MotionStatus::met`] says where that was. Refused where the input is so already.
    RunUntil {
        /// 0 to 3.
        input: u8,
        /// What ends the path: the input comes on, or goes off.
        on: bool,
    },
    /// From now on go at this part of the programmed speed; motion board, at any time.
    Override {
        /// 0 to 2.
        factor: f64,
    },
    /// Go back along the path after a hold, beams off, as far as it is kept or until the next hold.
    Back,
    /// Beams off and controlled stop on the path; can resume.
    Hold,
    /// Go on along the path after a hold. Where a beam was on, the machine first goes back, and the beam goes on
    /// somewhat before the place where it went off, at speed.
    Resume,
    /// Beams off and controlled stop on the path; the path is given up. While homing: drives off. Tracker board: slides that are moved
    /// come to rest, and stay.
    Stop,
    /// Shake one motor where it stands and capture what it does; motion board, state idle, axes homed. Until it has ended the
    /// PC may be silent no longer than on a path, and nothing else moves.
    Excite(Excitation),
    /// No more excitation; at any time.
    EndExcitation,
    /// What was captured, from this sample on; answered by [`Response::Captured`].
    ReadCapture {
        /// Number of the first sample that is wanted.
        from: u16,
    },
}

/// A board's answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[expect(
    clippy::large_enum_variant,
    reason = "boards do not allocate; one answer exists at a time"
)]
pub enum Response {
    /// Accepted.
    Done,
    /// Not accepted; nothing changed.
    Refused(Refusal),
    /// Accepted; so much more of the path can be taken now.
    Room(Room),
    /// Who answers.
    Identity(Identity),
    /// Accepted; the number of this session, which all its datagrams carry.
    Session {
        /// Never 0.
        number: u32,
    },
    /// State of the motion board.
    MotionStatus(MotionStatus),
    /// State of the tracker board.
    TrackerStatus(TrackerStatus),
    /// A part of what was captured.
    Captured(CapturePart),
    /// What the board reads.
    Inputs(Inputs),
}

/// Credits of the PC: what the motion board has room for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Room {
    /// Elements.
    pub elements: u16,
    /// Events.
    pub events: u16,
    /// Path ticks on this path so far: what the request brought is known to the planner from the next one on.
    pub tick: u32,
}

/// Limits along a path, beside those of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PathLimits {
    /// Path acceleration \[mm/s²\].
    pub acceleration_mm_s2: f64,
    /// Path jerk \[mm/s³\].
    pub jerk_mm_s3: f64,
    /// Tolerance that most elements have \[mm\]: decides how far the output filter averages.
    pub tolerance_mm: f64,
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
    /// The emergency stop is still pressed, a drive still reports a fault, or a beam gives power with its gate closed.
    #[error(
        "the cause of the fault is still there: release the emergency stop, clear the drives' faults, cut off a beam that gives power with its gate closed, then reset"
    )]
    CauseRemains,
    /// The channels of the emergency stop disagreed, and have not both been open since.
    #[error(
        "the channels of the emergency stop disagreed: press it fully, so that both of them open, and release it, then reset"
    )]
    EmergencyStopNotTested,
    /// The machine file supervises a power that the board does not measure.
    #[error(
        "the machine file has a readback of beam {}, but the board measures no power there: wire it, or leave the key out", side + 1
    )]
    NoReadback {
        /// 0 or 1.
        side: u8,
    },
    /// A field of the configuration makes no sense.
    #[error("a machine parameter is out of range: {0}")]
    Parameter(ParameterError),
    /// The machine has no such motor.
    #[error("the machine has no motor number {motor}")]
    NoSuchMotor {
        /// Index of the motor.
        motor: u8,
    },
    /// An excitation that the machine cannot do.
    #[error("a motor cannot be excited like that: {0}")]
    Excitation(ParameterError),
    /// Nothing else moves while a motor is excited.
    #[error("a motor is being excited: wait until that has ended, or end it")]
    Exciting,
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
    /// An event is not finite, or not positive where it must be, or for a beam that does not exist, out of order,
    /// or the path has come past it.
    #[error("event {index} of the path is not possible, out of order, or too late")]
    BadEvent {
        /// Number of the event.
        index: u32,
    },
    /// More elements or events than there was room for.
    #[error("the motion board has room for {} elements and {} events only", .room.elements, .room.events)]
    NoRoom {
        /// What fits.
        room: Room,
    },
    /// An element is no piece of path.
    #[error("line {line}: the numbers of the element do not define a line, arc or curve")]
    BadElement {
        /// Line of the program.
        line: u32,
    },
    /// An element does not begin where the one before it ends.
    #[error("line {line}: the path has a gap of {distance} mm (or rad) here")]
    Gap {
        /// Line of the program.
        line: u32,
        /// Largest difference of a channel.
        distance: f32,
    },
    /// An element came after the last one, or the last one does not come to rest.
    #[error("line {line}: the path must come to rest at its last element, and end there")]
    NoEnd {
        /// Line of the program.
        line: u32,
    },
    /// Limits along the path that are not finite and positive.
    #[error("acceleration, jerk and tolerance of a path must be positive")]
    BadLimits,
    /// The override is not from 0 to 2.
    #[error("the override must be from 0 to 200 %")]
    BadOverride,
    /// A slide cannot go there.
    #[error("slide {} cannot go to {target_mm:.3} mm: its travel is {min_mm:.3} to {max_mm:.3} mm", SLIDE_NAMES[*slide as usize])]
    BeyondTravel {
        /// Index of the slide.
        slide: u8,
        /// Where it was asked to go.
        target_mm: f32,
        /// Travel.
        min_mm: f32,
        /// Travel.
        max_mm: f32,
    },
    /// A speed that is not positive and finite.
    #[error("a speed must be positive")]
    BadSpeed,
    /// The path does not ask for tracking.
    #[error("the pose can be offset from the path only where the path has tracking on")]
    NotTracking,
    /// An offset that is not finite, or more than slides could ever ask for.
    #[error("the pose can be offset from the path by {most_mm} mm and {most_deg}° at most")]
    OffsetTooFar {
        /// Along M and N.
        most_mm: f32,
        /// About T.
        most_deg: f32,
    },
    /// The machine has no axes for the pose beside the path.
    #[error("the machine cannot reach the pose with this offset from the path")]
    OffsetUnreachable,
    /// An axis would leave its travel.
    #[error("with this offset from the path, axis {} would be at {position:.3} mm (or °), beyond its travel", crate::io::AXIS_NAMES[*axis as usize])]
    OffsetBeyondTravel {
        /// Index of the axis.
        axis: u8,
        /// Where it would be.
        position: f32,
    },
    /// No elements.
    #[error("no path to run: begin one and load its elements")]
    NoPath,
    /// A path would end before it has begun.
    #[error("input {} is {} already, before the path begins that it is to end", input + 1, if *.on { "on" } else { "off" })]
    InputAlready {
        /// Its number, from 0.
        input: u8,
        /// On.
        on: bool,
    },
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

impl From<BadElement> for Refusal {
    fn from(BadElement { line }: BadElement) -> Self {
        Self::BadElement { line }
    }
}

impl From<PushError> for Refusal {
    fn from(error: PushError) -> Self {
        match error {
            PushError::Full => Self::NoRoom {
                room: Room::default(),
            },
            PushError::Unsound { line } => Self::BadElement { line },
            PushError::Gap { line, distance } => Self::Gap { line, distance },
        }
    }
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
    /// Switch a digital output of the process.
    Output {
        /// 0 to 7.
        output: u8,
        /// On.
        on: bool,
    },
    /// Lead a level from what it is to another value.
    Level {
        /// Which.
        channel: Channel,
        /// Value at the end, in the unit of the machine file.
        value: f64,
        /// Evenly over so much of the path \[mm\]; at once if it is 0.
        over_mm: f64,
    },
    /// A level in proportion to the path speed: it is `value` at `full_mm_s` and above.
    BySpeed {
        /// Which.
        channel: Channel,
        /// Path speed at which it is full \[mm/s\]; 0 lets it no longer depend on the speed.
        full_mm_s: f64,
        /// Part of the value that it keeps at the least, 0 to 1.
        least: f64,
    },
    /// A beam may stay on while the machine goes slower than the least speed of the beam.
    AtRest {
        /// 0 or 1.
        side: u8,
        /// For so long at the most, from when it was fast enough last or went on \[ms\]; 0 takes it back.
        ms: u32,
    },
}

/// An analog output of the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Channel {
    /// Power of a beam \[W\], 0 or 1.
    Power(u8),
    /// Analog output, 0 or 1.
    Analog(u8),
}

impl Channel {
    /// Its place among all: the powers, then the analog outputs.
    pub fn index(self) -> usize {
        match self {
            Self::Power(side) => usize::from(side),
            Self::Analog(output) => SIDES + usize::from(output),
        }
    }
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
    /// What has its reference, one bit a motor, the first one the lowest.
    pub referenced: u8,
    /// What looks for it now; the others wait for their turn.
    pub searching: u8,
    /// Measured axis positions (mm, degrees).
    pub axes: [f64; AXES],
    /// Measured axis positions (mm, degrees), to a servo tick, where the input came that the last path was run until, if it came.
    pub met: Option<[f64; AXES]>,
    /// Commanded axis positions (mm, degrees); as measured while the drives are off. A path starts here.
    pub reference: [f64; AXES],
    /// Number of the loaded path.
    pub path_id: u32,
    /// Position on it \[mm\].
    pub s_mm: f64,
    /// Line of the program there.
    pub line: u32,
    /// Elements of it taken so far.
    pub elements: u32,
    /// What was put out along it so far, before the pose is moved beside it.
    pub played: Played,
    /// Room for more of it.
    pub room: Room,
    /// Part of the programmed speed that is asked for.
    pub speed_override: f64,
    /// Superimposed offset of the pose from the planned one.
    pub superimposed: PoseOffset,
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
    /// Highest vibration of each motor since there are parameters: root mean square of its following error above 10 Hz (mm or
    /// degrees, to some per cent), no more than twice its limit.
    pub vibration: [f32; MOTORS],
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
    /// Which of them have it, one bit a slide.
    pub referenced: u8,
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
    /// Path states that cannot be, and were dropped.
    pub implausible_path_states: u32,
    /// Measurements that cannot be, and were dropped, per side.
    pub implausible_measurements: [u32; 2],
    /// Clock replies that cannot be, and were dropped.
    pub implausible_clock_replies: u32,
    /// How long after its due time the cameras were triggered, at least and at most since boot \[µs\]: the difference is the jitter.
    pub strobe_late_us: [u32; 2],
}
