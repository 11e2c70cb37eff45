//! What the tasks do; when they do it stands in `main.rs`.

mod alive;
pub mod control;
mod network;

use heapless::spsc::{Consumer, Producer};
use shared::protocol::{Capture, ClockRequest, TrackerSample};
use shared::tracking::TrackerController;

pub use alive::Alive;
pub use network::Network;

/// Knots the board has room for.
pub const KNOTS: usize = 512;

/// State machine, map and control law.
pub type Controller = TrackerController<KNOTS>;

/// What a control tick publishes.
pub struct Published {
    /// For telemetry.
    pub sample: TrackerSample,
    /// To offer to the PC.
    pub capture: Option<Capture>,
    /// To ask the motion board.
    pub clock_request: Option<ClockRequest>,
}

/// The control tick's end of the queue to the network.
pub type Outbox = Producer<'static, Published>;
/// The network's end of it.
pub type OutboxReader = Consumer<'static, Published>;
