//! This computer as the PC of the boards' net: ports of the loopback interface lead to the boards' ports, as QEMU's
//! user-mode network does.

use super::device::Queues;
use super::relay::{Datagrams, Streams};
use crate::time::Time;
use shared::protocol::{DATAGRAM_PORT, REQUEST_PORT};
use smoltcp::iface::{Config, Interface, SocketSet};
use smoltcp::time::Instant;
use smoltcp::wire::{
    EthernetAddress, EthernetFrame, EthernetProtocol, HardwareAddress, IpAddress, IpCidr, IpEndpoint,
};
use smoltcp::wire::{IpProtocol, Ipv4Address, Ipv4Packet, UdpPacket};
use std::io;
use std::net::Ipv4Addr;

/// The PC in the boards' net (docs/wiring.md).
const PC: Ipv4Address = Ipv4Address::new(192, 168, 71, 1);
const PREFIX: u8 = 24;
const MAC: EthernetAddress = EthernetAddress([0x02, 0, 0, 0, 0, 1]);
/// Ports that this end gets in the boards' net: below those that a computer gives to its programs, to which the boards
/// send by themselves.
const OWN_PORTS: std::ops::Range<u16> = 1024..32_768;

/// Ports of the loopback interface that lead to a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port {
    /// Requests, TCP.
    pub requests: u16,
    /// Datagrams, UDP.
    pub datagrams: u16,
}

/// The PC's end of the net.
pub struct Gateway {
    queues: Queues,
    interface: Interface,
    sockets: SocketSet<'static>,
    streams: Vec<Streams>,
    datagrams: Vec<Datagrams>,
    next_port: u16,
}

impl Gateway {
    /// Takes unused ports of the loopback interface for the boards with these addresses; or, at an address of that interface for
    /// each board, the ports that every board has.
    pub fn open(boards: &[Ipv4Addr], at: Option<&[Ipv4Addr]>) -> io::Result<Self> {
        let host = |index: usize, port| match at.and_then(|at| at.get(index)) {
            Some(address) => (*address, port),
            None => (Ipv4Addr::LOCALHOST, 0),
        };
        let mut queues = Queues::default();
        let config = Config::new(HardwareAddress::Ethernet(MAC));
        let mut interface = Interface::new(config, &mut queues, Instant::ZERO);
        interface.update_ip_addrs(|addresses| {
            // There is room for one.
            let _ = addresses.push(IpCidr::new(IpAddress::Ipv4(PC), PREFIX));
        });
        let end = |address: &Ipv4Addr, port| IpEndpoint::new(IpAddress::Ipv4(*address), port);
        let streams = boards
            .iter()
            .enumerate()
            .map(|(index, board)| Streams::listen(end(board, REQUEST_PORT), host(index, REQUEST_PORT)));
        let mut sockets = SocketSet::new(Vec::new());
        let datagrams = boards.iter().enumerate().map(|(index, board)| {
            let host = host(index, DATAGRAM_PORT);
            Datagrams::bind(end(board, DATAGRAM_PORT), host, &mut sockets)
        });
        Ok(Self {
            queues,
            interface,
            streams: streams.collect::<io::Result<_>>()?,
            datagrams: datagrams.collect::<io::Result<_>>()?,
            sockets,
            next_port: OWN_PORTS.start,
        })
    }

    /// Whether all boards are on the net and have told their Ethernet addresses.
    pub fn reaches_all(&self) -> bool {
        self.datagrams
            .iter()
            .all(|datagrams| datagrams.reached(&self.sockets))
    }

    /// Where the boards are reached, in the order in which they were given.
    pub fn ports(&self) -> io::Result<Vec<Port>> {
        let both = self.streams.iter().zip(&self.datagrams);
        both.map(|(streams, datagrams)| {
            Ok(Port {
                requests: streams.port()?,
                datagrams: datagrams.port()?,
            })
        })
        .collect()
    }

    /// Takes a frame of a board from the switch. What it sends to a program's own port goes there directly.
    pub(super) fn take(&mut self, board: usize, frame: Vec<u8>) {
        match (to_program(&frame), self.datagrams.get(board)) {
            (Some((port, bytes)), Some(datagrams)) => datagrams.pass_to(port, bytes),
            _ => self.queues.incoming.push_back(frame),
        }
    }

    /// Passes on what has come on either side, and gives the frames that go to the switch.
    pub(super) fn exchange(&mut self, now: Time) -> Vec<Vec<u8>> {
        let instant = Instant::from_micros((now.as_ns() / 1000) as i64);
        self.interface.poll(instant, &mut self.queues, &mut self.sockets);
        for streams in &mut self.streams {
            streams.relay(&mut self.interface, &mut self.sockets, &mut self.next_port);
        }
        for datagrams in &mut self.datagrams {
            datagrams.relay(&mut self.sockets);
        }
        self.interface.poll(instant, &mut self.queues, &mut self.sockets);
        if !OWN_PORTS.contains(&self.next_port) {
            self.next_port = OWN_PORTS.start;
        }
        self.queues.outgoing.drain(..).collect()
    }
}

/// Port and contents of a datagram to the PC that is not for a port of this end.
fn to_program(frame: &[u8]) -> Option<(u16, &[u8])> {
    let frame = EthernetFrame::new_checked(frame).ok()?;
    if frame.ethertype() != EthernetProtocol::Ipv4 {
        return None;
    }
    let packet = Ipv4Packet::new_checked(frame.payload()).ok()?;
    if packet.dst_addr() != PC || packet.next_header() != IpProtocol::Udp {
        return None;
    }
    let datagram = UdpPacket::new_checked(packet.payload()).ok()?;
    let port = datagram.dst_port();
    (!OWN_PORTS.contains(&port)).then(|| (port, datagram.payload()))
}
