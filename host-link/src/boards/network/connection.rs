//! The connection to one board: its request stream, its UDP socket and the thread that empties it.

use super::stream::{Stream, read_answers};
use super::{Endpoint, Incoming, Timeouts, waits};
use crate::boards::LinkError;
use shared::protocol::framing;
use shared::protocol::{Datagram, Identity, Request, Response, Role, SCHEMA_HASH};
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often a reader looks whether it is still wanted.
const READER_WAKES: Duration = Duration::from_millis(50);

/// One board. Each has a UDP socket of its own: of an emulated board the source port is arbitrary.
pub(super) struct Connection {
    pub(super) stream: Stream,
    pub(super) datagrams: UdpSocket,
    /// Number of the session, which its datagrams carry.
    pub(super) session: u32,
    pub(super) board: SocketAddrV4,
    pub(super) identity: Identity,
    readers: Vec<JoinHandle<()>>,
    unwanted: Arc<AtomicBool>,
}

impl Connection {
    pub(super) fn open(
        role: Role,
        endpoint: &Endpoint,
        patience: Timeouts,
        sender: &SyncSender<Incoming>,
        bad: &Arc<AtomicU32>,
    ) -> Result<Self, LinkError> {
        let unreachable = |source| LinkError::Unreachable {
            role,
            address: endpoint.to_string(),
            source,
        };
        let (mut stream, mut frames, identity) = Stream::open(role, endpoint, patience)?;
        if identity.schema_hash != SCHEMA_HASH {
            return Err(LinkError::WrongSchema {
                role,
                firmware: identity.firmware.to_string(),
                board: identity.schema_hash,
                here: SCHEMA_HASH,
            });
        }
        if identity.role != role {
            return Err(LinkError::WrongRole {
                role,
                found: identity.role,
                address: endpoint.to_string(),
            });
        }

        let board = SocketAddrV4::new(endpoint.address().map_err(unreachable)?, endpoint.datagram_port);
        // On the interface that leads to the board, so that nothing from another network is received.
        let here = stream.socket.local_addr().map_err(unreachable)?.ip();
        let datagrams = UdpSocket::bind((here, 0)).map_err(unreachable)?;
        datagrams
            .set_read_timeout(Some(READER_WAKES))
            .map_err(unreachable)?;
        let port = datagrams.local_addr().map_err(unreachable)?.port();
        let session = match stream.exchange(&mut frames, &Request::Subscribe { port })? {
            Response::Session { number } => number,
            Response::Refused(refusal) => return Err(LinkError::Refused { role, refusal }),
            _ => return Err(LinkError::Unexpected { role }),
        };
        let unwanted = Arc::new(AtomicBool::new(false));
        let reader = Reader {
            role,
            board: *board.ip(),
            session,
            datagrams: datagrams.try_clone().map_err(unreachable)?,
            sender: sender.clone(),
            bad: Arc::clone(bad),
            unwanted: Arc::clone(&unwanted),
        };
        let answers = sender.clone();
        let readers = vec![
            std::thread::spawn(|| reader.run()),
            std::thread::spawn(move || read_answers(role, frames, &answers)),
        ];
        Ok(Self {
            stream,
            datagrams,
            session,
            board,
            identity,
            readers,
            unwanted,
        })
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.unwanted.store(true, Ordering::Relaxed);
        self.stream.close();
        for reader in self.readers.drain(..) {
            // A reader that panicked has nothing left to clean up.
            let _ = reader.join();
        }
    }
}

/// Thread that empties the UDP socket of a board, so that the system's buffer never overflows while the PC
/// computes.
struct Reader {
    role: Role,
    board: Ipv4Addr,
    session: u32,
    datagrams: UdpSocket,
    sender: SyncSender<Incoming>,
    bad: Arc<AtomicU32>,
    unwanted: Arc<AtomicBool>,
}

impl Reader {
    fn run(self) {
        let mut buffer = [0; 2048];
        while !self.unwanted.load(Ordering::Relaxed) {
            let received = match self.datagrams.recv_from(&mut buffer) {
                Ok((length, from)) => self
                    .decode(&buffer[..length], from)
                    .map(|datagram| Ok(Box::new(datagram))),
                Err(error) if waits(&error) || error.kind() == io::ErrorKind::ConnectionReset => None,
                Err(error) => Some(Err(error)),
            };
            let Some(received) = received else { continue };
            let failed = received.is_err();
            match self.sender.try_send(Incoming::Datagram(self.role, received)) {
                Ok(()) => {}
                Err(TrySendError::Full(_)) => {
                    self.bad.fetch_add(1, Ordering::Relaxed);
                }
                Err(TrySendError::Disconnected(_)) => return,
            }
            if failed {
                return;
            }
        }
    }

    fn decode(&self, bytes: &[u8], from: SocketAddr) -> Option<Datagram> {
        let datagram = framing::decode_datagram(bytes)
            .ok()
            .filter(|(session, _)| *session == self.session && from.ip() == IpAddr::V4(self.board))
            .map(|(_, datagram)| datagram);
        if datagram.is_none() {
            self.bad.fetch_add(1, Ordering::Relaxed);
        }
        datagram
    }
}
