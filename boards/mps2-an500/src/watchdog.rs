//! The watchdog: the second counter of the dual timer, above every task of the firmware.

use crate::device::Interrupt;
use crate::registers::Block;
use crate::time::TICKS_PER_US;
use cortex_m::peripheral::NVIC;

const LOAD: usize = 0x0;
const CONTROL: usize = 0x8;
/// Enabled, periodic, with interrupt, 32 bits.
const RUN: u32 = 1 << 7 | 1 << 6 | 1 << 5 | 1 << 1;
/// Longest time between two feeds \[µs\].
const TIMEOUT_US: u32 = 50_000;

/// Ends the board unless it is fed. It starts at the first feed.
pub struct Watchdog {
    running: bool,
}

impl Watchdog {
    pub(crate) fn new(nvic: &mut NVIC) -> Self {
        // SAFETY: RTIC masks by priority at most the tasks it knows; this one stays above them all.
        unsafe {
            nvic.set_priority(Interrupt::WATCHDOG, 0);
            NVIC::unmask(Interrupt::WATCHDOG);
        }
        Self { running: false }
    }

    /// The board works: wait again.
    pub fn feed(&mut self) {
        Block::DUAL_TIMER_2.write(LOAD, TIMEOUT_US * TICKS_PER_US as u32);
        if !self.running {
            Block::DUAL_TIMER_2.write(CONTROL, RUN);
            self.running = true;
        }
    }
}

/// Handler of the interrupt.
pub(crate) unsafe extern "C" fn expired() {
    panic!("watchdog: not fed for {} ms", TIMEOUT_US / 1000);
}
