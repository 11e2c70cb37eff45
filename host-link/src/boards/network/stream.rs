//! The request stream of one board: TCP, one request and its answer at a time.

use super::{Endpoint, Patience, waits};
use crate::boards::LinkError;
use shared::protocol::framing::{self, FrameError, MAX_MESSAGE};
use shared::protocol::{Identity, Request, Response, Role, SCHEMA_HASH};
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Pause between two attempts to connect.
const RETRY: Duration = Duration::from_millis(100);

/// The request stream of one board.
pub(super) struct Stream {
    role: Role,
    pub(super) socket: TcpStream,
    patience: Duration,
}

impl Stream {
    /// Connects and says Hello. Tries again while the board refuses: it may be booting, or still be busy
    /// with the end of the last session.
    pub(super) fn open(
        role: Role,
        endpoint: &Endpoint,
        patience: Patience,
    ) -> Result<(Self, Identity), LinkError> {
        let deadline = Instant::now() + patience.connect;
        loop {
            let error = match Self::try_open(role, endpoint, patience, deadline) {
                Err(LinkError::Lost { source, .. } | LinkError::Unreachable { source, .. }) => source,
                decided => return decided,
            };
            let left = deadline.saturating_duration_since(Instant::now());
            let again = matches!(
                error.kind(),
                io::ErrorKind::ConnectionRefused
                    | io::ErrorKind::ConnectionReset
                    | io::ErrorKind::ConnectionAborted
                    | io::ErrorKind::BrokenPipe
                    | io::ErrorKind::UnexpectedEof
                    | io::ErrorKind::TimedOut
            );
            if !again || left <= RETRY {
                return Err(LinkError::Unreachable {
                    role,
                    address: endpoint.to_string(),
                    source: error,
                });
            }
            std::thread::sleep(RETRY);
        }
    }

    fn try_open(
        role: Role,
        endpoint: &Endpoint,
        patience: Patience,
        deadline: Instant,
    ) -> Result<(Self, Identity), LinkError> {
        let lost = |source| LinkError::Lost { role, source };
        let address = endpoint.address().map_err(lost)?;
        let left = deadline
            .saturating_duration_since(Instant::now())
            .max(Duration::from_millis(1));
        let socket =
            TcpStream::connect_timeout(&(address, endpoint.request_port).into(), left).map_err(lost)?;
        socket.set_nodelay(true).map_err(lost)?;
        let mut stream = Self {
            role,
            socket,
            patience: patience.answer.min(left),
        };
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        let identity = match stream.request(&hello)? {
            Response::Identity(identity) => identity,
            Response::Refused(refusal) => return Err(LinkError::Refused { role, refusal }),
            _ => {
                return Err(LinkError::Unexpected { role });
            }
        };
        stream.patience = patience.answer;
        Ok((stream, identity))
    }

    /// One request and its answer. After an error the stream is closed: a late answer must not be taken for
    /// that of the next request.
    pub(super) fn request(&mut self, request: &Request) -> Result<Response, LinkError> {
        let role = self.role;
        let result = self.exchange(request);
        if !matches!(result, Ok(Ok(_))) {
            // Fails if it is closed already.
            let _ = self.socket.shutdown(std::net::Shutdown::Both);
        }
        result
            .map_err(|source| LinkError::Lost { role, source })?
            .map_err(|source| LinkError::Frame { role, source })
    }

    fn exchange(&mut self, request: &Request) -> io::Result<Result<Response, FrameError>> {
        let deadline = Instant::now() + self.patience;
        let mut buffer = [0; MAX_MESSAGE + 2];
        let bytes = match framing::encode_message(request, &mut buffer) {
            Ok(bytes) => bytes,
            Err(error) => return Ok(Err(error)),
        };
        self.socket.set_write_timeout(Some(self.patience))?;
        self.socket
            .write_all(bytes)
            .map_err(|error| self.explain(error))?;

        let mut prefix = [0; 2];
        self.read(&mut prefix, deadline)?;
        let length = usize::from(u16::from_le_bytes(prefix));
        let Some(body) = buffer.get_mut(..length) else {
            return Ok(Err(FrameError::TooLong));
        };
        self.read(body, deadline)?;
        Ok(framing::decode_message(body))
    }

    /// Fills `bytes` before `deadline`.
    fn read(&mut self, mut bytes: &mut [u8], deadline: Instant) -> io::Result<()> {
        while !bytes.is_empty() {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(self.explain(io::ErrorKind::TimedOut.into()));
            }
            self.socket.set_read_timeout(Some(left))?;
            match self.socket.read(bytes) {
                Ok(0) => {
                    return Err(io::Error::new(
                        io::ErrorKind::UnexpectedEof,
                        "the board closed the connection",
                    ));
                }
                Ok(read) => bytes = &mut bytes[read..],
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(self.explain(error)),
            }
        }
        Ok(())
    }

    /// "Resource temporarily unavailable" says nothing to anyone.
    fn explain(&self, error: io::Error) -> io::Error {
        if waits(&error) {
            let waited = format!("no answer within {:.1} s", self.patience.as_secs_f64());
            io::Error::new(io::ErrorKind::TimedOut, waited)
        } else {
            error
        }
    }
}
