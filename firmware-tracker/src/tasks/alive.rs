//! The watchdog is fed by the control tick, and only while the network task is alive too.

use crate::board::Watchdog;

/// A network task that was not seen for so many control ticks (0.5 s) is dead.
const PATIENCE: u16 = 500;

/// Who was seen lately.
pub struct Alive {
    watchdog: Watchdog,
    network: u16,
}

impl Alive {
    /// Everyone has a first chance.
    pub fn new(watchdog: Watchdog) -> Self {
        Self {
            watchdog,
            network: PATIENCE,
        }
    }

    /// The network task ran.
    pub fn network_ran(&mut self) {
        self.network = PATIENCE;
    }

    /// The control tick ran.
    pub fn ticked(&mut self) {
        self.network = self.network.saturating_sub(1);
        if self.network > 0 {
            self.watchdog.feed();
        }
    }
}
