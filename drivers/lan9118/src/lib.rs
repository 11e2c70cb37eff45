//! SMSC LAN9118 Ethernet controller: frames in, frames out, by programmed input and output.
//!
//! The chip is reached through [`Bus`], so the driver runs against memory-mapped registers on a board and
//! against a model in a test. It neither allocates nor waits without a bound, and it knows no network
//! stack and no clock.
#![cfg_attr(not(test), no_std)]

#[cfg(test)]
mod model;
mod registers;

use registers::*;
use thiserror::Error;

/// Reads of a busy flag before the chip is given up.
const POLLS: u32 = 100_000;
/// The check sum that ends every received frame.
const CRC_BYTES: usize = 4;
/// Longest frame, without check sum.
pub const MAX_FRAME: usize = 1514;

/// The chip's 32-bit registers, by byte offset.
pub trait Bus {
    /// Reads a register.
    fn read(&mut self, offset: usize) -> u32;
    /// Writes a register.
    fn write(&mut self, offset: usize, value: u32);
}

/// Why the chip could not be started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum InitError {
    /// The byte-order test register holds something else: there is no such chip at this address.
    #[error("no LAN9118 answers: its test register reads {seen:#010x}")]
    NoChip {
        /// What was read.
        seen: u32,
    },
    /// A busy flag stays set.
    #[error("the LAN9118 stays busy: power-cycle the board")]
    Busy,
}

/// Frames the driver could not pass on, since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Received with an error, or longer than the caller's buffer.
    pub received: u32,
    /// Not sent: the transmit FIFO was full, or the frame too long.
    pub sent: u32,
}

/// The chip, running.
pub struct Lan9118<B: Bus> {
    bus: B,
    mac: [u8; 6],
    dropped: Dropped,
}

impl<B: Bus> Lan9118<B> {
    /// Resets and starts the chip: full duplex, own address and broadcasts, interrupts for received frames
    /// and changes of the link. The address is the one the chip loaded at power-up.
    pub fn start(mut bus: B) -> Result<Self, InitError> {
        bus.write(HW_CFG, HW_CFG_SRST);
        if !poll(&mut bus, |bus| bus.read(HW_CFG) & HW_CFG_SRST == 0) {
            return Err(InitError::Busy);
        }
        if !poll(&mut bus, |bus| bus.read(BYTE_TEST) == BYTE_TEST_VALUE) {
            return Err(InitError::NoChip {
                seen: bus.read(BYTE_TEST),
            });
        }
        bus.write(HW_CFG, HW_CFG_TX_FIF_SZ);
        bus.write(INT_EN, 0);
        bus.write(INT_STS, !0);
        bus.write(IRQ_CFG, IRQ_CFG_ACTIVE_HIGH);
        bus.write(FIFO_INT, FIFO_INT_FIRST);
        bus.write(RX_CFG, 0);
        bus.write(TX_CFG, TX_CFG_TX_ON);
        let mut chip = Self {
            bus,
            mac: [0; 6],
            dropped: Dropped::default(),
        };
        chip.mac_write(MAC_CR, MAC_CR_RUN)?;
        chip.phy_write(PHY_INT_MASK, PHY_INT_LINK)?;
        chip.phy_read(PHY_INT_SOURCE)?;
        let [b0, b1, b2, b3] = chip.mac_read(ADDRL)?.to_le_bytes();
        let [b4, b5, ..] = chip.mac_read(ADDRH)?.to_le_bytes();
        chip.mac = [b0, b1, b2, b3, b4, b5];
        chip.bus.write(INT_EN, INT_RSFL | INT_PHY);
        Ok(chip)
    }

    /// The chip's own Ethernet address.
    pub fn mac(&self) -> [u8; 6] {
        self.mac
    }

    /// Frames lost in the driver.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Clears the interrupt. Call it before the frames are taken: one that arrives after it raises the next.
    pub fn acknowledge(&mut self) {
        let pending = self.bus.read(INT_STS);
        if pending & INT_PHY != 0 {
            // Reading its source clears the interrupt of the PHY; a PHY that does not answer raises none.
            let _ = self.phy_read(PHY_INT_SOURCE);
        }
        self.bus.write(INT_STS, pending);
    }

    /// Whether the cable carries a link.
    pub fn link_up(&mut self) -> bool {
        // The link bit latches its loss until read: the second reading is the present state.
        let _ = self.phy_read(PHY_BSR);
        self.phy_read(PHY_BSR).is_ok_and(|status| status & BSR_LINK != 0)
    }

    /// Takes the next received frame into `buffer`; returns its length without check sum, or `None` when
    /// there is none. Damaged frames and those longer than `buffer` are dropped and counted.
    pub fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        for _ in 0..(self.bus.read(RX_FIFO_INF) >> 16) & 0xFF {
            let status = self.bus.read(RX_STATUS);
            let with_crc = (status >> 16) as usize & 0x3FFF;
            let words = with_crc.div_ceil(4);
            let length = with_crc.saturating_sub(CRC_BYTES);
            if status & RX_STATUS_ERROR != 0 || length == 0 || length > buffer.len() {
                self.dropped.received = self.dropped.received.wrapping_add(1);
                for _ in 0..words {
                    self.bus.read(RX_DATA);
                }
                continue;
            }
            let frame_words = length.div_ceil(4);
            for chunk in buffer[..length].chunks_mut(4) {
                let bytes = self.bus.read(RX_DATA).to_le_bytes();
                chunk.copy_from_slice(&bytes[..chunk.len()]);
            }
            for _ in frame_words..words {
                self.bus.read(RX_DATA);
            }
            return Some(length);
        }
        None
    }

    /// Whether a frame of [`MAX_FRAME`] bytes can be sent now.
    pub fn can_send(&mut self) -> bool {
        self.free_bytes() >= MAX_FRAME + 12
    }

    /// Sends `frame` (without check sum). One that finds no room is dropped and counted.
    pub fn send(&mut self, frame: &[u8]) {
        let words = frame.len().div_ceil(4);
        if frame.len() > MAX_FRAME || self.free_bytes() < 4 * words + 8 {
            self.dropped.sent = self.dropped.sent.wrapping_add(1);
            return;
        }
        let length = frame.len() as u32;
        self.bus
            .write(TX_DATA, TX_FIRST_SEGMENT | TX_LAST_SEGMENT | length);
        self.bus.write(TX_DATA, length);
        for chunk in frame.chunks(4) {
            let mut bytes = [0; 4];
            bytes[..chunk.len()].copy_from_slice(chunk);
            self.bus.write(TX_DATA, u32::from_le_bytes(bytes));
        }
        for _ in 0..(self.bus.read(TX_FIFO_INF) >> 16) & 0xFF {
            self.bus.read(TX_STATUS);
        }
    }

    fn free_bytes(&mut self) -> usize {
        self.bus.read(TX_FIFO_INF) as usize & 0xFFFF
    }

    fn mac_idle(&mut self) -> Result<(), InitError> {
        let idle = poll(&mut self.bus, |bus| bus.read(MAC_CSR_CMD) & MAC_CSR_BUSY == 0);
        if idle { Ok(()) } else { Err(InitError::Busy) }
    }

    fn mac_read(&mut self, register: u32) -> Result<u32, InitError> {
        self.mac_idle()?;
        self.bus
            .write(MAC_CSR_CMD, MAC_CSR_BUSY | MAC_CSR_READ | register);
        self.mac_idle()?;
        Ok(self.bus.read(MAC_CSR_DATA))
    }

    fn mac_write(&mut self, register: u32, value: u32) -> Result<(), InitError> {
        self.mac_idle()?;
        self.bus.write(MAC_CSR_DATA, value);
        self.bus.write(MAC_CSR_CMD, MAC_CSR_BUSY | register);
        self.mac_idle()
    }

    fn phy_idle(&mut self) -> Result<(), InitError> {
        for _ in 0..POLLS {
            if self.mac_read(MII_ACC)? & MII_BUSY == 0 {
                return Ok(());
            }
        }
        Err(InitError::Busy)
    }

    fn phy_read(&mut self, register: u32) -> Result<u32, InitError> {
        self.phy_idle()?;
        self.mac_write(MII_ACC, PHY_ADDRESS | register << 6 | MII_BUSY)?;
        self.phy_idle()?;
        Ok(self.mac_read(MII_DATA)? & 0xFFFF)
    }

    fn phy_write(&mut self, register: u32, value: u32) -> Result<(), InitError> {
        self.phy_idle()?;
        self.mac_write(MII_DATA, value)?;
        self.mac_write(MII_ACC, PHY_ADDRESS | register << 6 | MII_WRITE | MII_BUSY)?;
        self.phy_idle()
    }
}

fn poll<B: Bus>(bus: &mut B, mut done: impl FnMut(&mut B) -> bool) -> bool {
    (0..POLLS).any(|_| done(bus))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;

    const MAC: [u8; 6] = [0x52, 0x54, 0, 0x12, 0x34, 0x51];

    fn started() -> Lan9118<Model> {
        Lan9118::start(Model::new(MAC)).expect("the model answers")
    }

    #[test]
    fn starts_and_reads_its_address() {
        let mut chip = started();
        assert_eq!(chip.mac(), MAC);
        assert_eq!(chip.bus.mac_control(), MAC_CR_RUN);
        assert_eq!(chip.bus.registers[&INT_EN], INT_RSFL | INT_PHY);
        assert!(chip.link_up());
    }

    #[test]
    fn a_missing_chip_is_an_error_with_what_was_seen() {
        let mut model = Model::new(MAC);
        model.byte_test = 0xFFFF_FFFF;
        let error = Lan9118::start(model).err();
        assert_eq!(error, Some(InitError::NoChip { seen: 0xFFFF_FFFF }));
    }

    #[test]
    fn frames_of_every_length_arrive_whole_and_in_order() {
        let mut chip = started();
        for length in 14..=80 {
            let frame: Vec<u8> = (0..length).map(|i| (i * 7 + length) as u8).collect();
            chip.bus.arrive(&frame, false);
            chip.bus.arrive(&[0xAA; 60], false);
            let mut buffer = [0; MAX_FRAME];
            assert_eq!(chip.receive(&mut buffer), Some(frame.len()));
            assert_eq!(buffer[..frame.len()], frame);
            assert_eq!(chip.receive(&mut buffer), Some(60));
            assert_eq!(chip.receive(&mut buffer), None);
        }
        assert_eq!(chip.dropped(), Dropped::default());
    }

    #[test]
    fn damaged_and_oversized_frames_are_counted_and_the_next_is_whole() {
        let mut chip = started();
        chip.bus.arrive(&[1; 61], true);
        chip.bus.arrive(&[2; 200], false);
        chip.bus.arrive(&[3; 63], false);
        let mut buffer = [0; 100];
        assert_eq!(chip.receive(&mut buffer), Some(63));
        assert_eq!(buffer[..63], [3; 63]);
        assert_eq!(chip.dropped(), Dropped { received: 2, sent: 0 });
        assert_eq!(chip.bus.words_waiting(), 0);
    }

    #[test]
    fn sent_frames_leave_as_they_are() {
        let mut chip = started();
        for length in [42, 43, 44, 45, MAX_FRAME] {
            let frame: Vec<u8> = (0..length).map(|i| i as u8).collect();
            chip.send(&frame);
            assert_eq!(chip.bus.sent.pop(), Some(frame));
        }
        assert_eq!(chip.bus.statuses, 0);
    }

    #[test]
    fn a_frame_without_room_is_dropped_and_counted() {
        let mut chip = started();
        chip.bus.free = 60;
        assert!(!chip.can_send());
        chip.send(&[0; 60]);
        assert_eq!(chip.dropped(), Dropped { received: 0, sent: 1 });
        assert!(chip.bus.sent.is_empty());
    }

    #[test]
    fn acknowledging_clears_frame_and_link_interrupts() {
        let mut chip = started();
        chip.bus.arrive(&[0; 60], false);
        chip.bus.change_link();
        assert!(chip.bus.line());
        chip.acknowledge();
        assert!(!chip.bus.line());
    }
}
