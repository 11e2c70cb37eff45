//! The request stream of one board: TCP, requests and their answers, in the same order.

use super::{Endpoint, Patience, waits};
use crate::boards::LinkError;
use shared::protocol::framing::{self, FrameError, MAX_MESSAGE};
use shared::protocol::{Identity, Request, Response, Role, SCHEMA_HASH};
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Pause between two attempts to connect.
const RETRY: Duration = Duration::from_millis(100);

/// The request stream of one board. After an error it is closed.
pub(super) struct Stream {
    role: Role,
    pub(super) socket: TcpStream,
    patience: Duration,
    /// What the board has not answered yet, oldest first.
    owed: VecDeque<Owed>,
    /// The beginning of the next answer, with its length before it.
    buffer: [u8; MAX_MESSAGE + 2],
    filled: usize,
}

/// An answer that is yet to come.
struct Owed {
    deadline: Instant,
    /// Somebody waits for it.
    wanted: bool,
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
            let busy = matches!(
                error.kind(),
                io::ErrorKind::ConnectionRefused
                    | io::ErrorKind::ConnectionReset
                    | io::ErrorKind::ConnectionAborted
                    | io::ErrorKind::BrokenPipe
                    | io::ErrorKind::UnexpectedEof
            );
            let again = busy || error.kind() == io::ErrorKind::TimedOut;
            if !again || left <= RETRY {
                let (address, source) = (endpoint.to_string(), error);
                return Err(match busy {
                    true => LinkError::Busy {
                        role,
                        address,
                        source,
                    },
                    false => LinkError::Unreachable {
                        role,
                        address,
                        source,
                    },
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
            owed: VecDeque::new(),
            buffer: [0; MAX_MESSAGE + 2],
            filled: 0,
        };
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        let identity = match stream.exchange(&hello)? {
            Response::Identity(identity) => identity,
            Response::Refused(refusal) => return Err(LinkError::Refused { role, refusal }),
            _ => {
                return Err(LinkError::Unexpected { role });
            }
        };
        stream.patience = patience.answer;
        Ok((stream, identity))
    }

    /// One request and its answer, with nothing else to do meanwhile.
    pub(super) fn exchange(&mut self, request: &Request) -> Result<Response, LinkError> {
        self.ask(request)?;
        loop {
            if let Some(answer) = self.answer(self.patience)? {
                return Ok(answer);
            }
        }
    }

    /// Sends a request whose answer [`Self::answer`] gives. An answer that is still owed is nobody's any more.
    pub(super) fn ask(&mut self, request: &Request) -> Result<(), LinkError> {
        for owed in &mut self.owed {
            owed.wanted = false;
        }
        self.post(request, true)
    }

    /// Sends a request whose answer nobody waits for. Those asked before keep theirs.
    pub(super) fn tell(&mut self, request: &Request) -> Result<(), LinkError> {
        self.post(request, false)
    }

    /// Whether somebody waits for an answer.
    pub(super) fn owes(&self) -> bool {
        self.owed.iter().any(|owed| owed.wanted)
    }

    /// The answer to what was asked last, if it comes within `wait`.
    pub(super) fn answer(&mut self, wait: Duration) -> Result<Option<Response>, LinkError> {
        let role = self.role;
        match self.next(Instant::now() + wait) {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(source)) => {
                self.close();
                Err(LinkError::Frame { role, source })
            }
            Err(source) => {
                self.close();
                Err(LinkError::Lost { role, source })
            }
        }
    }

    fn post(&mut self, request: &Request, wanted: bool) -> Result<(), LinkError> {
        let role = self.role;
        let mut buffer = [0; MAX_MESSAGE + 2];
        let bytes = framing::encode_message(request, &mut buffer).map_err(|source| {
            self.close();
            LinkError::Frame { role, source }
        })?;
        let write = |socket: &mut TcpStream| {
            socket.set_write_timeout(Some(self.patience))?;
            socket.write_all(bytes)
        };
        if let Err(error) = write(&mut self.socket) {
            self.close();
            let source = self.explain(error);
            return Err(LinkError::Lost { role, source });
        }
        self.owed.push_back(Owed {
            deadline: Instant::now() + self.patience,
            wanted,
        });
        Ok(())
    }

    /// The next answer that somebody waits for, if it comes before `end`.
    fn next(&mut self, end: Instant) -> io::Result<Result<Option<Response>, FrameError>> {
        loop {
            if self.filled >= 2 {
                let length = usize::from(u16::from_le_bytes([self.buffer[0], self.buffer[1]]));
                let Some(body) = self.buffer[2..].get(..length) else {
                    return Ok(Err(FrameError::TooLong));
                };
                if self.filled == length + 2 {
                    let answer = framing::decode_message(body);
                    self.filled = 0;
                    match (self.owed.pop_front(), answer) {
                        (_, Err(error)) => return Ok(Err(error)),
                        (Some(Owed { wanted: true, .. }), Ok(answer)) => return Ok(Ok(Some(answer))),
                        // Of a request that nobody waits for.
                        (_, Ok(_)) => continue,
                    }
                }
            }
            // A program that was paused may find an answer that has waited for it: looked for first, then given up.
            let looked = Instant::now();
            if !self.fill(end.saturating_duration_since(looked))? {
                if self.owed.front().is_some_and(|owed| looked >= owed.deadline) {
                    return Err(self.explain(io::ErrorKind::TimedOut.into()));
                }
                if looked >= end {
                    return Ok(Ok(None));
                }
            }
        }
    }

    /// Takes what has come of the next answer, waiting at most for `wait`; whether anything has.
    fn fill(&mut self, wait: Duration) -> io::Result<bool> {
        let end = match self.filled {
            0 | 1 => 2,
            _ => 2 + usize::from(u16::from_le_bytes([self.buffer[0], self.buffer[1]])),
        };
        self.socket.set_nonblocking(wait.is_zero())?;
        if !wait.is_zero() {
            self.socket.set_read_timeout(Some(wait))?;
        }
        let read = self.socket.read(&mut self.buffer[self.filled..end]);
        if wait.is_zero() {
            // Writing waits.
            self.socket.set_nonblocking(false)?;
        }
        match read {
            Ok(0) => Err(io::Error::new(
                io::ErrorKind::UnexpectedEof,
                "the board closed the connection",
            )),
            Ok(read) => {
                self.filled += read;
                Ok(true)
            }
            Err(error) if waits(&error) => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// No answer of before may be taken for that of a later request.
    fn close(&mut self) {
        // Fails if it is closed already.
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
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
