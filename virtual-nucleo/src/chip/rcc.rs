//! Reset and clock control (RM0468, 8).

use super::shared::{Peripheral, Reset, Shared};
use crate::armv7m::NMI;
use crate::time::Time;

const CR: u32 = 0x00;
const CFGR: u32 = 0x10;
const D1CFGR: u32 = 0x18;
const D3CFGR: u32 = 0x20;
const PLLCKSELR: u32 = 0x28;
const PLLCFGR: u32 = 0x2c;
const PLL1DIVR: u32 = 0x30;
const PLL3FRACR: u32 = 0x44;
const CIFR: u32 = 0x64;
const CICR: u32 = 0x68;
const CSR: u32 = 0x74;
const RSR: u32 = 0xd0;
const AHB1ENR: u32 = 0xd8;
/// Clocks of the Ethernet controller: bus, transmitter, receiver.
const ETHERNET: u32 = 7 << 15;
const WORDS: usize = 0x180 / 4;

/// Bits of CR that switch an oscillator or PLL on; the bit that says it is ready; its name; how long that takes
/// (DS13313, 6.3.9 to 6.3.12, the longest time given).
const SWITCHES: [(u32, u32, &str, Time); 7] = [
    (0, 2, "HSI", Time::us(2)),
    (7, 8, "CSI", Time::us(2)),
    (12, 13, "HSI48", Time::us(6)),
    // With an external clock: some of its periods.
    (16, 17, "HSE", Time::us(2)),
    (24, 25, "PLL1", Time::us(150)),
    (26, 27, "PLL2", Time::us(150)),
    (28, 29, "PLL3", Time::us(150)),
];
/// The same of the oscillator of the watchdog, in CSR.
const LSI_READY: Time = Time::us(130);
/// Oscillators that can clock the system, by SW: the bit that says they are ready.
const SYSTEM: [(u32, &str); 4] = [(2, "HSI"), (8, "CSI"), (17, "HSE"), (25, "PLL1")];
const PLLS: [u32; 3] = [24, 26, 28];
/// HSEON and HSECSSON of CR; HSECSSF of CIFR.
const HSE_ON: u32 = 1 << 16;
const SECURITY_ON: u32 = 1 << 19;
const SECURITY_FLAG: u32 = 1 << 10;
/// RSR: flags cleared by RMVF; after power-up; watchdog; software; pin.
const RMVF: u32 = 1 << 16;
const POWER_UP: u32 = 0x00e8_0000;
const PIN_RESET: u32 = 1 << 22;
const SOFTWARE_RESET: u32 = 1 << 24;
const WATCHDOG_RESET: u32 = 1 << 26;

/// The clock controller.
#[derive(Debug)]
pub struct Rcc {
    words: [u32; WORDS],
    /// When what is switched on will be ready, in the order of [`SWITCHES`]; the last is the LSI.
    ready: [Time; SWITCHES.len() + 1],
}

impl Rcc {
    /// After power-up, or after a reset for this cause.
    pub fn new(cause: Option<Reset>) -> Self {
        let mut words = [0; WORDS];
        let flags = match cause {
            None => POWER_UP,
            Some(Reset::Watchdog) => WATCHDOG_RESET | PIN_RESET,
            Some(Reset::Software) => SOFTWARE_RESET | PIN_RESET,
        };
        for (offset, value) in [
            (CR, 0x25),
            (PLLCKSELR, 0x0202_0200),
            (PLLCFGR, 0x01ff_0000),
            (PLL1DIVR, 0x0101_0280),
            (0x38, 0x0101_0280),
            (0x40, 0x0101_0280),
            (RSR, flags),
        ] {
            words[offset as usize / 4] = value;
        }
        let mut ready = [Time::NEVER; SWITCHES.len() + 1];
        ready[0] = Time::default();
        Self { words, ready }
    }

    /// A register as it was written.
    pub fn word(&self, offset: u32) -> u32 {
        self.words.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// Whether the two registers' bits that clock the core say so: `bit` of the register at `offset`.
    pub fn is_set(&self, (offset, bit): (u32, u32)) -> bool {
        self.word(offset) & 1 << bit != 0
    }

    fn control(&self, now: Time) -> u32 {
        let mut value = self.word(CR);
        for ((on, ready, ..), at) in SWITCHES.iter().zip(self.ready) {
            value &= !(1 << ready);
            if value & 1 << on != 0 && at <= now {
                value |= 1 << ready;
            }
        }
        value
    }

    fn write_control(&mut self, value: u32, shared: &mut Shared) {
        let (now, before) = (shared.now(), self.control(shared.now()));
        let system = SYSTEM
            .get((self.word(CFGR) & 7) as usize)
            .map(|(ready, _)| *ready);
        for (index, &(on, ready, name, takes)) in SWITCHES.iter().enumerate() {
            let (was, is) = (before & 1 << on != 0, value & 1 << on != 0);
            if is && !was {
                let never = name == "HSE" && shared.hse_failed;
                self.ready[index] = if never { Time::NEVER } else { now + takes };
                if on == PLLS[0] {
                    self.check_pll1(shared);
                }
            }
            if was && !is && system == Some(ready) {
                shared.report(format!("{name} is switched off while it clocks the core"));
            }
        }
        self.words[CR as usize / 4] = value;
        shared.csi = value & 1 << 7 != 0;
    }

    /// The HSE stops. With the clock security on the core goes on with the HSI, and gets the interrupt that nothing masks
    /// (RM0468, 8).
    pub fn hse_fails(&mut self, shared: &mut Shared) {
        let control = self.control(shared.now());
        self.ready[3] = Time::NEVER;
        let (source, system) = (self.word(PLLCKSELR) & 3, self.word(CFGR) >> 3 & 7);
        let clocks_core = system == 2 || system == 3 && source == 2;
        if control & SECURITY_ON != 0 && control & HSE_ON != 0 {
            self.words[CR as usize / 4] &= !HSE_ON;
            self.words[CIFR as usize / 4] |= SECURITY_FLAG;
            if source == 2 {
                for pll in PLLS {
                    self.words[CR as usize / 4] &= !(1 << pll);
                }
            }
            if clocks_core {
                self.words[CFGR as usize / 4] &= !0x3f;
                let before = shared.settings;
                shared.settings.cfgr = self.word(CFGR);
                shared.clocks_changed(&before);
            }
            shared.system.nvic.pend(NMI);
        } else if clocks_core {
            shared.report("the HSE fails, and its clock security is off: the core stops");
            shared.stopped = true;
        }
    }

    fn check_pll1(&self, shared: &mut Shared) {
        let (source, name) = match self.word(PLLCKSELR) & 3 {
            0 => (2, "HSI"),
            1 => (8, "CSI"),
            2 => (17, "HSE"),
            _ => (31, "no oscillator"),
        };
        if self.control(shared.now()) & 1 << source == 0 {
            shared.report(format!(
                "PLL1 is switched on with {name} as its source, which is not ready"
            ));
        }
        let clocks = super::clocks::Clocks::of(&shared.settings);
        for violation in clocks.pll1_violations(&shared.settings) {
            shared.report(violation);
        }
    }

    /// Bits of PLLCKSELR that a PLL which is on protects.
    fn protected(&self) -> u32 {
        let on = |index: usize| self.word(CR) & 1 << PLLS[index] != 0;
        let mut bits = 0;
        for index in 0..3 {
            if on(index) {
                bits |= 0x3f << (4 + 8 * index) | 3;
            }
        }
        bits
    }

    fn write_configuration(&mut self, value: u32, shared: &mut Shared) {
        let wanted = (value & 7) as usize;
        let running = self.word(CFGR) >> 3 & 7;
        let taken = match SYSTEM.get(wanted) {
            Some((ready, _)) if self.control(shared.now()) & 1 << ready != 0 => wanted as u32,
            other => {
                let name = other.map_or("a reserved source", |(_, name)| *name);
                shared.report(format!("the core is switched to {name}, which is not ready"));
                running
            }
        };
        self.words[CFGR as usize / 4] = value & !0x38 | taken << 3;
    }
}

impl Peripheral for Rcc {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        let value = self.word(offset);
        match offset {
            CR => self.control(shared.now()),
            CSR if value & 1 != 0 && self.ready[SWITCHES.len()] <= shared.now() => value | 2,
            CSR => value & !2,
            _ => value,
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        match offset {
            CR => self.write_control(value, shared),
            CFGR => self.write_configuration(value, shared),
            PLLCKSELR => {
                let kept = self.protected();
                self.words[offset as usize / 4] = self.word(offset) & kept | value & !kept;
            }
            PLL1DIVR if self.word(CR) & 1 << PLLS[0] != 0 && self.word(offset) != value => {
                shared.report("the dividers of PLL1 are written while it is on: the write is lost");
            }
            RSR => {
                if value & RMVF != 0 {
                    self.words[offset as usize / 4] = 0;
                }
            }
            CICR => self.words[CIFR as usize / 4] &= !value,
            CSR => {
                if value & !self.word(CSR) & 1 != 0 {
                    self.ready[SWITCHES.len()] = shared.now() + LSI_READY;
                }
                self.words[offset as usize / 4] = value;
            }
            _ => {
                if let Some(word) = self.words.get_mut(offset as usize / 4) {
                    *word = value;
                }
            }
        }
        shared.ethernet_clocks = self.word(AHB1ENR) & ETHERNET == ETHERNET;
        if (CFGR..=PLL3FRACR).contains(&offset) {
            let before = shared.settings;
            let settings = &mut shared.settings;
            settings.cfgr = self.word(CFGR);
            settings.domains = [D1CFGR, D1CFGR + 4, D3CFGR].map(|offset| self.word(offset));
            settings.pll_source = self.word(PLLCKSELR);
            settings.pll_config = self.word(PLLCFGR);
            settings.pll1_dividers = self.word(PLL1DIVR);
            shared.clocks_changed(&before);
        }
    }

    fn asks_for(&self) -> Option<u16> {
        (self.word(CIFR) & SECURITY_FLAG != 0).then_some(NMI)
    }
}
