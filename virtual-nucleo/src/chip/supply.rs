//! Supply, flash interface and system configuration, as far as start-up needs them.

use super::shared::{Peripheral, Shared};
use crate::time::Time;

/// Time for the regulator to reach a voltage (DS13313 gives none; ST's driver waits up to 1 s, the boards take some 10 µs).
const SCALING_TAKES: Time = Time::us(50);
/// Time for the compensation cell to be ready: some periods of the CSI.
const COMPENSATION_TAKES: Time = Time::us(10);

/// Power control (RM0468, 6).
#[derive(Debug)]
pub struct Pwr {
    words: [u32; 16],
    /// The supply is chosen once after power-up.
    chosen: bool,
    ready: Time,
    /// The voltage detector's output.
    low: bool,
}

const CR1: u32 = 0x00;
const CSR1: u32 = 0x04;
const CR3: u32 = 0x0c;
const D3CR: u32 = 0x18;
/// BYPASS, LDOEN, SDEN.
const SUPPLY: u32 = 0x7;
const LDO: u32 = 1 << 1;
const READY: u32 = 1 << 13;
/// PVDE and PVDO.
const DETECTOR_ON: u32 = 1 << 4;
const DETECTOR_OUTPUT: u32 = 1 << 4;
/// Thresholds of the voltage detector by PLS, with the supply rising, and how much lower they are with it falling [mV] (RM0468, 6;
/// DS13313, typical values).
const DETECTOR_MV: [u32; 7] = [1950, 2100, 2250, 2400, 2550, 2700, 2850];
const HYSTERESIS_MV: u32 = 100;

impl Pwr {
    /// After power-up. The supply stays `chosen` through other resets.
    pub fn new(chosen: bool) -> Self {
        let mut words = [0; 16];
        words[CR1 as usize / 4] = 0xf000_c000;
        words[CR3 as usize / 4] = if chosen { LDO } else { 0x6 };
        words[D3CR as usize / 4] = 1 << 14;
        Self {
            words,
            chosen,
            ready: Time::default(),
            low: false,
        }
    }

    /// Output of the voltage detector at this supply.
    pub fn detects_low(&mut self, supply_mv: u32) -> bool {
        let control = self.words[CR1 as usize / 4];
        let threshold = DETECTOR_MV.get((control >> 5 & 7) as usize);
        self.low = match threshold {
            Some(rising) if control & DETECTOR_ON != 0 => {
                supply_mv < rising - if self.low { 0 } else { HYSTERESIS_MV }
            }
            // The other input that can be chosen is a pin, which is not modelled.
            _ => false,
        };
        self.low
    }

    /// Whether the supply was chosen.
    pub fn chosen(&self) -> bool {
        self.chosen
    }
}

impl Peripheral for Pwr {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        let value = self.words.get(offset as usize / 4).copied().unwrap_or(0);
        let ready = if self.chosen && self.ready <= shared.now() {
            READY
        } else {
            0
        };
        match offset {
            CSR1 => {
                let low = if self.detects_low(shared.supply_mv) {
                    DETECTOR_OUTPUT
                } else {
                    0
                };
                self.words[D3CR as usize / 4] & 3 << 14 | ready | low
            }
            D3CR => value & !READY | ready,
            _ => value,
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        match offset {
            CR3 if !self.chosen => {
                if value & SUPPLY != LDO {
                    shared
                        .report("PWR_CR3 does not choose the LDO alone, which is how the board is supplied");
                }
                self.chosen = true;
                self.ready = shared.now() + SCALING_TAKES;
            }
            CR3 if value & SUPPLY != self.words[offset as usize / 4] & SUPPLY => {
                shared
                    .report("PWR_CR3 is written a second time: the supply can be chosen once after power-up");
                return;
            }
            D3CR => {
                if !self.chosen {
                    shared.report("the voltage scaling is changed before PWR_CR3 has chosen the supply");
                }
                self.ready = shared.now() + SCALING_TAKES;
                let before = shared.settings;
                // RM0468, 6.8.6: 0b01 is VOS3, 0b10 VOS2, 0b11 VOS1, 0b00 VOS0.
                shared.settings.scale = [0, 3, 2, 1][(value >> 14 & 3) as usize];
                shared.clocks_changed(&before);
            }
            _ => {}
        }
        if let Some(word) = self.words.get_mut(offset as usize / 4) {
            *word = value;
        }
    }
}

/// The interface of the flash memory (RM0468, 4), without programming.
#[derive(Debug, Default)]
pub struct FlashInterface;

const ACR: u32 = 0x00;
/// FLASH_ACR after a reset.
pub const ACR_RESET: u32 = 0x37;
const FLASH_CR: u32 = 0x0c;
const LOCKED: u32 = 1;

impl Peripheral for FlashInterface {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        match offset {
            ACR => shared.settings.flash_access,
            FLASH_CR => LOCKED,
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        if offset == ACR {
            let before = shared.settings;
            shared.settings.flash_access = value;
            shared.clocks_changed(&before);
        } else {
            shared.report("programming the flash memory is not modelled");
        }
    }
}

/// System configuration (RM0468, 12).
#[derive(Debug, Default)]
pub struct Syscfg {
    words: [u32; 12],
    compensated: Time,
}

const PMCR: u32 = 0x04;
const CCCSR: u32 = 0x20;

impl Peripheral for Syscfg {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        let value = self.words.get(offset as usize / 4).copied().unwrap_or(0);
        let ready = offset == CCCSR && value & 1 != 0 && shared.csi && self.compensated <= shared.now();
        value | u32::from(ready) << 8
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        match offset {
            PMCR => shared.ethernet_interface = value >> 21 & 7,
            CCCSR if value & 1 != 0 => {
                if !shared.csi {
                    shared.report("the compensation cell is switched on without the CSI, which it needs");
                }
                self.compensated = shared.now() + COMPENSATION_TAKES;
            }
            _ => {}
        }
        if let Some(word) = self.words.get_mut(offset as usize / 4) {
            *word = value & !(1 << 8);
        }
    }
}
