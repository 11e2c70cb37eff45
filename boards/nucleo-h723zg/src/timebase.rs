//! The one timebase: TIM5 counts microseconds in 32 bits, extended to 64.

use crate::clocks::{CORE_MHZ, TIMER_MHZ};
use crate::counting::{halves_begun, join};
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::DWT;
use embassy_stm32::{pac::TIM5, peripherals, rcc};

/// Half ranges (2³¹ µs, 36 minutes) of the counter that have been seen to begin.
static HALVES: AtomicU32 = AtomicU32::new(0);

/// Cycles of the processor in a microsecond.
pub const CYCLES_PER_US: u16 = CORE_MHZ as u16;

/// Starts time at zero, and the count of cycles.
pub(crate) fn start(core: &mut cortex_m::Peripherals) {
    core.DCB.enable_trace();
    // Locked after a reset without debugger, on this core.
    DWT::unlock();
    core.DWT.enable_cycle_counter();
    rcc::enable_and_reset::<peripherals::TIM5>();
    TIM5.psc().write_value((TIMER_MHZ - 1) as u16);
    TIM5.arr().write_value(u32::MAX);
    // The prescaler is taken over at an update.
    TIM5.egr().write(|w| w.set_ug(true));
    TIM5.cr1().modify(|w| w.set_cen(true));
}

/// Counts cycles of the processor and wraps, every 8 s.
pub fn cycles() -> u32 {
    DWT::cycle_count()
}

/// Time since power-up \[µs\]. May be called at any priority; has to be called every half hour at least, which
/// the ticks do.
pub fn now_us() -> u64 {
    // The order matters: an interrupt between the two loads can only have moved `HALVES` on to the half
    // that the counter, read later, lies in.
    let seen = HALVES.load(Ordering::SeqCst);
    let count = TIM5.cnt().read();
    let halves = halves_begun(seen, count);
    if halves != seen {
        // Fails only if someone else has made the same step meanwhile.
        let _ = HALVES.compare_exchange(seen, halves, Ordering::SeqCst, Ordering::SeqCst);
    }
    join(halves, count)
}

defmt::timestamp!("{=u64:us}", now_us());
