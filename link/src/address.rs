//! Addresses on the network.

/// Addresses of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    /// Ethernet address.
    pub mac: [u8; 6],
    /// IPv4 address.
    pub ip: [u8; 4],
    /// Length of the network part in bits, at most 32.
    pub prefix: u8,
    /// IPv4 address of the gateway.
    pub gateway: [u8; 4],
}

/// IPv4 address and UDP port from which a datagram came, or to which it goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// IPv4 address.
    pub address: [u8; 4],
    /// UDP port.
    pub port: u16,
}

/// The other board: where it is, and the number that the datagrams between the two carry, which is that of the tracker
/// board's session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Partner {
    /// Where its datagrams come from, and where those for it go.
    pub source: Source,
    /// Number of the session.
    pub session: u32,
}
