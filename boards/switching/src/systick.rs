//! The core's timer.

use crate::OneShot;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// SysTick, which counts cycles of the processor.
pub struct SysTick {
    timer: SYST,
    cycles_per_us: u32,
}

impl SysTick {
    /// At rest; it counts `cycles_per_us`, at most 255.
    pub fn new(mut timer: SYST, cycles_per_us: u32) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        Self { timer, cycles_per_us }
    }
}

impl OneShot for SysTick {
    fn start(&mut self, after_us: u16) {
        self.timer.disable_counter();
        self.timer
            .set_reload(u32::from(after_us.max(1)) * self.cycles_per_us);
        self.timer.clear_current();
        self.timer.enable_interrupt();
        self.timer.enable_counter();
    }

    fn stop(&mut self) {
        self.timer.disable_interrupt();
        self.timer.disable_counter();
    }
}
