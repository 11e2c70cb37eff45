//! A board's link, a firmware behind it that remembers, and a PC at the other end of the line.

use crate::line::{End, Line};
use link::{Address, Buffers, Counters, Link, Node, Source, Storage};
use shared::protocol::framing::{decode_datagram, decode_message, encode_datagram, encode_message};
use shared::protocol::{
    DATAGRAM_PORT, Datagram, Identity, Measurement, REQUEST_PORT, Refusal, Request, Response, Role,
    SCHEMA_HASH,
};
use smoltcp::iface::{Config, Interface, SocketHandle, SocketSet};
use smoltcp::socket::{tcp, udp};
use smoltcp::time::Instant;
use smoltcp::wire::{EthernetAddress, IpAddress, IpCidr, IpEndpoint, Ipv4Address};
use std::cell::Cell;
use std::rc::Rc;

pub const BOARD: [u8; 4] = [192, 168, 7, 2];
pub const PC: [u8; 4] = [192, 168, 7, 1];
pub const PC_PORT: u16 = 5000;
/// One step of the bench \[µs\].
pub const STEP: u64 = 1000;

/// A firmware that answers Status with Done and everything else with NotMine, and remembers.
#[derive(Default)]
pub struct Firmware {
    pub requests: Vec<Request>,
    pub datagrams: Vec<(Datagram, Source, u64)>,
    pub sessions_ended: u32,
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

pub struct Bench {
    pub now: Rc<Cell<u64>>,
    pub board_end: End,
    pub link: Link<'static>,
    pub firmware: Firmware,
    pub pc_end: End,
    pub pc: Interface,
    pub sockets: SocketSet<'static>,
    pub stream: SocketHandle,
    pub datagrams: SocketHandle,
    pub next_port: u16,
    pub received: Vec<u8>,
    /// Number of the session, once subscribed.
    pub number: u32,
}

pub fn identity() -> Identity {
    Identity {
        schema_hash: SCHEMA_HASH,
        role: Role::Motion,
        firmware: "0.1.0".try_into().unwrap(),
        board: "bench".try_into().unwrap(),
        simulated_machine: true,
    }
}

pub fn client() -> tcp::Socket<'static> {
    tcp::Socket::new(
        tcp::SocketBuffer::new(vec![0; 4096]),
        tcp::SocketBuffer::new(vec![0; 16384]),
    )
}

impl Bench {
    pub fn new() -> Self {
        Self::of(identity())
    }

    pub fn of(identity: Identity) -> Self {
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
        let buffers = Box::leak(Box::new(Buffers::new()));
        let link = Link::new(&mut board_end, storage, buffers, address, identity, 0);

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
    pub fn greeted() -> Self {
        let mut bench = Self::new();
        bench.connect();
        assert_eq!(bench.greet(), identity());
        bench
    }

    /// A bench with a session whose PC wants datagrams.
    pub fn subscribed() -> Self {
        let mut bench = Self::greeted();
        bench.subscribe();
        bench
    }

    /// Says Hello; returns who the board says it is.
    pub fn greet(&mut self) -> Identity {
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        match self.request(&hello) {
            Some(Response::Identity(identity)) => identity,
            other => panic!("{other:?}"),
        }
    }

    pub fn subscribe(&mut self) {
        match self.request(&Request::Subscribe { port: PC_PORT }) {
            Some(Response::Session { number }) => self.number = number,
            other => panic!("{other:?}"),
        }
    }

    pub fn stream(&mut self) -> &mut tcp::Socket<'static> {
        self.sockets.get_mut(self.stream)
    }

    pub fn udp(&mut self) -> &mut udp::Socket<'static> {
        self.sockets.get_mut(self.datagrams)
    }

    pub fn connect(&mut self) {
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

    /// Connects again, whatever has become of the stream.
    pub fn reconnect(&mut self) {
        self.sockets.remove(self.stream);
        self.stream = self.sockets.add(client());
        self.connect();
    }

    pub fn step(&mut self) {
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

    pub fn steps(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step();
        }
    }

    /// The next complete answer that has arrived.
    pub fn answer(&mut self) -> Option<Response> {
        let length = usize::from(u16::from_le_bytes(self.received.get(..2)?.try_into().unwrap()));
        let body = self.received.get(2..2 + length)?.to_vec();
        self.received.drain(..2 + length);
        Some(decode_message(&body).unwrap())
    }

    pub fn send(&mut self, request: &Request) {
        let mut buffer = [0; 4096];
        let bytes = encode_message(request, &mut buffer).unwrap();
        assert_eq!(self.stream().send_slice(bytes), Ok(bytes.len()));
    }

    /// One request, and the answer if it comes within five seconds.
    pub fn request(&mut self, request: &Request) -> Option<Response> {
        self.send(request);
        for _ in 0..5000 {
            self.step();
            if let Some(response) = self.answer() {
                return Some(response);
            }
        }
        None
    }

    pub fn send_datagram(&mut self, bytes: &[u8]) {
        let board = IpEndpoint::new(IpAddress::Ipv4(Ipv4Address::from(BOARD)), DATAGRAM_PORT);
        self.udp().send_slice(bytes, board).unwrap();
    }

    /// Sends a datagram of the session `number` to the board.
    pub fn say(&mut self, number: u32, datagram: &Datagram) {
        let mut buffer = [0; 256];
        let bytes = encode_datagram(number, datagram, &mut buffer).unwrap().to_vec();
        self.send_datagram(&bytes);
    }

    /// Datagrams that have arrived at the PC, all of its session.
    pub fn datagrams(&mut self) -> Vec<Datagram> {
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

pub fn measurement(capture: u32) -> Datagram {
    Datagram::Measurement(Measurement {
        capture,
        sides: [None; 2],
    })
}

pub const SUBSCRIBER: Source = Source {
    address: PC,
    port: PC_PORT,
};
