//! The independent watchdog: its own oscillator, and no way to stop it.
//!
//! It keeps running when a debugger halts the core, because the drives do too: a halted board resets.

use embassy_stm32::pac::{
    IWDG1, RCC,
    iwdg::vals::{Key, Pr},
};

/// Time to set the board up: the Ethernet PHY alone may take half a second \[ms\].
const START_MS: u16 = 4000;
/// Time between two feeds, afterwards \[ms\].
const RUN_MS: u16 = 50;

/// Resets the board unless it is fed.
pub struct Watchdog(());

impl Watchdog {
    /// Starts it with the time allowed for setting up.
    pub(crate) fn start() -> Self {
        if RCC.rsr().read().iwdg1rstf() {
            defmt::warn!("the last reset came from the watchdog");
        }
        RCC.rsr().modify(|w| w.set_rmvf(true));
        IWDG1.kr().write(|w| w.set_key(Key::START));
        allow(START_MS);
        Self(())
    }

    /// From now on it bites after 50 ms without food.
    pub(crate) fn tighten(&mut self) {
        allow(RUN_MS);
        self.feed();
    }

    /// Feeds it: to be called by the servo task alone, once it has seen the others alive.
    pub fn feed(&mut self) {
        IWDG1.kr().write(|w| w.set_key(Key::RESET));
    }
}

/// Sets the time to the bite; the oscillator of 32 kHz ticks once a millisecond behind its prescaler.
fn allow(ms: u16) {
    IWDG1.kr().write(|w| w.set_key(Key::ENABLE));
    // A few clocks of a free-running oscillator.
    while IWDG1.sr().read().pvu() || IWDG1.sr().read().rvu() {}
    IWDG1.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
    IWDG1.rlr().write(|w| w.set_rl(ms));
    while IWDG1.sr().read().pvu() || IWDG1.sr().read().rvu() {}
    IWDG1.kr().write(|w| w.set_key(Key::RESET));
}
