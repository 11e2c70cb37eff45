//! What the tasks do; when they do it stands in `main.rs`.

pub mod network;
pub mod path;
pub mod roll_call;
pub mod servo;

use heapless::spsc::{Consumer, Producer};
use shared::motion::MotionController;
use shared::protocol::{MotionSample, PathState};

pub use network::Network;
pub use roll_call::RollCall;
pub use servo::Servo;

/// Knots the board has room for.
pub const KNOTS: usize = 512;

/// State machine, path and homing.
pub type Controller = MotionController<KNOTS>;

/// What a path tick publishes.
pub type Published = (PathState, MotionSample);
/// The path tick's end of the queue to the network.
pub type Outbox = Producer<'static, Published>;
/// The network's end of it.
pub type OutboxReader = Consumer<'static, Published>;
