//! A board's link against a PC, both on smoltcp, joined by a line in memory and a virtual clock.

use link::{Address, Counters, Link, Node, Source, Storage};
use shared::protocol::framing::{
    MAX_MESSAGE, decode_datagram, decode_message, encode_datagram, encode_message,
};
use shared::protocol::{
    ClockReply, ClockRequest, DATAGRAM_PORT, Datagram, Identity, Measurement, REQUEST_PORT, Refusal, Request,
    Response, Role, SCHEMA_HASH,
};
use smoltcp::iface::{Config, Interface, SocketHandle, SocketSet};
use smoltcp::phy::{Device, DeviceCapabilities, Medium, RxToken, TxToken};
use smoltcp::socket::{tcp, udp};
use smoltcp::time::Instant;
use smoltcp::wire::{EthernetAddress, IpAddress, IpCidr, IpEndpoint, Ipv4Address};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

const BOARD: [u8; 4] = [192, 168, 7, 2];
const PC: [u8; 4] = [192, 168, 7, 1];
const PC_PORT: u16 = 5000;
/// One step of the bench \[µs\].
const STEP: u64 = 1000;

type Line = Rc<RefCell<VecDeque<Vec<u8>>>>;

/// One end of the line. Loses every `lossy`-th frame it should send, none if 0.
struct End {
    incoming: Line,
    outgoing: Line,
    lossy: u32,
    sent: u32,
}

struct Received(Vec<u8>);
struct Room<'a>(&'a mut End);

impl RxToken for Received {
    fn consume<R, F: FnOnce(&[u8]) -> R>(self, f: F) -> R {
        f(&self.0)
    }
}

impl TxToken for Room<'_> {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, len: usize, f: F) -> R {
        let mut frame = vec![0; len];
        let result = f(&mut frame);
        self.0.sent += 1;
        if self.0.lossy == 0 || !self.0.sent.is_multiple_of(self.0.lossy) {
            self.0.outgoing.borrow_mut().push_back(frame);
        }
        result
    }
}

impl Device for End {
    type RxToken<'a> = Received;
    type TxToken<'a> = Room<'a>;

    fn receive(&mut self, _: Instant) -> Option<(Received, Room<'_>)> {
        let frame = self.incoming.borrow_mut().pop_front()?;
        Some((Received(frame), Room(self)))
    }

    fn transmit(&mut self, _: Instant) -> Option<Room<'_>> {
        Some(Room(self))
    }

    fn capabilities(&self) -> DeviceCapabilities {
        let mut capabilities = DeviceCapabilities::default();
        capabilities.medium = Medium::Ethernet;
        capabilities.max_transmission_unit = 1514;
        capabilities
    }
}

/// A firmware that answers Status with Done and everything else with NotMine, and remembers.
#[derive(Default)]
struct Firmware {
    requests: Vec<Request>,
    datagrams: Vec<(Datagram, Source, u64)>,
}

impl Node for Firmware {
    fn handle(&mut self, request: &Request, _: &Counters) -> Response {
        self.requests.push(request.clone());
        match request {
            Request::Status => Response::Done,
            _ => Response::Refused(Refusal::NotMine),
        }
    }

    fn datagram(&mut self, datagram: &Datagram, from: Source, arrived_us: u64) {
        self.datagrams.push((datagram.clone(), from, arrived_us));
    }
}

struct Bench {
    now: Rc<Cell<u64>>,
    board_end: End,
    link: Link<'static>,
    firmware: Firmware,
    pc_end: End,
    pc: Interface,
    sockets: SocketSet<'static>,
    stream: SocketHandle,
    datagrams: SocketHandle,
    next_port: u16,
    received: Vec<u8>,
}

fn identity() -> Identity {
    Identity {
        schema_hash: SCHEMA_HASH,
        role: Role::Motion,
        firmware: "0.1.0".try_into().unwrap(),
        board: "bench".try_into().unwrap(),
        simulated_machine: true,
    }
}

fn client() -> tcp::Socket<'static> {
    tcp::Socket::new(
        tcp::SocketBuffer::new(vec![0; 4096]),
        tcp::SocketBuffer::new(vec![0; 16384]),
    )
}

impl Bench {
    fn new() -> Self {
        let (a, b) = (Line::default(), Line::default());
        let end = |incoming: &Line, outgoing: &Line| End {
            incoming: incoming.clone(),
            outgoing: outgoing.clone(),
            lossy: 0,
            sent: 0,
        };
        let (mut board_end, mut pc_end) = (end(&a, &b), end(&b, &a));
        let address = Address {
            mac: [2, 0, 0, 0, 0, 2],
            ip: BOARD,
            prefix: 24,
            gateway: PC,
        };
        let storage = Box::leak(Box::new(Storage::new()));
        let link = Link::new(&mut board_end, storage, address, identity(), 0);

        let config = Config::new(EthernetAddress([2, 0, 0, 0, 0, 1]).into());
        let mut pc = Interface::new(config, &mut pc_end, Instant::ZERO);
        pc.update_ip_addrs(|addresses| {
            addresses
                .push(IpCidr::new(Ipv4Address::from(PC).into(), 24))
                .unwrap()
        });
        let mut sockets = SocketSet::new(vec![]);
        let buffer = || udp::PacketBuffer::new(vec![udp::PacketMetadata::EMPTY; 16], vec![0; 16384]);
        let mut socket = udp::Socket::new(buffer(), buffer());
        socket.bind(PC_PORT).unwrap();
        let datagrams = sockets.add(socket);
        let stream = sockets.add(client());
        Self {
            now: Rc::new(Cell::new(0)),
            board_end,
            link,
            firmware: Firmware::default(),
            pc_end,
            pc,
            sockets,
            stream,
            datagrams,
            next_port: 40_000,
            received: Vec::new(),
        }
    }

    /// A bench with a session that has said Hello.
    fn greeted() -> Self {
        let mut bench = Self::new();
        bench.connect();
        let hello = bench.request(&Request::Hello {
            schema_hash: SCHEMA_HASH,
        });
        assert_eq!(hello, Some(Response::Identity(identity())));
        bench
    }

    fn stream(&mut self) -> &mut tcp::Socket<'static> {
        self.sockets.get_mut(self.stream)
    }

    fn udp(&mut self) -> &mut udp::Socket<'static> {
        self.sockets.get_mut(self.datagrams)
    }

    fn connect(&mut self) {
        self.next_port += 1;
        let (port, handle) = (self.next_port, self.stream);
        let board = IpEndpoint::new(Ipv4Address::from(BOARD).into(), REQUEST_PORT);
        self.received.clear();
        self.sockets
            .get_mut::<tcp::Socket>(handle)
            .connect(self.pc.context(), board, port)
            .unwrap();
        self.steps(10);
    }

    fn step(&mut self) {
        let now = self.now.get() + STEP;
        self.now.set(now);
        self.pc.poll(
            Instant::from_micros(now as i64),
            &mut self.pc_end,
            &mut self.sockets,
        );
        // Frames arrive 40 µs before the board looks.
        self.link
            .poll(&mut self.board_end, |_| now - 40, || now, &mut self.firmware);
        self.pc.poll(
            Instant::from_micros(now as i64),
            &mut self.pc_end,
            &mut self.sockets,
        );
        let socket = self.sockets.get_mut::<tcp::Socket>(self.stream);
        while socket.can_recv() {
            let received = &mut self.received;
            socket
                .recv(|bytes| {
                    received.extend_from_slice(bytes);
                    (bytes.len(), ())
                })
                .unwrap();
        }
    }

    fn steps(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step();
        }
    }

    /// The next complete answer that has arrived.
    fn answer(&mut self) -> Option<Response> {
        let length = usize::from(u16::from_le_bytes(self.received.get(..2)?.try_into().unwrap()));
        let body = self.received.get(2..2 + length)?.to_vec();
        self.received.drain(..2 + length);
        Some(decode_message(&body).unwrap())
    }

    fn send(&mut self, request: &Request) {
        let mut buffer = [0; 4096];
        let bytes = encode_message(request, &mut buffer).unwrap();
        assert_eq!(self.stream().send_slice(bytes), Ok(bytes.len()));
    }

    /// One request, and the answer if it comes within five seconds.
    fn request(&mut self, request: &Request) -> Option<Response> {
        self.send(request);
        for _ in 0..5000 {
            self.step();
            if let Some(response) = self.answer() {
                return Some(response);
            }
        }
        None
    }

    fn send_datagram(&mut self, bytes: &[u8]) {
        let board = IpEndpoint::new(IpAddress::Ipv4(Ipv4Address::from(BOARD)), DATAGRAM_PORT);
        self.udp().send_slice(bytes, board).unwrap();
    }

    /// Datagrams that have arrived at the PC.
    fn datagrams(&mut self) -> Vec<Datagram> {
        let mut all = Vec::new();
        while let Ok((bytes, _)) = self.udp().recv() {
            all.push(decode_datagram(bytes).unwrap());
        }
        all
    }
}

fn measurement(capture: u32) -> Datagram {
    Datagram::Measurement(Measurement {
        capture,
        sides: [None; 2],
    })
}

const SUBSCRIBER: Source = Source {
    address: PC,
    port: PC_PORT,
};

#[test]
fn requests_are_answered_in_order() {
    let mut bench = Bench::greeted();
    assert_eq!(bench.link.session(), Some(PC));
    bench.send(&Request::Status);
    bench.send(&Request::Home);
    bench.send(&Request::Status);
    bench.steps(50);
    let answers: Vec<_> = std::iter::from_fn(|| bench.answer()).collect();
    let refused = Response::Refused(Refusal::NotMine);
    assert_eq!(answers, [Response::Done, refused, Response::Done]);
    assert_eq!(
        bench.firmware.requests,
        [Request::Status, Request::Home, Request::Status]
    );
    assert_eq!(bench.link.counters().requests, 4);
}

#[test]
fn a_request_may_come_byte_by_byte() {
    let mut bench = Bench::greeted();
    let mut buffer = [0; 64];
    let bytes = encode_message(
        &Request::PathStatesTo {
            address: BOARD,
            port: 7,
        },
        &mut buffer,
    )
    .unwrap();
    for byte in bytes {
        assert_eq!(bench.answer(), None);
        bench.stream().send_slice(&[*byte]).unwrap();
        bench.steps(3);
    }
    assert_eq!(bench.answer(), Some(Response::Refused(Refusal::NotMine)));
}

#[test]
fn a_long_run_of_requests_is_answered_completely_even_if_the_pc_reads_late() {
    let mut bench = Bench::greeted();
    for _ in 0..2000 {
        bench.send(&Request::Status);
    }
    bench.steps(1000);
    let answers = std::iter::from_fn(|| bench.answer()).count();
    assert_eq!((answers, bench.firmware.requests.len()), (2000, 2000));
}

#[test]
fn malformed_bytes_are_refused_and_the_session_goes_on() {
    let mut bench = Bench::greeted();
    bench.stream().send_slice(&[3, 0, 0xFF, 0xFF, 0xFF]).unwrap();
    bench.steps(10);
    assert_eq!(bench.answer(), Some(Response::Refused(Refusal::Malformed)));
    assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    assert_eq!(bench.link.counters().malformed_requests, 1);
}

#[test]
fn nothing_but_hello_is_answered_before_a_hello_of_the_same_schema() {
    let mut bench = Bench::new();
    bench.connect();
    let refused = Some(Response::Refused(Refusal::WrongSchema));
    assert_eq!(bench.request(&Request::Status), refused);
    let other = Request::Hello {
        schema_hash: SCHEMA_HASH ^ 1,
    };
    assert_eq!(bench.request(&other), Some(Response::Identity(identity())));
    assert_eq!(bench.request(&Request::Status), refused);
    assert_eq!(bench.request(&Request::Subscribe { port: PC_PORT }), refused);
    assert_eq!(bench.link.subscriber(), None);
    assert!(bench.firmware.requests.is_empty());
}

#[test]
fn an_impossible_length_ends_the_session_and_the_board_listens_again() {
    for length in [0, MAX_MESSAGE + 1, 0xFFFF] {
        let mut bench = Bench::greeted();
        bench.stream().send_slice(&(length as u16).to_le_bytes()).unwrap();
        bench.steps(10);
        assert!(!bench.stream().is_open());
        assert_eq!(
            (bench.link.session(), bench.link.counters().broken_streams),
            (None, 1)
        );
        bench.connect();
        assert_eq!(
            bench.request(&Request::Status),
            Some(Response::Refused(Refusal::WrongSchema))
        );
    }
}

#[test]
fn after_a_session_the_next_one_starts_from_hello_without_subscriber() {
    let mut bench = Bench::greeted();
    assert_eq!(
        bench.request(&Request::Subscribe { port: PC_PORT }),
        Some(Response::Done)
    );
    assert_eq!(bench.link.subscriber(), Some(SUBSCRIBER));
    // An orderly end, then an abrupt one.
    for abrupt in [false, true] {
        if abrupt {
            bench.stream().abort();
        } else {
            bench.stream().close();
        }
        bench.steps(20);
        assert_eq!((bench.link.session(), bench.link.subscriber()), (None, None));
        bench.sockets.remove(bench.stream);
        bench.stream = bench.sockets.add(client());
        bench.connect();
        assert_eq!(
            bench.request(&Request::Status),
            Some(Response::Refused(Refusal::WrongSchema))
        );
    }
    assert_eq!(bench.link.counters().sessions, 3);
}

#[test]
fn a_second_pc_is_turned_away_and_the_first_does_not_notice() {
    let mut bench = Bench::greeted();
    let first = bench.stream;
    bench.stream = bench.sockets.add(client());
    bench.connect();
    assert!(!bench.stream().is_open());
    bench.stream = first;
    assert_eq!(bench.request(&Request::Status), Some(Response::Done));
}

#[test]
fn a_pc_that_vanishes_is_given_up_and_a_silent_one_is_not() {
    let mut bench = Bench::greeted();
    bench.steps(10_000);
    assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    // The cable is cut: every frame of the PC is lost.
    bench.pc_end.lossy = 1;
    bench.steps(4400);
    assert!(bench.link.session().is_some());
    bench.steps(1500);
    assert_eq!(bench.link.session(), None);
    bench.pc_end.lossy = 0;
    bench.sockets.remove(bench.stream);
    bench.stream = bench.sockets.add(client());
    bench.connect();
    assert_eq!(bench.link.session(), Some(PC));
}

#[test]
fn requests_come_through_a_line_that_loses_frames() {
    let mut bench = Bench::greeted();
    bench.pc_end.lossy = 7;
    bench.board_end.lossy = 10;
    for _ in 0..30 {
        assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    }
    assert_eq!(bench.firmware.requests.len(), 30);
}

#[test]
fn datagrams_come_with_their_source_and_arrival_and_bad_ones_are_counted() {
    let mut bench = Bench::greeted();
    let mut buffer = [0; 256];
    let good = encode_datagram(&measurement(7), &mut buffer).unwrap().to_vec();
    let mut foreign = good.clone();
    foreign[0] ^= 1;
    let mut malformed = good.clone();
    malformed.push(0);
    for bytes in [&foreign[..], &malformed, &[], &[1, 2, 3], &[0xEE; 1470], &good] {
        bench.send_datagram(bytes);
    }
    bench.steps(5);
    let counters = bench.link.counters();
    assert_eq!(counters.foreign_datagrams, 2);
    assert_eq!(counters.malformed_datagrams, 3);
    assert_eq!(counters.datagrams, 1);
    let [(datagram, from, arrived_us)] = &bench.firmware.datagrams[..] else {
        panic!("one datagram expected")
    };
    assert_eq!((datagram, *from), (&measurement(7), SUBSCRIBER));
    assert_eq!(arrived_us % STEP, STEP - 40);
}

#[test]
fn a_burst_of_datagrams_is_taken_without_loss() {
    let mut bench = Bench::greeted();
    let mut buffer = [0; 256];
    for k in 0..15 {
        let bytes = encode_datagram(&measurement(k), &mut buffer).unwrap().to_vec();
        bench.send_datagram(&bytes);
    }
    bench.step();
    let numbers: Vec<_> = bench
        .firmware
        .datagrams
        .iter()
        .map(|(datagram, ..)| datagram.clone())
        .collect();
    assert_eq!(numbers, (0..15).map(measurement).collect::<Vec<_>>());
}

#[test]
fn the_board_tells_its_clock() {
    let mut bench = Bench::greeted();
    let mut buffer = [0; 64];
    let request = Datagram::ClockRequest(ClockRequest { asked_us: 123 });
    let bytes = encode_datagram(&request, &mut buffer).unwrap().to_vec();
    bench.send_datagram(&bytes);
    bench.step();
    let now = bench.now.get();
    let expected = ClockReply {
        asked_us: 123,
        received_us: now - 40,
        replied_us: now,
    };
    assert_eq!(bench.datagrams(), [Datagram::ClockReply(expected)]);
}

#[test]
fn datagrams_leave_with_flush_and_those_without_room_are_counted() {
    let mut bench = Bench::greeted();
    assert!(bench.link.send(&measurement(1), SUBSCRIBER));
    bench.link.flush(&mut bench.board_end, bench.now.get());
    bench.step();
    assert_eq!(bench.datagrams(), [measurement(1)]);

    let accepted = (0..100)
        .filter(|k| bench.link.send(&measurement(*k), SUBSCRIBER))
        .count();
    bench.steps(3);
    assert_eq!(bench.datagrams().len(), accepted);
    assert_eq!(bench.link.counters().unsent as usize, 100 - accepted);
}

#[test]
fn a_host_that_is_not_there_does_not_hold_up_the_subscriber() {
    let mut bench = Bench::greeted();
    let nobody = Source {
        address: [192, 168, 7, 99],
        port: 7101,
    };
    for k in 0..12 {
        bench.link.send(&measurement(1000), nobody);
        bench.link.send(&measurement(k), SUBSCRIBER);
        bench.step();
    }
    bench.step();
    assert_eq!(bench.datagrams(), (0..12).map(measurement).collect::<Vec<_>>());
}

#[test]
fn the_board_announces_itself_until_the_first_session() {
    let mut bench = Bench::new();
    let line = bench.board_end.outgoing.clone();
    let announcements = |bench: &mut Bench, steps: u32| {
        let mut seen = 0;
        for _ in 0..steps {
            let now = bench.now.get() + STEP;
            bench.now.set(now);
            bench
                .link
                .poll(&mut bench.board_end, |_| now, || now, &mut bench.firmware);
            // Broadcast, ARP, from and for the board's own address.
            let arp = |frame: &Vec<u8>| frame[..6] == [0xFF; 6] && frame[12..14] == [8, 6];
            let own = |frame: &Vec<u8>| frame[28..32] == BOARD && frame[38..42] == BOARD;
            seen += line
                .borrow_mut()
                .drain(..)
                .filter(|frame| arp(frame) && own(frame))
                .count();
        }
        seen
    };
    assert_eq!(announcements(&mut bench, 3000), 3);
    bench.connect();
    assert_eq!(announcements(&mut bench, 3000), 0);
}
