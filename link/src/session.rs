//! The session of the PC: permitted requests, its own answers, its lease.

use crate::address::Source;
use crate::counters::Counters;
use shared::protocol::{Datagram, Identity, Refusal, Request, Response, SCHEMA_HASH};

/// A connection that has not said Hello after so long is given up \[µs\].
const GREETING_US: u64 = 500_000;
/// The lease: a session without a request for so long is given up, whatever its TCP says \[µs\].
pub(crate) const LEASE_US: u64 = 5_000_000;

/// What a firmware does with what the link brings.
pub trait Node {
    /// Answers a request. Hello and Subscribe are answered by the link and never come here.
    fn handle(&mut self, request: &Request, counters: &Counters) -> Response;

    /// Takes a datagram of the PC of this session or of the other board that arrived at `arrived_us` of the board's
    /// clock. Clock requests are answered by the link and never come here.
    fn datagram(&mut self, datagram: &Datagram, from: Source, arrived_us: u64);

    /// The session has ended: it was closed, it broke, or its lease ran out. What it began has no owner any more.
    fn session_ended(&mut self);
}

/// One connection of a PC.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Session {
    /// IPv4 address of the PC.
    pub(crate) peer: [u8; 4],
    /// What all its datagrams carry.
    pub(crate) number: u32,
    /// Where the PC wants its datagrams, and where its own come from.
    pub(crate) subscriber: Option<Source>,
    greeted: bool,
    /// When it began, or asked for something last \[µs\].
    heard_us: u64,
}

impl Session {
    pub(crate) fn new(peer: [u8; 4], number: u32, now_us: u64) -> Self {
        Self {
            peer,
            number,
            subscriber: None,
            greeted: false,
            heard_us: now_us,
        }
    }

    /// Nothing was asked for too long.
    pub(crate) fn is_over(&self, now_us: u64) -> bool {
        let most = if self.greeted { LEASE_US } else { GREETING_US };
        now_us.saturating_sub(self.heard_us) > most
    }

    /// The answer to `request`, which renews the lease if Hello was said.
    pub(crate) fn answer(
        &mut self,
        request: &Request,
        identity: &Identity,
        counters: &Counters,
        now_us: u64,
        node: &mut impl Node,
    ) -> Response {
        if let Request::Hello { schema_hash } = request {
            self.greeted = *schema_hash == SCHEMA_HASH;
            return Response::Identity(identity.clone());
        }
        if !self.greeted {
            return Response::Refused(Refusal::WrongSchema);
        }
        self.heard_us = now_us;
        match request {
            Request::Subscribe { port } => {
                self.subscriber = Some(Source {
                    address: self.peer,
                    port: *port,
                });
                Response::Session { number: self.number }
            }
            request => node.handle(request, counters),
        }
    }
}

/// The number of the `count`-th session of the board with this Ethernet address, begun at `now_us`: another one than
/// those of the sessions before it, of the other board, and of the boots before this one. It keeps apart what belongs
/// to different sessions; it is no secret to a listener on the network.
pub(crate) fn number(mac: [u8; 6], count: u32, now_us: u64) -> u32 {
    let [a, b, c, d, e, f] = mac;
    let mut mixed = u64::from_le_bytes([a, b, c, d, e, f, 0, 0]) ^ now_us.rotate_left(24) ^ u64::from(count);
    // Finaliser of SplitMix64 (Steele et al. 2014).
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^= mixed >> 31;
    (mixed as u32).max(1)
}
