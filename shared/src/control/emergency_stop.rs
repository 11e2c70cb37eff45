//! The two channels of the emergency stop, compared with each other.

use crate::io::ESTOP_CHANNELS;

/// The channels may differ for so long \[µs\]: contacts of one button open and close a few tens of milliseconds apart, and a
/// hand that presses or releases it slowly takes longer. Half a second is usual for two-channel inputs of safety
/// controllers (the Dual Channel Input Stop of GuardLogix); times below a few tens of milliseconds are for
/// electronic outputs such as those of light curtains.
pub const DISCREPANCY_US: u32 = 500_000;

/// State of the channels of the emergency stop. Either one open stops; one that is open alone for longer than
/// [`DISCREPANCY_US`] shows that one of them does not work. That is remembered until both were open at once, for only
/// then both contacts are known to open (the switch test of safety inputs), whatever they do in between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EmergencyStop {
    open: [bool; ESTOP_CHANNELS],
    /// How long they have differed.
    differ_us: u32,
    stayed_closed: Option<u8>,
}

impl EmergencyStop {
    /// Both closed.
    pub const fn new() -> Self {
        Self {
            open: [false; ESTOP_CHANNELS],
            differ_us: 0,
            stayed_closed: None,
        }
    }

    /// The channels that are `open` now, `elapsed_us` after the last look.
    pub fn step(&mut self, open: [bool; ESTOP_CHANNELS], elapsed_us: u32) {
        self.open = open;
        if open[0] == open[1] {
            self.differ_us = 0;
            if open[0] {
                self.stayed_closed = None;
            }
            return;
        }
        self.differ_us = self.differ_us.saturating_add(elapsed_us);
        if self.differ_us > DISCREPANCY_US {
            self.stayed_closed = Some(u8::from(open[0]));
        }
    }

    /// Channels that are open.
    pub fn open(&self) -> [bool; ESTOP_CHANNELS] {
        self.open
    }

    /// Either channel is open.
    pub fn is_pressed(&self) -> bool {
        self.open[0] || self.open[1]
    }

    /// The channel that stayed closed while the other one was open for too long, until both were open.
    pub fn stayed_closed(&self) -> Option<u8> {
        self.stayed_closed
    }
}
