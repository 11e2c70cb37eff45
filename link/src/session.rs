//! What a session allows, and what it answers by itself.

use crate::stack::{Counters, Source};
use shared::protocol::{Datagram, Identity, Refusal, Request, Response, SCHEMA_HASH};

/// What a firmware does with what the link brings.
pub trait Node {
    /// Answers a request. Hello and Subscribe are answered by the link and never come here.
    fn handle(&mut self, request: &Request, counters: &Counters) -> Response;

    /// Takes a datagram that arrived at `arrived_us` of the board's clock. Clock requests are answered by the
    /// link and never come here.
    fn datagram(&mut self, datagram: &Datagram, from: Source, arrived_us: u64);
}

/// One connection of a PC.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Session {
    /// IPv4 address of the PC.
    pub(crate) peer: [u8; 4],
    /// Where the PC wants its datagrams.
    pub(crate) subscriber: Option<Source>,
    greeted: bool,
}

impl Session {
    pub(crate) fn new(peer: [u8; 4]) -> Self {
        Self {
            peer,
            subscriber: None,
            greeted: false,
        }
    }

    /// The answer to `request`.
    pub(crate) fn answer(
        &mut self,
        request: &Request,
        identity: &Identity,
        counters: &Counters,
        node: &mut impl Node,
    ) -> Response {
        match request {
            Request::Hello { schema_hash } => {
                self.greeted = *schema_hash == SCHEMA_HASH;
                Response::Identity(identity.clone())
            }
            _ if !self.greeted => Response::Refused(Refusal::WrongSchema),
            Request::Subscribe { port } => {
                self.subscriber = Some(Source {
                    address: self.peer,
                    port: *port,
                });
                Response::Done
            }
            request => node.handle(request, counters),
        }
    }
}
