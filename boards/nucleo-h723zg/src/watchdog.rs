//! The independent watchdog: its own oscillator, and no way to stop it.
//!
//! It keeps running when a debugger halts the core, because the drives do too: a halted board resets.

use embassy_stm32::pac::IWDG1;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// Time to the first feed: setting up waits half a second for the Ethernet PHY alone \[ms\].
const START_MS: u16 = 4000;
/// Time between two feeds, afterwards \[ms\].
const RUN_MS: u16 = 50;

/// Resets the board unless it is fed.
pub struct Watchdog {
    fed: bool,
}

impl Watchdog {
    /// Starts it with the time allowed for setting up. One unit of its reload value is a millisecond.
    pub(crate) fn start() -> Self {
        key(Key::START);
        key(Key::ENABLE);
        IWDG1.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
        IWDG1.rlr().write(|w| w.set_rl(START_MS));
        // Some clocks of its oscillator, which runs.
        while IWDG1.sr().read().pvu() || IWDG1.sr().read().rvu() {}
        key(Key::RESET);
        Self { fed: false }
    }

    /// The board works: wait again, 50 ms from the first feed on. To be called by the servo task alone, once
    /// it has seen the others alive.
    pub fn feed(&mut self) {
        if !self.fed {
            // Taken over a few milliseconds later, with a later feed.
            key(Key::ENABLE);
            IWDG1.rlr().write(|w| w.set_rl(RUN_MS));
            self.fed = true;
        }
        key(Key::RESET);
    }
}

/// Starts the watchdog if it does not run: for a failure before [`Watchdog::start`].
pub(crate) fn ensure_running() {
    key(Key::START);
}

fn key(key: Key) {
    IWDG1.kr().write(|w| w.set_key(key));
}
