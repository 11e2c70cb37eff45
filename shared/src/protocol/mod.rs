//! Messages between the PC and the boards: one table, used by both ends.
//!
//! Requests and responses travel in order on a TCP stream ([`framing`]); cyclic data travel as UDP datagrams
//! where the newest wins ([`Datagram`]). Everything is postcard. The hash of all types is compared at
//! connect ([`Request::Hello`]) and stands before every datagram, so two versions that differ never talk.

mod datagram;
mod element;
mod excitation;
pub mod framing;
mod inputs;
mod request;

pub use datagram::{
    Batch, BeamPermit, BoardLoad, Capture, ClockReply, ClockRequest, Datagram, Measurement, MotionSample,
    MotionTelemetry, PERMIT_US, PathState, Permit, SideMeasurement, TELEMETRY_BATCH, TrackerSample,
    TrackerTelemetry,
};
pub use element::{BadElement, PathChannel, PathElement, PathJoin, PathShape};
pub use excitation::{
    CAPTURE_PART, CAPTURE_TICKS, CapturePart, CaptureSample, CaptureState, Excitation, ExcitationEnd, Excited,
};
pub use inputs::Inputs;
pub use request::{
    Channel, HOLD_TO_RUN_MS, Identity, LOAD_BATCH, LOAD_ELEMENTS, LOAD_EVENTS, MotionStatus, PathAction,
    PathEvent, PathLimits, Refusal, Request, Response, Role, Room, TrackerStatus,
};

/// TCP port of the requests, on both boards.
pub const REQUEST_PORT: u16 = 7100;
/// UDP port of the datagrams, on both boards.
pub const DATAGRAM_PORT: u16 = 7101;

/// Hash of every type on the wire; equal only if both ends were built from the same table.
pub const SCHEMA_HASH: u64 = {
    let request = postcard_schema::key::Key::for_path::<Request>("request").to_bytes();
    let response = postcard_schema::key::Key::for_path::<Response>("response").to_bytes();
    let datagram = postcard_schema::key::Key::for_path::<Datagram>("datagram").to_bytes();
    u64::from_le_bytes(request)
        ^ u64::from_le_bytes(response).rotate_left(21)
        ^ u64::from_le_bytes(datagram).rotate_left(42)
};
