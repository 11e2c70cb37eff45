//! The chip as the tests see it: registers, FIFOs, MAC and PHY.

use crate::{Bus, registers::*};
use std::collections::{HashMap, VecDeque};

pub struct Model {
    pub byte_test: u32,
    pub registers: HashMap<usize, u32>,
    pub free: u32,
    pub statuses: u32,
    pub sent: Vec<Vec<u8>>,
    mac: HashMap<u32, u32>,
    phy_source: u32,
    rx_status: VecDeque<u32>,
    rx_words: VecDeque<u32>,
    tx_words: Vec<u32>,
}

impl Model {
    pub fn new(address: [u8; 6]) -> Self {
        let [b0, b1, b2, b3, b4, b5] = address;
        Self {
            byte_test: BYTE_TEST_VALUE,
            registers: HashMap::new(),
            free: 5000,
            statuses: 0,
            sent: Vec::new(),
            mac: HashMap::from([
                (ADDRL, u32::from_le_bytes([b0, b1, b2, b3])),
                (ADDRH, u32::from_le_bytes([b4, b5, 0, 0])),
            ]),
            phy_source: 0,
            rx_status: VecDeque::new(),
            rx_words: VecDeque::new(),
            tx_words: Vec::new(),
        }
    }

    pub fn arrive(&mut self, frame: &[u8], damaged: bool) {
        let mut bytes = frame.to_vec();
        bytes.extend([0xCC; 4]);
        let error = if damaged { RX_STATUS_ERROR } else { 0 };
        self.rx_status.push_back((bytes.len() as u32) << 16 | error);
        for chunk in bytes.chunks(4) {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            self.rx_words.push_back(u32::from_le_bytes(word));
        }
        *self.registers.entry(INT_STS).or_default() |= INT_RSFL;
    }

    pub fn change_link(&mut self) {
        self.phy_source = 0x10;
    }

    pub fn words_waiting(&self) -> usize {
        self.rx_words.len()
    }

    pub fn mac_control(&self) -> u32 {
        self.mac[&MAC_CR]
    }

    pub fn line(&self) -> bool {
        self.interrupts() & self.registers[&INT_EN] != 0
    }

    fn interrupts(&self) -> u32 {
        let phy = if self.phy_source == 0 { 0 } else { INT_PHY };
        self.registers.get(&INT_STS).copied().unwrap_or(0) | phy
    }

    fn mac_command(&mut self, command: u32) {
        let register = command & 0xF;
        if command & MAC_CSR_READ != 0 {
            let value = self.mac.get(&register).copied().unwrap_or(0);
            self.registers.insert(MAC_CSR_DATA, value);
            return;
        }
        let value = self.registers[&MAC_CSR_DATA];
        if register != MII_ACC {
            self.mac.insert(register, value);
        } else if value & MII_WRITE == 0 {
            let reading = match value >> 6 & 0x1F {
                PHY_BSR => BSR_LINK,
                PHY_INT_SOURCE => std::mem::take(&mut self.phy_source),
                _ => 0,
            };
            self.mac.insert(MII_DATA, reading);
        }
    }

    fn transmit(&mut self, word: u32) {
        self.tx_words.push(word);
        let length = self.tx_words[0] as usize & 0x7FF;
        if self.tx_words.len() == 2 + length.div_ceil(4) {
            let mut bytes: Vec<u8> = self.tx_words[2..].iter().flat_map(|w| w.to_le_bytes()).collect();
            bytes.truncate(length);
            self.sent.push(bytes);
            self.tx_words.clear();
            self.statuses += 1;
        }
    }
}

impl Bus for Model {
    fn read(&mut self, offset: usize) -> u32 {
        match offset {
            BYTE_TEST => self.byte_test,
            HW_CFG => self.registers[&HW_CFG] & !HW_CFG_SRST,
            MAC_CSR_CMD => 0,
            INT_STS => self.interrupts(),
            RX_FIFO_INF => (self.rx_status.len() as u32) << 16,
            RX_STATUS => self.rx_status.pop_front().expect("a status is waiting"),
            RX_DATA => self.rx_words.pop_front().expect("a word is waiting"),
            TX_FIFO_INF => self.statuses << 16 | self.free,
            TX_STATUS => {
                self.statuses -= 1;
                0
            }
            _ => self.registers.get(&offset).copied().unwrap_or(0),
        }
    }

    fn write(&mut self, offset: usize, value: u32) {
        match offset {
            TX_DATA => self.transmit(value),
            INT_STS => *self.registers.entry(INT_STS).or_default() &= !value,
            MAC_CSR_CMD => self.mac_command(value),
            _ => {
                self.registers.insert(offset, value);
            }
        }
    }
}
