//! The LAN8742A behind the Ethernet controller, without any wait that may not end.

use core::task::Context;
use embassy_stm32::eth::{Phy, StationManagement};

/// Address strapped on the board.
const ADDRESS: u8 = 0;
/// Longest time a reset may take \[ms\].
const RESET_MS: u32 = 500;

const BASIC_CONTROL: u8 = 0;
const BASIC_STATUS: u8 = 1;
const ADVERTISEMENT: u8 = 4;

const CONTROL_RESET: u16 = 1 << 15;
const CONTROL_NEGOTIATE: u16 = 1 << 12 | 1 << 9;
const STATUS_LINK: u16 = 1 << 2;
const STATUS_NEGOTIATED: u16 = 1 << 5;
/// 100BASE-TX full duplex and nothing else, as the controller is set: IEEE 802.3 selector, bit 8.
const ADVERTISE_100_FULL: u16 = 1 << 8 | 1;

/// The PHY; reports no link for as long as it does not answer.
pub(crate) struct Lan8742<S: StationManagement>(pub(crate) S);

impl<S: StationManagement> Phy for Lan8742<S> {
    fn phy_reset(&mut self) {
        self.0.smi_write(ADDRESS, BASIC_CONTROL, CONTROL_RESET);
        for _ in 0..RESET_MS {
            if self.0.smi_read(ADDRESS, BASIC_CONTROL) & CONTROL_RESET == 0 {
                return;
            }
            cortex_m::asm::delay(1000 * crate::clocks::CORE_MHZ);
        }
        defmt::error!("the Ethernet PHY does not answer; the board runs without network");
    }

    fn phy_init(&mut self) {
        self.0.smi_write(ADDRESS, ADVERTISEMENT, ADVERTISE_100_FULL);
        self.0.smi_write(ADDRESS, BASIC_CONTROL, CONTROL_NEGOTIATE);
    }

    fn poll_link(&mut self, _: &mut Context) -> bool {
        let status = self.0.smi_read(ADDRESS, BASIC_STATUS);
        // All ones: the line is not driven.
        status != u16::MAX && status & STATUS_LINK != 0 && status & STATUS_NEGOTIATED != 0
    }
}
