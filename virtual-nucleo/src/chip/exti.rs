//! Interrupts of pins and other lines (RM0468, 20): of the lines only the voltage detector's is connected.

use super::map::exception;
use super::shared::{Peripheral, Shared};

const WORDS: usize = 0xd0 / 4;
/// Triggers at rising and at falling edges, mask and pending register of lines 0 to 31.
const RTSR1: usize = 0x00;
const FTSR1: usize = 0x04;
const CPUIMR1: usize = 0x80;
const CPUPR1: usize = 0x88;
/// Line of the voltage detectors, PVD and AVD (RM0468, 20).
pub const VOLTAGE_DETECTOR: u32 = 16;
/// Pending registers: written ones clear.
const PENDING: [u32; 3] = [0x88, 0x98, 0xa8];

/// The controller.
#[derive(Debug)]
pub struct Exti {
    words: [u32; WORDS],
    /// Levels of lines 0 to 31.
    lines: u32,
    voltage: Option<u16>,
}

impl Default for Exti {
    fn default() -> Self {
        let mut words = [0; WORDS];
        // CPUIMR1 and CPUIMR2.
        (words[0x80 / 4], words[0x90 / 4]) = (0xffc0_0000, 0xffff_ffff);
        Self {
            words,
            lines: 0,
            voltage: exception("PVD_AVD"),
        }
    }
}

impl Exti {
    /// Gives one of the first 32 lines a level.
    pub fn set_line(&mut self, line: u32, high: bool) {
        let bit = 1 << line;
        if (self.lines & bit != 0) == high {
            return;
        }
        self.lines ^= bit;
        let edges = if high { RTSR1 } else { FTSR1 };
        self.words[CPUPR1 / 4] |= self.words[edges / 4] & bit;
    }
}

impl Peripheral for Exti {
    fn read(&mut self, offset: u32, _: &mut Shared) -> u32 {
        self.words.get(offset as usize / 4).copied().unwrap_or(0)
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, _: &mut Shared) {
        if let Some(word) = self.words.get_mut(offset as usize / 4) {
            *word = if PENDING.contains(&offset) {
                *word & !value
            } else {
                value
            };
        }
    }

    fn asks_for(&self) -> Option<u16> {
        let pending = self.words[CPUPR1 / 4] & self.words[CPUIMR1 / 4];
        self.voltage.filter(|_| pending & 1 << VOLTAGE_DETECTOR != 0)
    }
}
