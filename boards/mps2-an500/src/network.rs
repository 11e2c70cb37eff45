//! The Ethernet port as a `smoltcp` device.

use crate::registers::Block;
use crate::time::now_us;
use lan9118::{Lan9118, MAX_FRAME};
use smoltcp::phy::{self, Device, DeviceCapabilities, Medium};
use smoltcp::time::Instant;

/// The Ethernet port.
pub struct Network {
    chip: Lan9118<Block>,
    received: [u8; MAX_FRAME],
    sending: [u8; MAX_FRAME],
    last_arrival_us: u64,
}

impl Network {
    /// Starts the port. Panics if the chip does not answer: the board is then no board.
    pub(crate) fn start() -> Self {
        let chip = match Lan9118::start(Block::LAN9118) {
            Ok(chip) => chip,
            Err(error) => panic!("{error}"),
        };
        Self {
            chip,
            received: [0; MAX_FRAME],
            sending: [0; MAX_FRAME],
            last_arrival_us: 0,
        }
    }

    /// Clears the interrupt; afterwards the received frames are to be taken.
    pub fn acknowledge(&mut self) {
        self.chip.acknowledge();
    }

    /// Ethernet address of the port.
    pub fn mac(&self) -> [u8; 6] {
        self.chip.mac()
    }

    /// Time at which the last received frame was taken from the chip \[µs\].
    pub fn last_arrival_us(&self) -> u64 {
        self.last_arrival_us
    }
}

/// A received frame.
pub struct RxToken<'a>(&'a [u8]);

/// The right to send a frame.
pub struct TxToken<'a> {
    chip: &'a mut Lan9118<Block>,
    buffer: &'a mut [u8; MAX_FRAME],
}

impl phy::RxToken for RxToken<'_> {
    fn consume<R, F: FnOnce(&[u8]) -> R>(self, f: F) -> R {
        f(self.0)
    }
}

impl phy::TxToken for TxToken<'_> {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, length: usize, f: F) -> R {
        let frame = &mut self.buffer[..length];
        let result = f(frame);
        self.chip.send(frame);
        result
    }
}

impl Device for Network {
    type RxToken<'a> = RxToken<'a>;
    type TxToken<'a> = TxToken<'a>;

    fn receive(&mut self, _: Instant) -> Option<(RxToken<'_>, TxToken<'_>)> {
        if !self.chip.can_send() {
            return None;
        }
        let length = self.chip.receive(&mut self.received)?;
        self.last_arrival_us = now_us();
        let token = TxToken {
            chip: &mut self.chip,
            buffer: &mut self.sending,
        };
        Some((RxToken(&self.received[..length]), token))
    }

    fn transmit(&mut self, _: Instant) -> Option<TxToken<'_>> {
        let token = TxToken {
            chip: &mut self.chip,
            buffer: &mut self.sending,
        };
        token.chip.can_send().then_some(token)
    }

    fn capabilities(&self) -> DeviceCapabilities {
        let mut capabilities = DeviceCapabilities::default();
        capabilities.medium = Medium::Ethernet;
        capabilities.max_transmission_unit = MAX_FRAME;
        capabilities
    }
}
