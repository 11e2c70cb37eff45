//! Boards in a network, real or emulated: requests over TCP, datagrams over UDP.

mod connection;
mod frames;
mod stall;
mod stream;
#[cfg(test)]
mod tests;

use super::{Boards, LinkError, Stall};
use connection::Connection;
use shared::protocol::framing;
use shared::protocol::{DATAGRAM_PORT, Datagram, Identity, REQUEST_PORT, Request, Response, Role};
use stall::StallDetector;
use std::collections::VecDeque;
use std::fmt;
use std::io;
use std::net::{IpAddr, Ipv4Addr, ToSocketAddrs};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use stream::{Answer, Stream};

/// Datagrams that wait for [`Boards::receive`]; about ten seconds of both boards. More are dropped and counted.
const WAITING: usize = 4096;

/// How often a thread that waits for an answer checks whether the machine is to stop.
const LOOK: Duration = Duration::from_millis(10);

/// How often emulated boards hear that this program keeps up, while it waits.
const PACE: Duration = Duration::from_millis(1);

/// Where a board is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    /// Name or IPv4 address.
    pub host: String,
    /// TCP port of the requests.
    pub request_port: u16,
    /// UDP port of the datagrams.
    pub datagram_port: u16,
}

impl Endpoint {
    /// A board at `host` with the ports every board has.
    pub fn board(host: &str) -> Self {
        Self {
            host: host.to_owned(),
            request_port: REQUEST_PORT,
            datagram_port: DATAGRAM_PORT,
        }
    }

    /// Its first IPv4 address.
    fn address(&self) -> io::Result<Ipv4Addr> {
        (self.host.as_str(), self.request_port)
            .to_socket_addrs()?
            .find_map(|address| match address.ip() {
                IpAddr::V4(address) => Some(address),
                IpAddr::V6(_) => None,
            })
            .ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "the name has no IPv4 address"))
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.host, self.request_port)
    }
}

/// Longest times that the PC waits for a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeouts {
    /// For a connection: long enough for a board that boots or gives up the last session.
    pub connect: Duration,
    /// For the answer to a request.
    pub answer: Duration,
}

impl Default for Timeouts {
    fn default() -> Self {
        Self {
            connect: Duration::from_secs(7),
            answer: Duration::from_secs(3),
        }
    }
}

/// A session with one or two boards in a network.
pub struct NetworkBoards {
    motion: Option<Connection>,
    tracker: Option<Connection>,
    path_states_target: Option<([u8; 4], u16)>,
    incoming: Receiver<Incoming>,
    waker: Waker,
    /// Datagrams that came while an answer was waited for.
    came: VecDeque<(Role, io::Result<Box<Datagram>>)>,
    bad: Arc<AtomicU32>,
    began: Instant,
    /// See [`Self::paced_by`].
    handled: Option<Box<dyn Fn() + Send>>,
    /// Set to stop the machine.
    interrupted: Arc<AtomicBool>,
    /// A stop was sent to the motion board while an answer was waited for.
    stopped: bool,
    stall_detector: StallDetector,
}

/// What the readers pass on.
enum Incoming {
    Datagram(Role, io::Result<Box<Datagram>>),
    Answer(Role, Box<Answer>),
    /// Something else is to be looked at.
    Wake,
}

/// Ends the wait of [`Boards::receive`] from another thread.
#[derive(Clone)]
pub struct Waker(SyncSender<Incoming>);

impl Waker {
    /// Ends it now. Where very much waits to be received, it is ended by that.
    pub fn wake(&self) {
        let _ = self.0.try_send(Incoming::Wake);
    }
}

impl NetworkBoards {
    /// Connects to the motion board and, if the machine has one, to the tracker board, says Hello, and checks
    /// schema and role of each.
    ///
    /// `path_states_target` is where the motion board reaches the tracker board, if that is not where the PC
    /// does (emulated boards).
    ///
    /// # Errors
    /// [`LinkError::Unreachable`], [`LinkError::Busy`], [`LinkError::WrongSchema`], [`LinkError::WrongRole`], or what
    /// goes wrong while Hello is answered.
    pub fn connect(
        motion: &Endpoint,
        tracker: Option<&Endpoint>,
        path_states_target: Option<([u8; 4], u16)>,
        patience: Timeouts,
    ) -> Result<Self, LinkError> {
        let (sender, incoming) = sync_channel(WAITING);
        let bad = Arc::new(AtomicU32::new(0));
        let motion = Connection::open(Role::Motion, motion, patience, &sender, &bad)?;
        let open = |endpoint| Connection::open(Role::Tracker, endpoint, patience, &sender, &bad);
        let tracker = tracker.map(open).transpose()?;
        let seen_from_here = |tracker: &Connection| (tracker.board.ip().octets(), tracker.board.port());
        let target = tracker
            .as_ref()
            .map(|tracker| path_states_target.unwrap_or_else(|| seen_from_here(tracker)));
        Ok(Self {
            path_states_target: target,
            ..Self::of([Some(motion), tracker], sender, incoming, bad)
        })
    }

    /// Connects to one board, whichever it is, as [`Self::connect`] does.
    ///
    /// # Errors
    /// As those of [`Self::connect`], but for the role.
    pub fn connect_one(board: &Endpoint, patience: Timeouts) -> Result<(Self, Role), LinkError> {
        let (sender, incoming) = sync_channel(WAITING);
        let bad = Arc::new(AtomicU32::new(0));
        let open = |role| Connection::open(role, board, patience, &sender, &bad);
        let (connections, role) = match open(Role::Motion) {
            Err(LinkError::WrongRole { found, .. }) => ([None, Some(open(found)?)], found),
            motion => ([Some(motion?), None], Role::Motion),
        };
        Ok((Self::of(connections, sender, incoming, bad), role))
    }

    /// A session with these boards.
    fn of(
        [motion, tracker]: [Option<Connection>; 2],
        sender: SyncSender<Incoming>,
        incoming: Receiver<Incoming>,
        bad: Arc<AtomicU32>,
    ) -> Self {
        Self {
            path_states_target: None,
            motion,
            tracker,
            incoming,
            waker: Waker(sender),
            came: VecDeque::new(),
            bad,
            began: Instant::now(),
            handled: None,
            interrupted: Arc::default(),
            stopped: false,
            stall_detector: StallDetector::new(),
        }
    }

    /// As soon as `interrupted` is set a stop is sent to the motion board, whatever else is being waited for.
    #[must_use]
    pub fn stopped_by(self, interrupted: Arc<AtomicBool>) -> Self {
        Self { interrupted, ..self }
    }

    /// `handled` is called whenever everything that the boards sent has been taken and this program is about to wait or to ask:
    /// this is for emulated boards, which wait while this program has no processor.
    #[must_use]
    pub fn paced_by(self, handled: impl Fn() + Send + 'static) -> Self {
        Self {
            handled: Some(Box::new(handled)),
            ..self
        }
    }

    fn keep_pace(&self) {
        if let Some(handled) = &self.handled {
            handled();
        }
    }

    /// A stop waits for no answer of any board.
    fn stop_if_interrupted(&mut self) {
        if self.interrupted.load(Ordering::Relaxed) && !self.stopped {
            self.stopped = true;
            // Where it fails the next request says why.
            if let Some(motion) = &mut self.motion {
                let _ = motion.stream.tell(&Request::Stop);
            }
        }
    }

    fn stream(&mut self, role: Role) -> Result<&mut Stream, LinkError> {
        let connection = match role {
            Role::Motion => self.motion.as_mut(),
            Role::Tracker => self.tracker.as_mut(),
        };
        let connection = connection.ok_or(LinkError::Absent { role })?;
        Ok(&mut connection.stream)
    }

    fn connection(&self, role: Role) -> Option<&Connection> {
        match role {
            Role::Motion => self.motion.as_ref(),
            Role::Tracker => self.tracker.as_ref(),
        }
    }

    /// What comes next within `timeout`; emulated boards hear meanwhile that this program keeps up with them.
    fn wait(&self, timeout: Duration) -> Option<Incoming> {
        let end = Instant::now() + timeout;
        loop {
            self.keep_pace();
            let left = end.saturating_duration_since(Instant::now());
            let step = if self.handled.is_some() {
                left.min(PACE)
            } else {
                left
            };
            match self.incoming.recv_timeout(step) {
                Ok(incoming) => return Some(incoming),
                Err(_) if step == left => return None,
                Err(_) => {}
            }
        }
    }

    /// Takes what comes next within `timeout`. Answers go to their streams, datagrams to `came`.
    fn take(&mut self, timeout: Duration) {
        let waiting = self.incoming.try_recv();
        let taken = waiting.ok().or_else(|| self.wait(timeout));
        match taken {
            Some(Incoming::Datagram(role, datagram)) => self.came.push_back((role, datagram)),
            Some(Incoming::Answer(role, answer)) => {
                // The session ends with its boards, so that there is a stream for each that sent something.
                if let Ok(stream) = self.stream(role) {
                    stream.deliver(*answer);
                }
            }
            Some(Incoming::Wake) | None => {}
        }
    }
}

impl Boards for NetworkBoards {
    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        let mut answer = self.ask(role, request)?;
        loop {
            if let Some(answer) = answer {
                return Ok(answer);
            }
            self.take(LOOK);
            self.stall_detector.check(self.began.elapsed(), LOOK);
            self.stop_if_interrupted();
            answer = self.stream(role)?.answer()?;
        }
    }

    fn ask(&mut self, role: Role, request: &Request) -> Result<Option<Response>, LinkError> {
        self.stall_detector.check(self.began.elapsed(), Duration::ZERO);
        self.stop_if_interrupted();
        self.stream(role)?.ask(request)?;
        Ok(None)
    }

    fn answer(&mut self, role: Role) -> Result<Option<Response>, LinkError> {
        self.stop_if_interrupted();
        self.stream(role)?.answer()
    }

    fn waker(&self) -> Option<Waker> {
        Some(self.waker.clone())
    }

    fn dropped_datagrams(&self) -> u32 {
        self.bad.load(Ordering::Relaxed)
    }

    fn last_stall(&self) -> Option<Stall> {
        self.stall_detector.last_stall()
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        self.stall_detector.check(self.began.elapsed(), Duration::ZERO);
        self.stop_if_interrupted();
        if self.came.is_empty() {
            self.take(timeout);
            self.stall_detector.check(self.began.elapsed(), timeout);
        }
        match self.came.pop_front() {
            Some((role, Ok(datagram))) => Ok(Some((role, *datagram))),
            Some((role, Err(source))) => Err(LinkError::Lost { role, source }),
            None => Ok(None),
        }
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        let mut buffer = [0; framing::MAX_DATAGRAM];
        let connection = self.connection(role).ok_or(LinkError::Absent { role })?;
        let bytes = framing::encode_datagram(connection.session, datagram, &mut buffer)
            .map_err(|source| LinkError::Frame { role, source })?;
        connection
            .datagrams
            .send_to(bytes, connection.board)
            .map(drop)
            .map_err(|source| LinkError::Lost { role, source })
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn identity(&self, role: Role) -> Option<&Identity> {
        self.connection(role).map(|connection| &connection.identity)
    }

    fn path_states_target(&self) -> Option<Request> {
        let (address, port) = self.path_states_target?;
        Some(Request::PathStatesTo {
            address,
            port,
            session: self.tracker.as_ref()?.session,
        })
    }
}

/// Whether `error` means that a time-out has passed: systems differ in the name.
fn waits(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
