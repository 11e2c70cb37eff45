//! The Ethernet controller (RM0468, 63): registers and interrupts; frames and descriptors are in [`dma`].

mod dma;
mod phy;

pub use phy::{Phy, PhyFault};

use super::map::exception;
use super::pins::Signal;
use super::shared::{Peripheral, Shared};
use crate::time::Time;
use std::collections::VecDeque;

const MACCR: u32 = 0x0000;
const MACPFR: u32 = 0x0008;
const MDIO_ADDRESS: u32 = 0x0200;
const MDIO_DATA: u32 = 0x0204;
const ADDRESS_HIGH: u32 = 0x0300;
const ADDRESS_LOW: u32 = 0x0304;
const DMAMR: u32 = 0x1000;
const TX_CONTROL: u32 = 0x1104;
const RX_CONTROL: u32 = 0x1108;
const TX_LIST: u32 = 0x1114;
const RX_LIST: u32 = 0x111c;
const TX_TAIL: u32 = 0x1120;
const RX_TAIL: u32 = 0x1128;
const TX_LENGTH: u32 = 0x112c;
const RX_LENGTH: u32 = 0x1130;
const INTERRUPTS: u32 = 0x1134;
const STATUS: u32 = 0x1160;
const WORDS: usize = 0x1170 / 4;
const SOFTWARE_RESET: u32 = 1;
/// The interface that SYSCFG selects.
const RMII: u32 = 4;
/// MACCR: receiver, transmitter, full duplex, 100 Mbit/s.
const RECEIVER: u32 = 1;
const TRANSMITTER: u32 = 1 << 1;
const FULL_DUPLEX: u32 = 1 << 13;
const FAST: u32 = 1 << 14;
/// Status and enable bits: sent, no descriptor to receive into, received, any of them.
const SENT: u32 = 1;
const RECEIVED: u32 = 1 << 6;
const NO_BUFFER: u32 = 1 << 7;
const NORMAL: u32 = 1 << 15;
/// A reset takes some periods of the PHY's 50 MHz.
const RESET_TAKES: Time = Time::us(2);
/// Periods of MDC in a management frame with its preamble (IEEE 802.3, 22.2.4.5).
const MANAGEMENT_BITS: u64 = 64;
/// Highest MDC (IEEE 802.3, 22.2.2.13).
const HIGHEST_MDC_HZ: u64 = 2_500_000;
/// Signals that RMII needs.
const SIGNALS: [&str; 7] = ["REF_CLK", "CRS_DV", "RXD0", "RXD1", "TX_EN", "TXD0", "TXD1"];

/// Frames that have passed the port, each way in their order.
#[derive(Debug, Default)]
pub struct Frames {
    /// Put into the board's memory.
    pub received: Vec<Vec<u8>>,
    /// Sent by the board.
    pub sent: Vec<Vec<u8>>,
}

/// The controller.
#[derive(Debug)]
pub struct Ethernet {
    words: Vec<u32>,
    signals: Vec<Signal>,
    management: [Signal; 2],
    exception: Option<u16>,
    /// The PHY behind it.
    pub phy: Phy,
    reset_until: Time,
    management_until: Time,
    rings: dma::Rings,
    /// Frames on the wire to the board, in the order in which they arrive.
    pub arriving: VecDeque<(Time, Vec<u8>)>,
    /// Frames that the board has sent, and when the last bit was.
    pub sent: VecDeque<(Time, Vec<u8>)>,
    /// Frames that no descriptor was free for.
    pub lost: u64,
    /// What has passed, if it is recorded.
    pub record: Option<Frames>,
}

impl Default for Ethernet {
    fn default() -> Self {
        Self {
            words: vec![0; WORDS],
            signals: SIGNALS.map(|signal| Signal::of("ETH", signal)).to_vec(),
            management: ["MDC", "MDIO"].map(|signal| Signal::of("ETH", signal)),
            exception: exception("ETH"),
            phy: Phy::default(),
            reset_until: Time::default(),
            management_until: Time::default(),
            rings: dma::Rings::default(),
            arriving: VecDeque::new(),
            sent: VecDeque::new(),
            lost: 0,
            record: None,
        }
    }
}

impl Ethernet {
    fn word(&self, offset: u32) -> u32 {
        self.words.get(offset as usize / 4).copied().unwrap_or(0)
    }

    fn set(&mut self, offset: u32, value: u32) {
        if let Some(word) = self.words.get_mut(offset as usize / 4) {
            *word = value;
        }
    }

    /// After a reset of the chip: the wire and the PHY stay.
    pub fn reset(&mut self) {
        self.words.fill(0);
        self.rings = dma::Rings::default();
    }

    /// Whether the clock from the PHY reaches the controller.
    fn is_clocked(&self, shared: &Shared) -> bool {
        let pin = shared.pins.connected(&self.signals[0]).is_some();
        pin && shared.ethernet_interface == RMII && shared.ethernet_clocks && !self.phy.fault.no_clock
    }

    /// A reset ends only with all clocks.
    fn check_reset(&self, shared: &mut Shared) {
        if shared.ethernet_interface != RMII {
            shared.report(
                "the Ethernet controller is reset before SYSCFG_PMCR selects RMII: the reset does not end",
            );
        }
        if !shared.ethernet_clocks {
            shared.report("the Ethernet controller is reset without all of its clocks ETHEN, ETHTXEN, ETHRXEN: the reset does not end");
        }
        if shared.pins.connected(&self.signals[0]).is_none() {
            shared.report("the Ethernet controller is reset, but no pin is connected to ETH_REF_CLK: the reset does not end");
        }
    }

    fn manage(&mut self, shared: &mut Shared) {
        let command = self.word(MDIO_ADDRESS);
        if command & 1 == 0 {
            return;
        }
        for signal in &self.management {
            if shared.pins.connected(signal).is_none() {
                shared.findings.report(format!(
                    "the PHY is managed, but no pin is connected to {}",
                    signal.name
                ));
            }
        }
        let divider = [42, 62, 16, 26, 102, 124]
            .get((command >> 8 & 0xf) as usize)
            .copied();
        let hz = divider.map_or(u64::MAX, |divider| shared.clocks.bus / divider);
        if hz > HIGHEST_MDC_HZ {
            shared.report(format!("MDC would be {hz} Hz: the PHY takes {HIGHEST_MDC_HZ} Hz"));
        }
        let now = shared.now();
        self.management_until = now + Time::periods(MANAGEMENT_BITS, hz);
        let (address, register) = (command >> 21 & 31, command >> 16 & 31);
        match command >> 2 & 3 {
            1 => self
                .phy
                .write(address, register, self.word(MDIO_DATA) as u16, now),
            3 => {
                let value = self.phy.read(address, register, now);
                self.set(MDIO_DATA, u32::from(value));
            }
            _ => shared.report("this operation on the PHY's registers is not modelled"),
        }
    }

    fn check_start(&self, shared: &mut Shared) {
        for signal in &self.signals {
            if shared.pins.connected(signal).is_none() {
                shared.findings.report(format!(
                    "the Ethernet controller is started, but no pin is connected to {}",
                    signal.name
                ));
            }
        }
        if self.word(MACCR) & (FULL_DUPLEX | FAST) != FULL_DUPLEX | FAST {
            shared.report(
                "the Ethernet controller is not set to 100 Mbit/s full duplex, which the PHY negotiates",
            );
        }
    }
}

impl Peripheral for Ethernet {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        let value = self.word(offset);
        match offset {
            DMAMR
                if value & SOFTWARE_RESET != 0
                    && self.is_clocked(shared)
                    && self.reset_until <= shared.now() =>
            {
                self.reset();
                0
            }
            MDIO_ADDRESS if self.management_until <= shared.now() => value & !1,
            _ => value,
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        match offset {
            // Written ones clear.
            STATUS => {
                let left = self.word(STATUS) & !value;
                self.set(STATUS, left);
            }
            DMAMR if value & SOFTWARE_RESET != 0 => {
                self.check_reset(shared);
                self.reset_until = shared.now() + RESET_TAKES;
                self.set(offset, value);
            }
            MDIO_ADDRESS => {
                self.set(offset, value);
                self.manage(shared);
            }
            TX_LIST | RX_LIST => {
                self.set(offset, value);
                self.rings = dma::Rings::default();
            }
            MACCR => {
                if value & !self.word(MACCR) & (RECEIVER | TRANSMITTER) != 0 {
                    self.set(offset, value);
                    self.check_start(shared);
                }
                self.set(offset, value);
            }
            _ => self.set(offset, value),
        }
        if matches!(offset, MACCR | TX_CONTROL | RX_CONTROL | TX_TAIL | RX_TAIL) {
            self.rings.look = true;
        }
    }

    fn due(&self) -> Time {
        let first = self.arriving.front().filter(|_| !self.rings.starved);
        let arrives = first.map_or(Time::NEVER, |(at, _)| *at);
        let wakes = if self.rings.look {
            Time::default()
        } else {
            Time::NEVER
        };
        arrives.min(self.rings.sent_at()).min(wakes)
    }

    fn asks_for(&self) -> Option<u16> {
        let (status, enabled) = (self.word(STATUS), self.word(INTERRUPTS));
        let asks = enabled & NORMAL != 0 && status & enabled & (SENT | RECEIVED) != 0;
        self.exception.filter(|_| asks)
    }
}
