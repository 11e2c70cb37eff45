//! The sockets of a board and their service.

use crate::address::{Address, Partner, Source};
use crate::announce::announce;
use crate::counters::{Counters, count};
use crate::session::{Node, Session, number};
use crate::storage::{Buffers, FRAME, Storage};
use shared::protocol::framing::{self, FrameError, MAX_MESSAGE};
use shared::protocol::{
    ClockReply, DATAGRAM_PORT, Datagram, Identity, REQUEST_PORT, Refusal, Request, Response, Role,
};
use smoltcp::iface::{Config, Interface, PollIngressSingleResult, PollResult, SocketHandle, SocketSet};
use smoltcp::phy::Device;
use smoltcp::socket::{tcp, udp};
use smoltcp::time::{Duration, Instant};
use smoltcp::wire::{EthernetAddress, IpAddress, IpCidr, IpEndpoint, Ipv4Address};

/// A session whose PC has not acknowledged anything for this long is given up.
const TIMEOUT: Duration = Duration::from_secs(5);
/// A silent PC is probed this often.
const KEEP_ALIVE: Duration = Duration::from_millis(500);
/// A connection must be complete after so long \[µs\].
const HALF_OPEN_US: u64 = 500_000;
/// The board announces itself this often until the first session \[µs\].
const ANNOUNCE_US: u64 = 1_000_000;
/// Most frames taken, and most sent, in one call.
const BURST: usize = 32;

/// The network of one board.
pub struct Link<'a> {
    interface: Interface,
    sockets: SocketSet<'a>,
    stream: SocketHandle,
    /// Receives everything, sends to the PC.
    to_pc: SocketHandle,
    /// Sends to the other board. Each has its own: nothing waits behind a host that does not answer ARP.
    to_partner: SocketHandle,
    frame: &'a mut [u8; FRAME],
    address: Address,
    identity: Identity,
    session: Option<Session>,
    partner: Option<Partner>,
    half_open_since_us: Option<u64>,
    announce_at_us: Option<u64>,
    counters: Counters,
}

impl<'a> Link<'a> {
    /// A link that listens at `address` and introduces itself as `identity`. `now_us` also seeds the sequence
    /// numbers.
    ///
    /// # Panics
    /// If `address.prefix` is above 32.
    pub fn new(
        device: &mut (impl Device + ?Sized),
        storage: &'a mut Storage<'a>,
        buffers: &'a mut Buffers,
        address: Address,
        identity: Identity,
        now_us: u64,
    ) -> Self {
        let mut config = Config::new(EthernetAddress(address.mac).into());
        config.random_seed = now_us;
        let mut interface = Interface::new(config, device, instant(now_us));
        let ip = IpAddress::Ipv4(Ipv4Address::from(address.ip));
        // Neither can fail: smoltcp has room for at least one address and one route.
        interface.update_ip_addrs(|addresses| {
            let _ = addresses.push(IpCidr::new(ip, address.prefix));
        });
        let _ = interface
            .routes_mut()
            .add_default_ipv4_route(Ipv4Address::from(address.gateway));

        let mut stream = tcp::Socket::new(
            tcp::SocketBuffer::new(&mut buffers.requests[..]),
            tcp::SocketBuffer::new(&mut buffers.responses[..]),
        );
        stream.set_nagle_enabled(false);
        stream.set_timeout(Some(TIMEOUT));
        stream.set_keep_alive(Some(KEEP_ALIVE));
        let to_pc = udp_socket(
            packets(&mut storage.incoming, &mut buffers.incoming),
            packets(&mut storage.to_pc, &mut buffers.to_pc),
        );
        let to_partner = udp_socket(
            packets(&mut storage.nothing, &mut buffers.nothing),
            packets(&mut storage.to_partner, &mut buffers.to_partner),
        );

        let mut sockets = SocketSet::new(&mut storage.sockets[..]);
        // The first of the two UDP sockets gets what arrives.
        let to_pc = sockets.add(to_pc);
        let to_partner = sockets.add(to_partner);
        let stream = sockets.add(stream);
        let mut link = Self {
            interface,
            sockets,
            stream,
            to_pc,
            to_partner,
            frame: &mut buffers.frame,
            address,
            identity,
            session: None,
            partner: None,
            half_open_since_us: None,
            announce_at_us: Some(now_us),
            counters: Counters::default(),
        };
        link.listen();
        link
    }

    /// Takes the frames that wait in `device`, answers what there is to answer, sends what there is to send.
    ///
    /// `arrived` is when the device received the frame it handed out last \[µs\], `clock` the time now
    /// \[µs\], both on the board's one timebase. True if frames may be left in the device: call again soon.
    pub fn poll<D: Device + ?Sized>(
        &mut self,
        device: &mut D,
        arrived: impl Fn(&D) -> u64,
        clock: impl Fn() -> u64,
        node: &mut impl Node,
    ) -> bool {
        let mut more = true;
        for _ in 0..BURST {
            let now = instant(clock());
            let taken = self.interface.poll_ingress_single(now, device, &mut self.sockets);
            // Datagrams at once, while the device still knows when this frame arrived.
            self.take_datagrams(device, arrived(device), &clock, node);
            self.serve(device, &clock, node);
            if taken == PollIngressSingleResult::None {
                more = false;
                break;
            }
        }
        self.announce(device, clock());
        self.flush(device, clock());
        more
    }

    /// Queues a datagram for the PC; [`Link::flush`] or the next [`Link::poll`] sends it. False if no PC wants any, or,
    /// counted, if there is no room.
    pub fn send_to_pc(&mut self, datagram: &Datagram) -> bool {
        let to = self
            .session
            .and_then(|session| Some((session.subscriber?, session.number)));
        to.is_some_and(|(to, number)| self.queue(self.to_pc, datagram, to, number))
    }

    /// The same for the other board, once it is known.
    pub fn send_to_partner(&mut self, datagram: &Datagram) -> bool {
        self.partner
            .is_some_and(|partner| self.queue(self.to_partner, datagram, partner.source, partner.session))
    }

    fn queue(&mut self, socket: SocketHandle, datagram: &Datagram, to: Source, number: u32) -> bool {
        let endpoint = IpEndpoint::new(IpAddress::Ipv4(Ipv4Address::from(to.address)), to.port);
        let socket = self.sockets.get_mut::<udp::Socket>(socket);
        let queued = framing::encode_datagram(number, datagram, &mut self.frame[..])
            .is_ok_and(|bytes| socket.send_slice(bytes, endpoint).is_ok());
        if !queued {
            count(&mut self.counters.unsent);
        }
        queued
    }

    /// Where the other board is. The tracker board does not need it: it finds it by the first path state that
    /// carries the number of its session.
    pub fn set_partner(&mut self, partner: Partner) {
        if self.partner != Some(partner) {
            // What waits for the old one must not hold up the new one.
            empty(self.sockets.get_mut(self.to_partner));
            self.partner = Some(partner);
        }
    }

    /// Sends what is queued, as far as `device` has room.
    pub fn flush(&mut self, device: &mut (impl Device + ?Sized), now_us: u64) {
        for _ in 0..BURST {
            let sent = self
                .interface
                .poll_egress(instant(now_us), device, &mut self.sockets);
            if sent == PollResult::None {
                break;
            }
        }
    }

    /// The PC of this session wants telemetry and captures.
    pub fn is_subscribed(&self) -> bool {
        self.session.is_some_and(|session| session.subscriber.is_some())
    }

    /// IPv4 address of the PC of this session.
    pub fn session(&self) -> Option<[u8; 4]> {
        self.session.map(|session| session.peer)
    }

    /// What has happened since boot.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    fn announce(&mut self, device: &mut (impl Device + ?Sized), now_us: u64) {
        if self.session.is_some() {
            self.announce_at_us = None;
        }
        if self.announce_at_us.is_some_and(|due| now_us >= due) {
            self.announce_at_us = Some(now_us + ANNOUNCE_US);
            let ip = Ipv4Address::from(self.address.ip);
            announce(device, EthernetAddress(self.address.mac), ip, instant(now_us));
        }
    }

    fn take_datagrams(
        &mut self,
        device: &mut (impl Device + ?Sized),
        arrived_us: u64,
        clock: &impl Fn() -> u64,
        node: &mut impl Node,
    ) {
        while let Ok((bytes, metadata)) = self.sockets.get_mut::<udp::Socket>(self.to_pc).recv() {
            let IpAddress::Ipv4(address) = metadata.endpoint.addr;
            let from = Source {
                address: address.octets(),
                port: metadata.endpoint.port,
            };
            match framing::decode_datagram(bytes) {
                Ok((session, datagram)) => {
                    count(&mut self.counters.datagrams);
                    let Some(sender) = self.sender(from, session, &datagram) else {
                        count(&mut self.counters.strange_datagrams);
                        continue;
                    };
                    let Datagram::ClockRequest(request) = datagram else {
                        node.datagram(&datagram, from, arrived_us);
                        continue;
                    };
                    let now_us = clock();
                    let reply = Datagram::ClockReply(ClockReply {
                        asked_us: request.asked_us,
                        received_us: arrived_us,
                        replied_us: now_us,
                    });
                    match sender {
                        Sender::Pc => self.send_to_pc(&reply),
                        Sender::Partner => self.send_to_partner(&reply),
                    };
                    self.flush(device, now_us);
                }
                Err(FrameError::WrongSchema) => count(&mut self.counters.foreign_datagrams),
                Err(FrameError::Malformed | FrameError::TooLong) => {
                    count(&mut self.counters.malformed_datagrams);
                }
            }
        }
    }

    /// The sender of a datagram, if it may send: by address, port and number of the session.
    fn sender(&mut self, from: Source, number: u32, datagram: &Datagram) -> Option<Sender> {
        let session = self.session?;
        let finds_partner = self.identity.role == Role::Tracker
            && self.partner.is_none()
            && number == session.number
            && matches!(datagram, Datagram::PathState(_));
        if finds_partner {
            self.set_partner(Partner {
                source: from,
                session: number,
            });
        }
        let of_pc = session.subscriber == Some(from) && session.number == number;
        let of_partner = self.partner
            == Some(Partner {
                source: from,
                session: number,
            });
        match datagram {
            Datagram::Measurement(_) => of_pc.then_some(Sender::Pc),
            Datagram::PathState(_) | Datagram::Permit(_) | Datagram::ClockReply(_) => {
                of_partner.then_some(Sender::Partner)
            }
            Datagram::ClockRequest(_) if of_pc => Some(Sender::Pc),
            Datagram::ClockRequest(_) => of_partner.then_some(Sender::Partner),
            Datagram::Capture(_) | Datagram::MotionTelemetry(_) | Datagram::TrackerTelemetry(_) => None,
        }
    }

    /// Begins and ends sessions and answers the requests that are complete, as long as an answer of any
    /// length fits.
    fn serve(&mut self, device: &mut (impl Device + ?Sized), clock: &impl Fn() -> u64, node: &mut impl Node) {
        if !self.sockets.get::<tcp::Socket>(self.stream).is_open() {
            // A reset that is still to be sent would be forgotten.
            self.flush(device, clock());
            self.end_session(node);
            self.listen();
            return;
        }
        let now_us = clock();
        let stream = self.sockets.get_mut::<tcp::Socket>(self.stream);
        if self.session.is_none()
            && stream.may_recv()
            && let Some(IpAddress::Ipv4(peer)) = stream.remote_endpoint().map(|peer| peer.addr)
        {
            count(&mut self.counters.sessions);
            let number = number(self.address.mac, self.counters.sessions, now_us);
            self.session = Some(Session::new(peer.octets(), number, now_us));
        }
        self.give_up_half_open(now_us);
        let stream = self.sockets.get_mut::<tcp::Socket>(self.stream);
        let Some(session) = &mut self.session else { return };
        let subscriber = session.subscriber;
        if session.is_over(now_us) {
            count(&mut self.counters.silent_sessions);
            stream.abort();
        }

        while stream.send_capacity() - stream.send_queue() >= FRAME {
            let mut prefix = [0; 2];
            let peeked = stream.peek_slice(&mut prefix).unwrap_or(0);
            let Some(length) = framing::message_length(&prefix[..peeked]) else {
                break;
            };
            if length == 0 || length > MAX_MESSAGE {
                // What follows could not be separated from the rest of this message.
                count(&mut self.counters.broken_streams);
                stream.abort();
                break;
            }
            let message = 2..2 + length;
            if stream.recv_queue() < message.end {
                break;
            }
            // The whole message is there, hence neither this nor the response below can fail.
            let _ = stream.recv_slice(&mut self.frame[..message.end]);
            count(&mut self.counters.requests);
            let response = match framing::decode_message::<Request>(&self.frame[message]) {
                Ok(request) => session.answer(&request, &self.identity, &self.counters, now_us, node),
                Err(_) => {
                    count(&mut self.counters.malformed_requests);
                    Response::Refused(Refusal::Malformed)
                }
            };
            match framing::encode_message(&response, &mut self.frame[..]) {
                Ok(bytes) => {
                    let _ = stream.send_slice(bytes);
                }
                Err(_) => stream.abort(),
            }
        }
        let ended = !stream.may_recv();
        if ended {
            // The PC has finished, or the stream is broken.
            stream.close();
        }
        if session.subscriber != subscriber {
            // What waits for the old subscriber must not hold up the new one.
            empty(self.sockets.get_mut(self.to_pc));
        }
        if ended {
            self.end_session(node);
        }
    }

    /// A connection that is never completed must not keep the place.
    fn give_up_half_open(&mut self, now_us: u64) {
        let stream = self.sockets.get_mut::<tcp::Socket>(self.stream);
        if stream.state() != tcp::State::SynReceived {
            self.half_open_since_us = None;
        } else if now_us.saturating_sub(*self.half_open_since_us.get_or_insert(now_us)) > HALF_OPEN_US {
            stream.abort();
        }
    }

    fn end_session(&mut self, node: &mut impl Node) {
        if self.session.take().is_some() {
            self.partner = None;
            node.session_ended();
        }
    }

    fn listen(&mut self) {
        let stream = self.sockets.get_mut::<tcp::Socket>(self.stream);
        // Fails only for port 0 or an open socket.
        let _ = stream.listen(REQUEST_PORT);
    }
}

/// Who sent a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sender {
    Pc,
    Partner,
}

/// Forgets what waits in a socket.
fn empty(socket: &mut udp::Socket) {
    socket.close();
    // Fails only for port 0 or an open socket.
    let _ = socket.bind(DATAGRAM_PORT);
}

fn packets<'a>(metadata: &'a mut [udp::PacketMetadata], payload: &'a mut [u8]) -> udp::PacketBuffer<'a> {
    udp::PacketBuffer::new(metadata, payload)
}

fn udp_socket<'a>(incoming: udp::PacketBuffer<'a>, outgoing: udp::PacketBuffer<'a>) -> udp::Socket<'a> {
    let mut socket = udp::Socket::new(incoming, outgoing);
    empty(&mut socket);
    socket
}

fn instant(us: u64) -> Instant {
    Instant::from_micros_const(us.cast_signed())
}
