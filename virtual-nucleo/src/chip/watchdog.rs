//! The independent watchdog (RM0468, 49).

use super::clocks::LSI_HZ;
use super::shared::{Peripheral, Reset, Shared};
use crate::time::Time;

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0c;
const WINR: u32 = 0x10;
const START: u32 = 0xcccc;
const UNLOCK: u32 = 0x5555;
const FEED: u32 = 0xaaaa;
/// Periods of its oscillator, divided by 4 at least, until a register is taken over (RM0468, 49.4.4: up to five).
const TAKES_OVER: u64 = 5;

/// The watchdog.
#[derive(Debug)]
pub struct Watchdog {
    runs: bool,
    unlocked: bool,
    prescaler: u32,
    reload: u32,
    /// Until when the registers are being taken over.
    busy: [Time; 2],
    /// When it resets the chip.
    strikes: Time,
}

impl Default for Watchdog {
    fn default() -> Self {
        Self {
            runs: false,
            unlocked: false,
            prescaler: 0,
            reload: 0xfff,
            busy: [Time::default(); 2],
            strikes: Time::NEVER,
        }
    }
}

impl Watchdog {
    /// Time from a feed to the reset.
    fn patience(&self) -> Time {
        Time::periods(u64::from(self.reload) + 1, LSI_HZ / (4 << self.prescaler.min(6)))
    }

    fn feed(&mut self, now: Time) {
        if self.runs {
            self.strikes = now + self.patience();
        }
    }
}

impl Peripheral for Watchdog {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        let busy = self.busy.map(|until| u32::from(until > shared.now()));
        match offset {
            PR => self.prescaler,
            RLR => self.reload,
            SR => busy[0] | busy[1] << 1,
            WINR => 0xfff,
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        let now = shared.now();
        let takes = Time::periods(TAKES_OVER * (4 << self.prescaler.min(6)), LSI_HZ);
        match (offset, value) {
            (KR, START) => {
                if !self.runs {
                    self.runs = true;
                    shared.outside.watchdog_runs();
                    self.feed(now);
                }
            }
            (KR, UNLOCK) => self.unlocked = true,
            (KR, FEED) => {
                self.unlocked = false;
                self.feed(now);
            }
            (KR, _) => self.unlocked = false,
            (PR | RLR | WINR, _) if !self.unlocked => {
                shared.report("a register of the watchdog is written while it is locked: the write is lost");
            }
            (PR, _) => {
                self.prescaler = value & 7;
                self.busy[0] = now + takes;
            }
            (RLR, _) => {
                self.reload = value & 0xfff;
                self.busy[1] = now + takes;
            }
            _ => shared.report("the window of the watchdog is not modelled"),
        }
    }

    fn due(&self) -> Time {
        self.strikes
    }

    fn advance(&mut self, shared: &mut Shared) {
        if self.strikes <= shared.now() {
            let patience = self.patience();
            shared.report(format!(
                "the watchdog was not fed for {patience}: it resets the chip"
            ));
            self.strikes = Time::NEVER;
            shared.reset = Some(Reset::Watchdog);
        }
    }
}
