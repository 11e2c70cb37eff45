//! What the tasks do; when they do it stands in `main.rs`.

pub mod control;
mod network;

use heapless::spsc::{Consumer, Producer};
use shared::alive_supervision::AliveSupervision;
use shared::protocol::{Capture, Permit, TrackerSample};
use shared::tracking::TrackerController;

pub use network::Network;

/// Knots the board has room for.
pub const KNOTS: usize = 512;

/// Who must be seen for the control tick to feed the watchdog: the network task, every 500 control ticks
/// (0.5 s) at least.
pub type Alive = AliveSupervision<1>;
/// Everyone has a first chance.
pub const ALIVE_SUPERVISION: Alive = AliveSupervision::new(500);
/// The network task's number in the alive supervision.
pub const NETWORK_TASK: usize = 0;

/// State machine, map and control law.
pub type Controller = TrackerController<KNOTS>;

/// What a control tick publishes.
pub struct Published {
    /// For telemetry.
    pub sample: TrackerSample,
    /// To offer to the PC.
    pub capture: Option<Capture>,
    /// For the motion board.
    pub permit: Option<Permit>,
    /// Whether to ask the motion board for its clock.
    pub clock_request: bool,
}

/// The control tick's end of the queue to the network.
pub type Outbox = Producer<'static, Published>;
/// The network's end of it.
pub type OutboxReader = Consumer<'static, Published>;
