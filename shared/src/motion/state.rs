//! The states of the motion board.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What the motion board is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum State {
    /// Drives off.
    #[default]
    Off,
    /// Drives on, looking for reference marks.
    Homing,
    /// Drives on, holding position.
    Idle,
    /// On the path.
    Running,
    /// Stopped or stopping on the path, can resume.
    Holding,
    /// Stopping on the path, then idle; the path is given up.
    Stopping,
    /// Drives off after a fault, until it is reset.
    Fault,
}
