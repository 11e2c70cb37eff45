//! Periodic ticks from the board's two timers.

use crate::registers::Block;
use crate::time::{TICKS_PER_US, now_ticks};

const CONTROL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;
const INTERRUPT: usize = 0xC;
/// Enabled, with interrupt.
const RUN: u32 = 1 | 1 << 3;

/// A running periodic timer. It keeps one interrupt pending and no more, so what was lost is counted by the
/// timebase.
pub struct Tick {
    timer: Block,
    period: u64,
    start: u64,
    seen: u64,
}

impl Tick {
    /// Starts `timer`, one of the board's two, with a period in µs.
    pub(crate) fn start(timer: Block, period_us: u32) -> Self {
        let period = u64::from(period_us) * TICKS_PER_US;
        timer.write(CONTROL, 0);
        timer.write(RELOAD, period as u32 - 1);
        timer.write(VALUE, period as u32 - 1);
        timer.write(INTERRUPT, 1);
        // Read first: a period then ends by the timebase just before the timer says so, never after.
        let start = now_ticks();
        timer.write(CONTROL, RUN);
        Self {
            timer,
            period,
            start,
            seen: 0,
        }
    }

    /// Clears the interrupt; returns the periods since the last call, 1 when none was lost.
    pub fn acknowledge(&mut self) -> u32 {
        let ended = (now_ticks() - self.start) / self.period;
        self.timer.write(INTERRUPT, 1);
        let periods = ended - self.seen;
        self.seen = ended;
        u32::try_from(periods).unwrap_or(u32::MAX)
    }

    /// When the period began that was acknowledged last \[µs\].
    pub fn began_us(&self) -> u64 {
        (self.start + self.seen * self.period) / TICKS_PER_US
    }
}
