//! The watchdog is fed by the servo tick alone, and only while path and network tasks are alive too.

use crate::board::Watchdog;

/// A task that was not seen for so many servo ticks (0.5 s) is dead.
const PATIENCE: u16 = 2000;

/// Who was seen lately.
pub struct RollCall {
    watchdog: Watchdog,
    path: u16,
    network: u16,
}

impl RollCall {
    /// Everyone has a first chance.
    pub fn new(watchdog: Watchdog) -> Self {
        Self {
            watchdog,
            path: PATIENCE,
            network: PATIENCE,
        }
    }

    /// The path task ran.
    pub fn path_ticked(&mut self) {
        self.path = PATIENCE;
    }

    /// The network task ran.
    pub fn network_ran(&mut self) {
        self.network = PATIENCE;
    }

    /// The servo tick ran, inputs and e-stop included: feeds the watchdog if all the others live.
    pub fn servo_ticked(&mut self) {
        self.path = self.path.saturating_sub(1);
        self.network = self.network.saturating_sub(1);
        if self.path > 0 && self.network > 0 {
            self.watchdog.feed();
        }
    }
}
