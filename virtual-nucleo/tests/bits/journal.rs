//! What a board took in, in its order: ticks, datagrams, requests.
//!
//! The order is seen at the board's registers: a tick clears its timer's flag, and a frame that was taken gives its descriptor
//! back. The times are those that the firmware itself has read from its clock.

use crate::record::Asked;
use shared::protocol::framing::{decode_datagram, decode_message, message_length};
use shared::protocol::{Datagram, REQUEST_PORT, Request};
use smoltcp::wire::{EthernetFrame, IpProtocol, Ipv4Packet, TcpPacket, TcpSeqNumber, UdpPacket};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use virtual_nucleo::board::Board;
use virtual_nucleo::chip::RegisterAccess;
use virtual_nucleo::chip::ethernet::Frames;

/// TIM6_SR: written when a servo tick or a control tick begins.
const TICK: (&str, u32) = ("TIM6", 0x10);
/// TIM5_CNT: the board's clock \[µs\].
const CLOCK: (&str, u32) = ("TIM5", 0x24);
/// GPIOF_BSRR: on the tracker board PF7 triggers a camera.
const LINES: (&str, u32) = ("GPIOF", 0x18);
const TRIGGER: u32 = 1 << 7;
/// ETH_DMACRXDTPR: written when a descriptor is given back.
const TAKEN: (&str, u32) = ("ETH", 0x1128);

/// What a board did.
#[derive(Clone, Copy, Debug)]
enum Noted {
    Tick,
    Trigger,
    Clock(u32),
    Taken,
}

/// Something that a board took in.
#[derive(Clone, Debug)]
pub enum Event {
    /// A tick of the machine began; the cameras were triggered then, if they were \[µs\].
    Tick { strobed_us: Option<u64> },
    /// A datagram arrived then \[µs\].
    Datagram(Box<Datagram>, u64),
    /// A request came, and was answered.
    Asked(Box<Asked>),
}

/// What a board did, each with the exception that ran.
pub struct Journal(Rc<RefCell<Vec<(u16, Noted)>>>);

impl Journal {
    /// Begins with a board at power-up.
    pub fn keep(board: &mut Board) -> Self {
        board.ethernet_mut().expect("is there").record = Some(Frames::default());
        let notes = Rc::new(RefCell::new(Vec::new()));
        let journal = Self(Rc::clone(&notes));
        board.watch(Box::new(move |access: RegisterAccess| {
            let noted = match ((access.peripheral, access.offset), access.written) {
                // Before the first the timer is set up, in no exception.
                (TICK, true) if access.exception != 0 => Noted::Tick,
                (LINES, true) if access.value & TRIGGER != 0 => Noted::Trigger,
                (CLOCK, false) => Noted::Clock(access.value),
                // At its start the driver writes 0.
                (TAKEN, true) if access.value != 0 => Noted::Taken,
                _ => return,
            };
            notes.borrow_mut().push((access.exception, noted));
        }));
        journal
    }

    /// What the board took in: the frames it has `received`, of which the requests had the answers of `asked`.
    pub fn events(&self, received: &[Vec<u8>], asked: Vec<Asked>) -> Vec<Event> {
        let (mut received, mut asked) = (received.iter(), asked.into_iter());
        let (mut events, mut requests) = (Vec::new(), Stream::default());
        // The last reading of the clock in each exception.
        let mut clock = HashMap::new();
        let mut triggered = false;
        for (exception, noted) in self.0.borrow().iter() {
            match noted {
                Noted::Tick => {
                    triggered = false;
                    events.push(Event::Tick { strobed_us: None });
                }
                Noted::Trigger => triggered = true,
                Noted::Clock(us) => {
                    let us = u64::from(*us);
                    clock.insert(*exception, us);
                    // The firmware reads the clock right after it has triggered.
                    if let (true, Some(Event::Tick { strobed_us })) = (triggered, events.last_mut()) {
                        *strobed_us = Some(us);
                    }
                    triggered = false;
                }
                Noted::Taken => {
                    let frame = received.next().expect("a frame for each that was taken");
                    // The firmware reads the clock when it finds the frame, and gives it back after it has looked at it.
                    let arrived_us = clock[exception];
                    if let Some(datagram) = datagram(frame) {
                        events.push(Event::Datagram(Box::new(datagram), arrived_us));
                    }
                    requests.take(frame);
                    let came = std::iter::from_fn(|| requests.next()).filter(|request| !is_of_link(request));
                    events.extend(came.map(|request| {
                        let asked = asked.next().expect("an answer to each request");
                        assert_eq!(asked.request, request);
                        Event::Asked(Box::new(asked))
                    }));
                }
            }
        }
        assert_eq!(
            asked.next().map(|asked| asked.request),
            None,
            "a request did not come"
        );
        events
    }
}

/// Whether a request is answered before it comes to the controller.
fn is_of_link(request: &Request) -> bool {
    matches!(
        request,
        Request::Hello { .. } | Request::Subscribe { .. } | Request::PathStatesTo { .. }
    )
}

/// The contents of an IPv4 packet of this protocol.
fn contents(frame: &[u8], protocol: IpProtocol) -> Option<&[u8]> {
    let frame = EthernetFrame::new_checked(frame).ok()?;
    let packet = Ipv4Packet::new_checked(frame.payload()).ok()?;
    (packet.next_header() == protocol).then(|| packet.payload())
}

/// The datagram in a frame.
pub fn datagram(frame: &[u8]) -> Option<Datagram> {
    let packet = UdpPacket::new_checked(contents(frame, IpProtocol::Udp)?).ok()?;
    let (_, datagram) = decode_datagram(packet.payload()).ok()?;
    Some(datagram)
}

/// The stream of requests.
#[derive(Default)]
struct Stream {
    next: Option<TcpSeqNumber>,
    bytes: Vec<u8>,
}

impl Stream {
    /// Takes a frame, if it is of the stream and has more of it.
    fn take(&mut self, frame: &[u8]) {
        let Some(bytes) = contents(frame, IpProtocol::Tcp) else {
            return;
        };
        let segment = TcpPacket::new_checked(bytes).expect("TCP");
        if segment.dst_port() != REQUEST_PORT {
            return;
        }
        if segment.syn() {
            self.next = Some(segment.seq_number() + 1);
        } else if self.next == Some(segment.seq_number()) {
            self.next = Some(segment.seq_number() + segment.payload().len());
            self.bytes.extend_from_slice(segment.payload());
        }
    }

    /// The next request that is complete.
    fn next(&mut self) -> Option<Request> {
        let end = 2 + message_length(&self.bytes)?;
        let request = decode_message(self.bytes.get(2..end)?).expect("a request");
        self.bytes.drain(..end);
        Some(request)
    }
}
