//! Memory of a [`Link`](crate::Link).

use shared::protocol::framing::{MAX_DATAGRAM, MAX_MESSAGE};
use smoltcp::iface::SocketStorage;
use smoltcp::socket::udp::PacketMetadata;

/// A message with its length.
pub(crate) const FRAME: usize = MAX_MESSAGE + 2;
/// Longest UDP payload of an Ethernet frame: what is too long for a datagram is still seen and counted.
const LONGEST_PAYLOAD: usize = 1472;
/// Datagrams that wait for the PC.
const OUTGOING: usize = 8;
/// Short datagrams that wait for the other board: path states, permits and clock requests, of at most 256 bytes.
const OUTGOING_SHORT: usize = 8;

/// Buffers of a [`Link`](crate::Link), about 28 kB, best in a static: [`Self::new`] is all zeros in memory, so it takes no room in
/// flash there.
pub struct Buffers {
    pub(crate) requests: [u8; 2 * FRAME],
    pub(crate) responses: [u8; 2 * FRAME],
    pub(crate) incoming: [u8; 2 * LONGEST_PAYLOAD],
    pub(crate) to_pc: [u8; OUTGOING * MAX_DATAGRAM],
    pub(crate) to_partner: [u8; OUTGOING_SHORT * 256],
    pub(crate) nothing: [u8; 1],
    pub(crate) frame: [u8; FRAME],
}

impl Buffers {
    /// Empty ones.
    pub const fn new() -> Self {
        Self {
            requests: [0; 2 * FRAME],
            responses: [0; 2 * FRAME],
            incoming: [0; 2 * LONGEST_PAYLOAD],
            to_pc: [0; OUTGOING * MAX_DATAGRAM],
            to_partner: [0; OUTGOING_SHORT * 256],
            nothing: [0; 1],
            frame: [0; FRAME],
        }
    }
}

impl Default for Buffers {
    fn default() -> Self {
        Self::new()
    }
}

/// Sockets of a [`Link`](crate::Link), and what it keeps of each datagram in its [`Buffers`]; about 1 kB.
pub struct Storage<'a> {
    pub(crate) sockets: [SocketStorage<'a>; 3],
    pub(crate) incoming: [PacketMetadata; 2],
    pub(crate) to_pc: [PacketMetadata; OUTGOING],
    pub(crate) to_partner: [PacketMetadata; OUTGOING_SHORT],
    pub(crate) nothing: [PacketMetadata; 1],
}

impl Storage<'_> {
    /// Without sockets and datagrams.
    pub const fn new() -> Self {
        Self {
            sockets: [SocketStorage::EMPTY; 3],
            incoming: [PacketMetadata::EMPTY; 2],
            to_pc: [PacketMetadata::EMPTY; OUTGOING],
            to_partner: [PacketMetadata::EMPTY; OUTGOING_SHORT],
            nothing: [PacketMetadata::EMPTY; 1],
        }
    }
}

impl Default for Storage<'_> {
    fn default() -> Self {
        Self::new()
    }
}
