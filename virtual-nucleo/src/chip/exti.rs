//! Interrupts of pins and other lines (RM0468, 20): registers only, no line raises one yet.

use super::shared::{Peripheral, Shared};

const WORDS: usize = 0xd0 / 4;
/// Pending registers: written ones clear.
const PENDING: [u32; 3] = [0x88, 0x98, 0xa8];

/// The controller.
#[derive(Debug)]
pub struct Exti([u32; WORDS]);

impl Default for Exti {
    fn default() -> Self {
        let mut words = [0; WORDS];
        // CPUIMR1 and CPUIMR2.
        (words[0x80 / 4], words[0x90 / 4]) = (0xffc0_0000, 0xffff_ffff);
        Self(words)
    }
}

impl Peripheral for Exti {
    fn read(&mut self, offset: u32, _: &mut Shared) -> u32 {
        self.0.get(offset as usize / 4).copied().unwrap_or(0)
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, _: &mut Shared) {
        if let Some(word) = self.0.get_mut(offset as usize / 4) {
            *word = if PENDING.contains(&offset) {
                *word & !value
            } else {
                value
            };
        }
    }
}
