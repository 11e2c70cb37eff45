//! A board's link against a PC, both on smoltcp, joined by a line in memory and a virtual clock.

use link::{Address, Counters, Link, Node, Partner, Source, Storage};
use shared::protocol::framing::{
    MAX_MESSAGE, decode_datagram, decode_message, encode_datagram, encode_message,
};
use shared::protocol::{
    BeamPermit, ClockReply, ClockRequest, DATAGRAM_PORT, Datagram, Identity, Measurement, PathState, Permit,
    REQUEST_PORT, Refusal, Request, Response, Role, SCHEMA_HASH,
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
    sessions_ended: u32,
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

    fn session_ended(&mut self) {
        self.sessions_ended += 1;
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
    /// Number of the session, once subscribed.
    number: u32,
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
        Self::of(identity())
    }

    fn of(identity: Identity) -> Self {
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
        let link = Link::new(&mut board_end, storage, address, identity, 0);

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
            number: 0,
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

    /// A bench with a session whose PC wants datagrams.
    fn subscribed() -> Self {
        let mut bench = Self::greeted();
        bench.subscribe();
        bench
    }

    fn subscribe(&mut self) {
        match self.request(&Request::Subscribe { port: PC_PORT }) {
            Some(Response::Session { number }) => self.number = number,
            other => panic!("{other:?}"),
        }
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

    /// Sends a datagram of the session `number` to the board.
    fn say(&mut self, number: u32, datagram: &Datagram) {
        let mut buffer = [0; 256];
        let bytes = encode_datagram(number, datagram, &mut buffer).unwrap().to_vec();
        self.send_datagram(&bytes);
    }

    /// Datagrams that have arrived at the PC, all of its session.
    fn datagrams(&mut self) -> Vec<Datagram> {
        let mut all = Vec::new();
        let number = self.number;
        while let Ok((bytes, _)) = self.udp().recv() {
            let (session, datagram) = decode_datagram(bytes).unwrap();
            assert_eq!(session, number);
            all.push(datagram);
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
            session: 9,
        },
        &mut buffer,
    )
    .unwrap();
    for byte in bytes {
        assert_eq!(bench.answer(), None);
        bench.stream().send_slice(&[*byte]).unwrap();
        bench.steps(3);
    }
    bench.steps(20);
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
    assert!(!bench.link.is_subscribed());
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
    let mut bench = Bench::subscribed();
    assert!(bench.link.is_subscribed());
    // An orderly end, then an abrupt one.
    for abrupt in [false, true] {
        if abrupt {
            bench.stream().abort();
        } else {
            bench.stream().close();
        }
        bench.steps(20);
        assert_eq!((bench.link.session(), bench.link.is_subscribed()), (None, false));
        assert_eq!(bench.firmware.sessions_ended, 1 + u32::from(abrupt));
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
fn a_pc_that_vanishes_or_falls_silent_is_given_up() {
    let mut bench = Bench::greeted();
    // A request every 4 s renews the lease of 5 s.
    for _ in 0..3 {
        bench.steps(4000);
        assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    }
    for cut in [false, true] {
        // The cable is cut: every frame of the PC is lost. Else its TCP acknowledges what it is asked.
        bench.pc_end.lossy = u32::from(cut);
        bench.steps(4400);
        assert!(bench.link.session().is_some());
        bench.steps(1500);
        assert_eq!(bench.link.session(), None);
        assert_eq!(bench.firmware.sessions_ended, 1 + u32::from(cut));
        bench.pc_end.lossy = 0;
        bench.sockets.remove(bench.stream);
        bench.stream = bench.sockets.add(client());
        bench.connect();
        assert_eq!(bench.link.session(), Some(PC));
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        assert!(bench.request(&hello).is_some());
    }
}

#[test]
fn who_connects_and_says_no_hello_loses_the_place() {
    let mut bench = Bench::new();
    bench.connect();
    bench.steps(400);
    assert_eq!(bench.link.session(), Some(PC));
    bench.steps(200);
    assert_eq!(bench.link.session(), None);
    assert_eq!(bench.link.counters().silent_sessions, 1);
}

#[test]
fn a_connection_that_is_never_completed_loses_the_place() {
    let mut bench = Bench::new();
    bench.step();
    // The first frame of a connection gets through, and nothing after it.
    let (port, handle) = (39_999, bench.stream);
    let board = IpEndpoint::new(Ipv4Address::from(BOARD).into(), REQUEST_PORT);
    bench
        .sockets
        .get_mut::<tcp::Socket>(handle)
        .connect(bench.pc.context(), board, port)
        .unwrap();
    bench.steps(1);
    bench.pc_end.lossy = 1;
    bench.steps(800);
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
    let mut bench = Bench::subscribed();
    let mut buffer = [0; 256];
    let good = encode_datagram(bench.number, &measurement(7), &mut buffer)
        .unwrap()
        .to_vec();
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
    let mut bench = Bench::subscribed();
    for k in 0..15 {
        bench.say(bench.number, &measurement(k));
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
    let mut bench = Bench::subscribed();
    let request = Datagram::ClockRequest(ClockRequest { asked_us: 123 });
    bench.say(bench.number, &request);
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
    let mut bench = Bench::subscribed();
    assert!(bench.link.send_to_pc(&measurement(1)));
    bench.link.flush(&mut bench.board_end, bench.now.get());
    bench.step();
    assert_eq!(bench.datagrams(), [measurement(1)]);

    let accepted = (0..100)
        .filter(|k| bench.link.send_to_pc(&measurement(*k)))
        .count();
    bench.steps(3);
    assert_eq!(bench.datagrams().len(), accepted);
    assert_eq!(bench.link.counters().unsent as usize, 100 - accepted);
}

/// Somebody on the line who is neither the PC nor the other board, as the address of a partner.
const NOBODY: Source = Source {
    address: [192, 168, 7, 99],
    port: 7101,
};

#[test]
fn another_board_that_is_not_there_does_not_hold_up_the_pc() {
    let mut bench = Bench::subscribed();
    bench.link.set_partner(Partner {
        source: NOBODY,
        session: 5,
    });
    for k in 0..12 {
        bench.link.send_to_partner(&measurement(1000));
        bench.link.send_to_pc(&measurement(k));
        bench.step();
    }
    bench.step();
    assert_eq!(bench.datagrams(), (0..12).map(measurement).collect::<Vec<_>>());

    // Nor does what waits for it hold up the board that is found later.
    bench.link.set_partner(Partner {
        source: SUBSCRIBER,
        session: bench.number,
    });
    bench.link.send_to_partner(&measurement(50));
    // The socket asks for a missing neighbour once a second.
    bench.steps(1000);
    assert_eq!(bench.datagrams(), [measurement(50)]);
}

fn permit() -> Datagram {
    Datagram::Permit(Permit {
        tick: 1,
        path_id: 1,
        sides: [BeamPermit::Open; 2],
    })
}

fn path_state() -> Datagram {
    Datagram::PathState(PathState {
        tick: 1,
        time_us: 1000,
        sent_us: 1000,
        path_id: 1,
        s_mm: 0.0,
        speed_mm_s: 0.0,
        pose: [0.0; 9],
        tracking: false,
        beams: [false; 2],
        aside: [0.0; 3],
    })
}

fn heard(bench: &mut Bench) -> Vec<Datagram> {
    bench.steps(2);
    bench
        .firmware
        .datagrams
        .drain(..)
        .map(|(datagram, ..)| datagram)
        .collect()
}

#[test]
fn datagrams_are_taken_of_the_pc_and_the_other_board_only_and_with_their_number() {
    let clock = Datagram::ClockRequest(ClockRequest { asked_us: 1 });
    let mut bench = Bench::greeted();
    // Nobody has subscribed: nobody is believed, whatever number is guessed.
    for number in [0, 1] {
        bench.say(number, &measurement(1));
        bench.say(number, &clock);
    }
    assert!(heard(&mut bench).is_empty() && bench.datagrams().is_empty());
    bench.subscribe();
    let (number, stranger) = (
        bench.number,
        Source {
            port: PC_PORT + 1,
            ..SUBSCRIBER
        },
    );
    bench.say(number ^ 1, &measurement(2));
    bench.say(number ^ 1, &clock);
    bench.say(number, &permit());
    assert!(heard(&mut bench).is_empty() && bench.datagrams().is_empty());
    bench.say(number, &measurement(3));
    assert_eq!(heard(&mut bench), [measurement(3)]);

    // Another port of the same host is not the other board, nor is another number.
    for (source, session, taken) in [
        (stranger, 77, false),
        (SUBSCRIBER, 78, false),
        (SUBSCRIBER, 77, true),
    ] {
        bench.link.set_partner(Partner { source, session });
        bench.say(77, &permit());
        assert_eq!(
            heard(&mut bench).len(),
            usize::from(taken),
            "{source:?} {session}"
        );
    }
    assert_eq!(bench.link.counters().strange_datagrams, 9);
}

#[test]
fn the_tracker_board_finds_the_motion_board_by_the_number_of_its_session() {
    let mut bench = Bench::of(Identity {
        role: Role::Tracker,
        ..identity()
    });
    bench.connect();
    let hello = Request::Hello {
        schema_hash: SCHEMA_HASH,
    };
    assert!(bench.request(&hello).is_some());
    bench.subscribe();
    bench.say(bench.number ^ 1, &path_state());
    assert!(heard(&mut bench).is_empty() && !bench.link.send_to_partner(&permit()));
    bench.say(bench.number, &path_state());
    assert_eq!(heard(&mut bench), [path_state()]);
    assert!(bench.link.send_to_partner(&permit()));
    bench.steps(2);
    assert_eq!(bench.datagrams(), [permit()]);
    // With the session the other board is forgotten.
    bench.stream().close();
    bench.steps(20);
    bench.say(bench.number, &path_state());
    assert!(heard(&mut bench).is_empty() && !bench.link.send_to_partner(&permit()));
}

#[test]
fn no_two_sessions_have_the_same_number() {
    let mut bench = Bench::subscribed();
    let mut numbers = vec![bench.number];
    for _ in 0..20 {
        bench.stream().abort();
        bench.steps(20);
        bench.sockets.remove(bench.stream);
        bench.stream = bench.sockets.add(client());
        bench.connect();
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        assert!(bench.request(&hello).is_some());
        bench.subscribe();
        assert!(bench.number != 0 && !numbers.contains(&bench.number));
        numbers.push(bench.number);
    }
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
