//! The one timebase: the first counter of the dual timer, extended to 64 bits.

use crate::registers::Block;
use core::cell::Cell;
use cortex_m::interrupt::{self, Mutex};

/// Ticks of the timebase, and of the tick timers, in a microsecond.
pub const TICKS_PER_US: u64 = 25;

/// Length of a tick \[ns\].
pub const TICK_NS: u64 = 1000 / TICKS_PER_US;

const LOAD: usize = 0x0;
const VALUE: usize = 0x4;
const CONTROL: usize = 0x8;
/// Enabled, free running, 32 bits, no interrupt.
const FREE_RUN: u32 = 0x82;

static LAST: Mutex<Cell<u64>> = Mutex::new(Cell::new(0));

/// Starts the timebase at zero. Done once, before interrupts run.
pub fn start() {
    Block::DUAL_TIMER_1.write(LOAD, !0);
    Block::DUAL_TIMER_1.write(CONTROL, FREE_RUN);
}

/// Ticks of 40 ns since start. The counter is read at every tick of the board, far more often than it wraps
/// (172 s), so a wrap is never missed.
pub fn now_ticks() -> u64 {
    interrupt::free(|token| {
        let last = LAST.borrow(token);
        let elapsed = (!Block::DUAL_TIMER_1.read(VALUE)).wrapping_sub(last.get() as u32);
        let now = last.get() + u64::from(elapsed);
        last.set(now);
        now
    })
}

/// Instructions that the board executes in a microsecond, as it is emulated (see the `emulator` crate).
pub const CYCLES_PER_US: u16 = 125;

/// Counts instructions, in steps of 5, and wraps. The real board counts cycles.
pub fn cycles() -> u32 {
    (now_ticks() * (u64::from(CYCLES_PER_US) / TICKS_PER_US)) as u32
}

/// Time since start \[µs\]. Callable at any priority.
pub fn now_us() -> u64 {
    now_ticks() / TICKS_PER_US
}
