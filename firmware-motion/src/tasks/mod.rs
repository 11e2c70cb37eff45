//! What the tasks do; when they do it stands in `main.rs`.

pub mod network;
pub mod path;
pub mod planning;
pub mod servo;

use heapless::spsc::{Consumer, Producer};
use shared::alive_supervision::AliveSupervision;
use shared::execution_time::ExecutionTime;
use shared::motion::MotionController;
use shared::protocol::{MotionSample, PathState};

pub use network::Network;
pub use path::PathTask;
pub use planning::PlanningTask;
pub use servo::Servo;

/// Who must be seen for the servo tick to feed the watchdog, every 2000 servo ticks (0.5 s) at least.
pub const ALIVE_SUPERVISION: AliveSupervision<2> = AliveSupervision::new(2000);
/// The path task's number in the alive supervision.
pub const PATH_TASK: usize = 0;
/// The network task's number in the alive supervision.
pub const NETWORK_TASK: usize = 1;

/// State machine, path and homing.
pub type Controller = MotionController;

/// What path ticks and turns of planning take, each without what interrupted it.
pub struct Times {
    /// Of path ticks.
    pub path: ExecutionTime,
    /// Of turns of planning.
    pub planning: ExecutionTime,
}

impl Times {
    /// Of tasks that never ran.
    pub const fn new() -> Self {
        Self {
            path: ExecutionTime::new(),
            planning: ExecutionTime::new(),
        }
    }
}

/// What a path tick publishes.
pub type Published = (PathState, MotionSample);
/// The path tick's end of the queue to the network.
pub type Outbox = Producer<'static, Published>;
/// The network's end of it.
pub type OutboxReader = Consumer<'static, Published>;
