//! The LAN8742A on the board (data sheet DS00001989, 4), with its strapped address 0.

use crate::time::Time;

/// Time of a reset by software; IEEE 802.3, 22.2.4.1.1 allows half a second.
const RESET_TAKES: Time = Time::ms(1);
/// Time of the negotiation: the order of what two partners of 100 Mbit/s take.
const NEGOTIATION_TAKES: Time = Time::ms(1500);
const ADDRESS: u32 = 0;
const CONTROL: u32 = 0;
const STATUS: u32 = 1;
const RESET: u16 = 1 << 15;
const NEGOTIATE: u16 = 1 << 12;
const RESTART: u16 = 1 << 9;
const CONTROL_RESET: u16 = NEGOTIATE | 1 << 13;
/// Abilities; negotiated and link up.
const ABILITIES: u16 = 0x7809;
const NEGOTIATED: u16 = 1 << 5 | 1 << 2;
const IDENTIFIERS: [u16; 2] = [0x0007, 0xc131];
/// Advertisement: 100 Mbit/s full duplex, and as after a reset.
const FULL_100: u16 = 1 << 8;
const ADVERTISEMENT_RESET: u16 = 0x01e1;

/// What is wrong with the PHY.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PhyFault {
    /// It answers no management frame.
    pub silent: bool,
    /// It gives no clock.
    pub no_clock: bool,
}

/// The PHY.
#[derive(Clone, Debug)]
pub struct Phy {
    /// What is wrong with it.
    pub fault: PhyFault,
    control: u16,
    advertisement: u16,
    reset_until: Time,
    link_from: Time,
}

impl Default for Phy {
    /// It negotiates from power-up on.
    fn default() -> Self {
        Self {
            fault: PhyFault::default(),
            control: CONTROL_RESET,
            advertisement: ADVERTISEMENT_RESET,
            reset_until: Time::default(),
            link_from: NEGOTIATION_TAKES,
        }
    }
}

impl Phy {
    /// Whether frames pass.
    pub fn link(&self, now: Time) -> bool {
        self.link_from <= now && self.advertisement & FULL_100 != 0 && !self.fault.no_clock
    }

    /// Reads a register; all ones where nothing answers.
    pub fn read(&self, address: u32, register: u32, now: Time) -> u16 {
        if self.fault.silent || address != ADDRESS {
            return u16::MAX;
        }
        match register {
            CONTROL if self.reset_until > now => self.control | RESET,
            CONTROL => self.control,
            STATUS if self.link(now) => ABILITIES | NEGOTIATED,
            STATUS => ABILITIES,
            2 | 3 => IDENTIFIERS[register as usize - 2],
            4 => self.advertisement,
            _ => 0,
        }
    }

    /// Writes a register.
    pub fn write(&mut self, address: u32, register: u32, value: u16, now: Time) {
        if self.fault.silent || address != ADDRESS {
            return;
        }
        match register {
            CONTROL if value & RESET != 0 => {
                self.control = CONTROL_RESET;
                self.advertisement = ADVERTISEMENT_RESET;
                self.reset_until = now + RESET_TAKES;
                self.link_from = self.reset_until + NEGOTIATION_TAKES;
            }
            CONTROL => {
                self.control = value & !RESTART;
                if value & (NEGOTIATE | RESTART) == NEGOTIATE | RESTART {
                    self.link_from = now + NEGOTIATION_TAKES;
                }
            }
            4 => self.advertisement = value,
            _ => {}
        }
    }
}
