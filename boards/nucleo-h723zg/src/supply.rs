//! Supply and clock as faults: either ends in outputs off and a reset, before the core runs wild.

use embassy_stm32::interrupt::{Interrupt, Priority};
use embassy_stm32::pac::{EXTI, PWR, RCC};

/// Highest threshold of the voltage detector: 2.85 V with the supply rising, some 0.1 V less with it falling. The
/// board has 3.3 V; the chip works down to 1.62 V, so what is left is time.
const LEVEL_2V85: u8 = 0b110;
/// Line of the voltage detector at the interrupt controller of the pins.
const LINE: usize = 16;

/// Lets the voltage detector settle: to be called before the clocks are set up.
pub(crate) fn start() {
    PWR.cr1().modify(|w| {
        w.set_pls(LEVEL_2V85);
        w.set_pvde(true);
    });
}

/// From here on both are faults: the supply through an interrupt above every task, and the ST-LINK's clock
/// through the one that nothing masks. To be called when that clock runs the core. Should it fail, the chip
/// continues with its own oscillator at 64 MHz: too slow for the loops, fast enough for the handler.
pub(crate) fn watch(core: &mut cortex_m::Peripherals) {
    RCC.cr().modify(|w| w.set_hsecsson(true));

    // The detector's output rises when the supply falls.
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    // SAFETY: no task of the firmware is masked by this priority, or counts on being above it.
    unsafe {
        core.NVIC.set_priority(Interrupt::PVD_AVD, Priority::P0 as u8);
        cortex_m::peripheral::NVIC::unmask(Interrupt::PVD_AVD);
    }
    // Below the threshold already: there was no edge, or it was cleared above.
    if PWR.csr1().read().pvdo() {
        cortex_m::peripheral::NVIC::pend(Interrupt::PVD_AVD);
    }
}
