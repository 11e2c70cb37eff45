//! Descriptors and frames (RM0468, 63.10): what the controller reads and writes in memory by itself.

use super::{
    ADDRESS_HIGH, ADDRESS_LOW, Ethernet, MACCR, MACPFR, NO_BUFFER, NORMAL, RECEIVED, RECEIVER, RX_CONTROL,
};
use super::{RX_LENGTH, RX_LIST, SENT, STATUS, TRANSMITTER, TX_CONTROL, TX_LENGTH, TX_LIST};
use crate::chip::memory::Dma;
use crate::time::Time;

/// Time of a byte at 100 Mbit/s.
const BYTE: Time = Time::ns(80);
/// Bytes around a frame on the wire: preamble, checksum, gap.
const AROUND: u64 = 8 + 4 + 12;
/// Shortest frame without checksum.
const SHORTEST: usize = 60;
const CHECKSUM: u32 = 4;
const DESCRIPTOR: u32 = 16;
const OWNED: u32 = 1 << 31;
/// First and last buffer of a frame.
const WHOLE: u32 = 3 << 28;
/// A buffer is given, in a descriptor to receive into.
const BUFFER_GIVEN: u32 = 1 << 24;
/// Bytes that the receiver holds until a descriptor is free (RM0468, 63.4.6).
const RECEIVE_FIFO: usize = 2048;
const PROMISCUOUS: u32 = 1;

/// Where the controller is in its lists.
#[derive(Debug, Default)]
pub struct Rings {
    sending: u32,
    receiving: u32,
    /// When the frame being sent will be through, and where its descriptor is.
    under_way: Option<(Time, u32)>,
    /// Something has changed that may let it go on.
    pub look: bool,
    /// No descriptor is free to receive into: what arrives waits until one is given back.
    pub starved: bool,
}

impl Rings {
    /// When the frame being sent will be through.
    pub fn sent_at(&self) -> Time {
        self.under_way.map_or(Time::NEVER, |(at, _)| at)
    }
}

impl Ethernet {
    /// Does what is due by now.
    pub fn serve(&mut self, memory: &mut impl Dma, now: Time) {
        self.rings.look = false;
        self.rings.starved = false;
        while self.send(memory, now) {}
        while self.receive(memory, now) {}
    }

    /// Ends a frame that is through, and begins the next; whether it did.
    fn send(&mut self, memory: &mut impl Dma, now: Time) -> bool {
        if let Some((at, descriptor)) = self.rings.under_way {
            if at > now {
                return false;
            }
            self.rings.under_way = None;
            memory.write_word(descriptor + 12, WHOLE);
            self.raise(SENT);
            return true;
        }
        if self.word(MACCR) & TRANSMITTER == 0 || self.word(TX_CONTROL) & 1 == 0 {
            return false;
        }
        let descriptor = self.word(TX_LIST) + DESCRIPTOR * self.rings.sending;
        let Some([buffer, _, length, control]) = read_descriptor(memory, descriptor) else {
            return false;
        };
        if control & OWNED == 0 {
            return false;
        }
        if control & WHOLE != WHOLE {
            memory.report("a frame in more than one buffer is not modelled");
            return false;
        }
        let mut frame = vec![0; (length & 0x3fff) as usize];
        if !memory.read(buffer, &mut frame) {
            return false;
        }
        frame.resize(frame.len().max(SHORTEST), 0);
        let end = now + Time(BYTE.0 * (frame.len() as u64 + AROUND));
        if self.phy.link(now) {
            if let Some(record) = &mut self.record {
                record.sent.push(frame.clone());
            }
            self.sent.push_back((end, frame));
        }
        self.rings.under_way = Some((end, descriptor));
        self.rings.sending = next(self.rings.sending, self.word(TX_LENGTH));
        false
    }

    /// Takes a frame that has arrived; whether it did.
    fn receive(&mut self, memory: &mut impl Dma, now: Time) -> bool {
        if self.arriving.front().is_none_or(|(at, _)| *at > now) {
            return false;
        }
        let on = self.word(MACCR) & RECEIVER != 0 && self.word(RX_CONTROL) & 1 != 0 && self.phy.link(now);
        let wanted = on
            && self
                .arriving
                .front()
                .is_some_and(|(_, frame)| self.is_for_this(frame));
        if !wanted {
            self.arriving.pop_front();
            return true;
        }
        let descriptor = self.word(RX_LIST) + DESCRIPTOR * self.rings.receiving;
        let Some([buffer, _, _, control]) = read_descriptor(memory, descriptor) else {
            self.arriving.pop_front();
            return false;
        };
        if control & OWNED == 0 {
            self.drop_what_does_not_fit(now);
            self.rings.starved = true;
            self.raise(NO_BUFFER);
            return false;
        }
        let Some((_, frame)) = self.arriving.pop_front() else {
            return false;
        };
        let room = (self.word(RX_CONTROL) >> 1 & 0x3fff) as usize;
        if control & BUFFER_GIVEN == 0 || frame.len() + CHECKSUM as usize > room {
            memory.report(format!(
                "a frame of {} bytes and its checksum does not fit into a buffer of {room}",
                frame.len()
            ));
            return true;
        }
        if memory.write(buffer, &frame) {
            memory.write_word(descriptor + 12, WHOLE | (frame.len() as u32 + CHECKSUM));
            self.rings.receiving = next(self.rings.receiving, self.word(RX_LENGTH));
            self.raise(RECEIVED);
            if let Some(record) = &mut self.record {
                record.received.push(frame);
            }
        }
        true
    }

    /// What has arrived while no descriptor was free waits in the receiver as far as it has room.
    fn drop_what_does_not_fit(&mut self, now: Time) {
        let (mut held, mut at) = (0, 0);
        while let Some((arrived, frame)) = self.arriving.get(at) {
            if *arrived > now {
                break;
            }
            if held + frame.len() > RECEIVE_FIFO {
                self.arriving.remove(at);
                self.lost += 1;
            } else {
                held += frame.len();
                at += 1;
            }
        }
    }

    fn is_for_this(&self, frame: &[u8]) -> bool {
        let Some(to) = frame.first_chunk::<6>() else {
            return false;
        };
        let low = self.word(ADDRESS_LOW).to_le_bytes();
        let high = self.word(ADDRESS_HIGH).to_le_bytes();
        let group = to[0] & 1 != 0;
        group || (to[..4] == low && to[4..] == high[..2]) || self.word(MACPFR) & PROMISCUOUS != 0
    }

    fn raise(&mut self, event: u32) {
        let status = self.word(STATUS) | event | NORMAL;
        self.set(STATUS, status);
    }
}

fn next(index: u32, last: u32) -> u32 {
    if index >= last & 0x3ff { 0 } else { index + 1 }
}

fn read_descriptor(memory: &mut impl Dma, address: u32) -> Option<[u32; 4]> {
    let mut bytes = [0; DESCRIPTOR as usize];
    memory.read(address, &mut bytes).then(|| {
        std::array::from_fn(|word| u32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * word + byte])))
    })
}
