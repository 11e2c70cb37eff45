//! The one timebase: TIM5 counts microseconds in 32 bits, extended to 64.

use crate::clocks::TIMER_MHZ;
use crate::counting::{halves_begun, join};
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_stm32::{pac::TIM5, peripherals, rcc};

/// Half ranges (2³¹ µs, 36 minutes) of the counter that have been seen to begin.
static HALVES: AtomicU32 = AtomicU32::new(0);

/// Starts time at zero.
pub(crate) fn start() {
    rcc::enable_and_reset::<peripherals::TIM5>();
    TIM5.psc().write_value((TIMER_MHZ - 1) as u16);
    TIM5.arr().write_value(u32::MAX);
    // The prescaler is taken over at an update.
    TIM5.egr().write(|w| w.set_ug(true));
    TIM5.cr1().modify(|w| w.set_cen(true));
}

/// Time since power-up \[µs\]. May be called at any priority; has to be called every half hour at least, which
/// the ticks do.
pub fn now_us() -> u64 {
    // The order matters: whoever interrupts between the two loads can only have moved `HALVES` on to the half
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
