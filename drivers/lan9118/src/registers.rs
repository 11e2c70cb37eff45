//! Addresses and bits of the LAN9118; names are those of its datasheet.

pub const RX_DATA: usize = 0x00;
pub const TX_DATA: usize = 0x20;
pub const RX_STATUS: usize = 0x40;
pub const TX_STATUS: usize = 0x48;
pub const INT_STS: usize = 0x58;
pub const IRQ_CFG: usize = 0x54;
pub const INT_EN: usize = 0x5C;
pub const BYTE_TEST: usize = 0x64;
pub const FIFO_INT: usize = 0x68;
pub const RX_CFG: usize = 0x6C;
pub const TX_CFG: usize = 0x70;
pub const HW_CFG: usize = 0x74;
pub const RX_FIFO_INF: usize = 0x7C;
pub const TX_FIFO_INF: usize = 0x80;
pub const MAC_CSR_CMD: usize = 0xA4;
pub const MAC_CSR_DATA: usize = 0xA8;

pub const BYTE_TEST_VALUE: u32 = 0x8765_4321;
pub const HW_CFG_SRST: u32 = 1;
/// 5 kB of the FIFO memory to transmit, the rest to receive.
pub const HW_CFG_TX_FIF_SZ: u32 = 5 << 16;
/// Line enabled, active high, push-pull.
pub const IRQ_CFG_ACTIVE_HIGH: u32 = 0x111;
/// Levels: receive interrupt from the first status on.
pub const FIFO_INT_FIRST: u32 = 0x4800_0000;
pub const TX_CFG_TX_ON: u32 = 1 << 1;
pub const INT_RSFL: u32 = 1 << 3;
pub const INT_PHY: u32 = 1 << 18;

pub const RX_STATUS_ERROR: u32 = 1 << 15;
pub const TX_FIRST_SEGMENT: u32 = 1 << 13;
pub const TX_LAST_SEGMENT: u32 = 1 << 12;

pub const MAC_CSR_BUSY: u32 = 1 << 31;
pub const MAC_CSR_READ: u32 = 1 << 30;

pub const MAC_CR: u32 = 1;
pub const ADDRH: u32 = 2;
pub const ADDRL: u32 = 3;
pub const MII_ACC: u32 = 6;
pub const MII_DATA: u32 = 7;
/// Full duplex, transmitter and receiver on.
pub const MAC_CR_RUN: u32 = 1 << 20 | 1 << 3 | 1 << 2;

pub const MII_BUSY: u32 = 1;
pub const MII_WRITE: u32 = 1 << 1;
pub const PHY_ADDRESS: u32 = 1 << 11;
pub const PHY_BSR: u32 = 1;
pub const PHY_INT_SOURCE: u32 = 29;
pub const PHY_INT_MASK: u32 = 30;
pub const BSR_LINK: u32 = 1 << 2;
/// Link lost, and negotiation finished.
pub const PHY_INT_LINK: u32 = 0x50;
