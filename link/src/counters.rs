//! Counters of the link.

/// What has happened since boot; all counters wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Connections accepted.
    pub sessions: u32,
    /// Requests answered, the malformed ones too.
    pub requests: u32,
    /// Requests that could not be decoded.
    pub malformed_requests: u32,
    /// Sessions ended because the stream announced an impossible message.
    pub broken_streams: u32,
    /// Sessions given up because nothing was asked for too long.
    pub silent_sessions: u32,
    /// Datagrams received and understood.
    pub datagrams: u32,
    /// Datagrams that were neither of the PC of this session nor of the other board.
    pub strange_datagrams: u32,
    /// Datagrams of another version of the protocol.
    pub foreign_datagrams: u32,
    /// Datagrams that could not be decoded.
    pub malformed_datagrams: u32,
    /// Datagrams for which there was no room.
    pub unsent: u32,
}

/// One more.
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
