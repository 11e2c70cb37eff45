//! The request stream of one board: TCP, requests and their answers, in the same order.
//!
//! Once the session has begun, a thread of its own reads the answers.

use super::frames::Frames;
use super::{Endpoint, Incoming, Timeouts, waits};
use crate::boards::LinkError;
use shared::protocol::framing::{self, FrameError, MAX_MESSAGE};
use shared::protocol::{Identity, Request, Response, Role, SCHEMA_HASH};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::net::TcpStream;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

/// Pause between two attempts to connect.
const RETRY: Duration = Duration::from_millis(100);
/// An answer that is overdue is given up after this much more: a program that was paused finds it a moment later.
const SECOND_LOOK: Duration = Duration::from_millis(100);

/// What a reader found.
pub(super) type Answer = io::Result<Result<Response, FrameError>>;

/// The request stream of one board. After an error it is closed.
pub(super) struct Stream {
    role: Role,
    pub(super) socket: TcpStream,
    patience: Duration,
    /// What the board has not answered yet, oldest first.
    pending: VecDeque<PendingAnswer>,
    /// The answer that a caller waits for, once received, or what ended the stream.
    answered: Option<Result<Response, LinkError>>,
    /// Since when an answer was seen to be overdue.
    overdue: Option<Instant>,
}

/// A request that the board has not answered yet.
struct PendingAnswer {
    deadline: Instant,
    /// A caller waits for it.
    wanted: bool,
}

impl Stream {
    /// Connects and says Hello. Tries again while the board refuses: it may be booting, or still be busy
    /// with the end of the last session.
    pub(super) fn open(
        role: Role,
        endpoint: &Endpoint,
        patience: Timeouts,
    ) -> Result<(Self, Frames, Identity), LinkError> {
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
        patience: Timeouts,
        deadline: Instant,
    ) -> Result<(Self, Frames, Identity), LinkError> {
        let lost = |source| LinkError::Lost { role, source };
        let address = endpoint.address().map_err(lost)?;
        let left = deadline
            .saturating_duration_since(Instant::now())
            .max(Duration::from_millis(1));
        let socket =
            TcpStream::connect_timeout(&(address, endpoint.request_port).into(), left).map_err(lost)?;
        socket.set_nodelay(true).map_err(lost)?;
        let mut frames = Frames::new(socket.try_clone().map_err(lost)?);
        let mut stream = Self {
            role,
            socket,
            patience: patience.answer.min(left),
            pending: VecDeque::new(),
            answered: None,
            overdue: None,
        };
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        let identity = match stream.exchange(&mut frames, &hello)? {
            Response::Identity(identity) => identity,
            Response::Refused(refusal) => return Err(LinkError::Refused { role, refusal }),
            _ => {
                return Err(LinkError::Unexpected { role });
            }
        };
        stream.patience = patience.answer;
        Ok((stream, frames, identity))
    }

    /// One request and its answer, before the answers have a thread of their own.
    pub(super) fn exchange(&mut self, frames: &mut Frames, request: &Request) -> Result<Response, LinkError> {
        self.ask(request)?;
        let end = Instant::now() + self.patience;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            match frames.next(left.max(Duration::from_millis(1))) {
                Ok(Some(answer)) => self.deliver(Ok(answer)),
                Ok(None) if left.is_zero() => self.deliver(Err(io::ErrorKind::TimedOut.into())),
                Ok(None) => {}
                Err(error) => self.deliver(Err(error)),
            }
            if let Some(answer) = self.answer()? {
                return Ok(answer);
            }
        }
    }

    /// Sends a request whose answer [`Self::answer`] gives. The answer to an earlier request is dropped when
    /// it comes.
    pub(super) fn ask(&mut self, request: &Request) -> Result<(), LinkError> {
        for pending in &mut self.pending {
            pending.wanted = false;
        }
        if let Some(Ok(_)) = self.answered {
            self.answered = None;
        }
        self.post(request, true)
    }

    /// Sends a request whose answer is not waited for. Earlier requests are still waited for.
    pub(super) fn tell(&mut self, request: &Request) -> Result<(), LinkError> {
        self.post(request, false)
    }

    /// Takes what the reader has found.
    pub(super) fn deliver(&mut self, answer: Answer) {
        let role = self.role;
        let found = match answer {
            Ok(Ok(response)) => match self.pending.pop_front() {
                Some(PendingAnswer { wanted: true, .. }) => Ok(response),
                // Of a request whose answer is not waited for.
                Some(PendingAnswer { wanted: false, .. }) | None => return,
            },
            Ok(Err(source)) => Err(LinkError::Frame { role, source }),
            Err(error) => {
                let source = self.explain(error);
                Err(LinkError::Lost { role, source })
            }
        };
        if found.is_err() {
            self.close();
        }
        self.overdue = None;
        self.answered = Some(found);
    }

    /// The answer to what was asked last, once, if it has come.
    pub(super) fn answer(&mut self) -> Result<Option<Response>, LinkError> {
        if let Some(answered) = self.answered.take() {
            return answered.map(Some);
        }
        let now = Instant::now();
        if self
            .pending
            .front()
            .is_some_and(|pending| now >= pending.deadline)
        {
            let since = *self.overdue.get_or_insert(now);
            if now.duration_since(since) >= SECOND_LOOK {
                self.close();
                let source = self.explain(io::ErrorKind::TimedOut.into());
                return Err(LinkError::Lost {
                    role: self.role,
                    source,
                });
            }
        } else {
            self.overdue = None;
        }
        Ok(None)
    }

    fn post(&mut self, request: &Request, wanted: bool) -> Result<(), LinkError> {
        let role = self.role;
        if let Some(Err(_)) = self.answered {
            // The stream has ended meanwhile.
            self.answer()?;
        }
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
        self.pending.push_back(PendingAnswer {
            deadline: Instant::now() + self.patience,
            wanted,
        });
        Ok(())
    }

    /// No answer of before may be taken for that of a later request; the reader ends.
    pub(super) fn close(&mut self) {
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

/// Passes all answers of a board on to `sender`, until the stream ends.
pub(super) fn read_answers(role: Role, mut frames: Frames, sender: &SyncSender<Incoming>) {
    loop {
        let answer = match frames.next(Duration::from_secs(3600)) {
            Ok(None) => continue,
            Ok(Some(answer)) => Ok(answer),
            Err(error) => Err(error),
        };
        let ended = !matches!(answer, Ok(Ok(_)));
        // Answers are few, and wait for room.
        if sender.send(Incoming::Answer(role, Box::new(answer))).is_err() || ended {
            return;
        }
    }
}
