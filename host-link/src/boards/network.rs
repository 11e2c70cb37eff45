//! Boards in a network, real or emulated: requests over TCP, datagrams over UDP.

use super::{Boards, LinkError};
use shared::protocol::framing::{self, FrameError, MAX_MESSAGE};
use shared::protocol::{
    DATAGRAM_PORT, Datagram, Identity, REQUEST_PORT, Request, Response, Role, SCHEMA_HASH,
};
use std::fmt;
use std::io::{self, Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4, TcpStream, ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Datagrams that wait for [`Boards::receive`]; about ten seconds of both boards. More are dropped and counted.
const WAITING: usize = 4096;
/// How often a reader looks whether it is still wanted.
const READER_WAKES: Duration = Duration::from_millis(50);
/// Pause between two attempts to connect.
const RETRY: Duration = Duration::from_millis(100);

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

    /// An emulated board.
    fn emulated(board: emulator::Endpoint) -> Self {
        Self {
            host: board.host.to_string(),
            request_port: board.tcp,
            datagram_port: board.udp,
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

/// How long the PC waits for a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// For a connection: long enough for a board that boots or gives up the last session.
    pub connect: Duration,
    /// For the answer to a request.
    pub answer: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            connect: Duration::from_secs(7),
            answer: Duration::from_secs(3),
        }
    }
}

/// A session with two boards in a network.
pub struct NetworkBoards {
    motion: Connection,
    tracker: Connection,
    path_states_target: ([u8; 4], u16),
    incoming: Receiver<Incoming>,
    bad: Arc<AtomicU32>,
    began: Instant,
    /// Of emulated boards.
    pace: Option<emulator::Pace>,
}

/// What a reader passes on.
type Incoming = (Role, io::Result<Datagram>);

impl NetworkBoards {
    /// Connects to both boards, says Hello, and checks schema and role of each.
    ///
    /// `path_states_target` is where the motion board reaches the tracker board, if that is not where the PC
    /// does (emulated boards).
    ///
    /// # Errors
    /// [`LinkError::Unreachable`], [`LinkError::WrongSchema`], [`LinkError::WrongRole`], or what goes wrong
    /// while Hello is answered.
    pub fn connect(
        motion: &Endpoint,
        tracker: &Endpoint,
        path_states_target: Option<([u8; 4], u16)>,
        patience: Patience,
    ) -> Result<Self, LinkError> {
        let (sender, incoming) = sync_channel(WAITING);
        let bad = Arc::new(AtomicU32::new(0));
        let motion = Connection::open(Role::Motion, motion, patience, &sender, &bad)?;
        let tracker = Connection::open(Role::Tracker, tracker, patience, &sender, &bad)?;
        let seen_from_here = (tracker.board.ip().octets(), tracker.board.port());
        Ok(Self {
            path_states_target: path_states_target.unwrap_or(seen_from_here),
            motion,
            tracker,
            incoming,
            bad,
            began: Instant::now(),
            pace: None,
        })
    }

    /// Connects to emulated boards, and takes part in their pace: they wait while this program has no
    /// processor.
    ///
    /// # Errors
    /// As [`NetworkBoards::connect`], or [`LinkError::BadSession`] if the boards' page cannot be opened.
    pub fn emulated(session: &emulator::Session, patience: Patience) -> Result<Self, LinkError> {
        let target = session.path_states_to;
        let boards = Self::connect(
            &Endpoint::emulated(session.motion),
            &Endpoint::emulated(session.tracker),
            Some((target.host.octets(), target.udp)),
            patience,
        )?;
        let pace = emulator::Pace::join(&session.pace).map_err(|source| emulator::SessionError::File {
            path: session.pace.clone(),
            source,
        })?;
        Ok(Self {
            pace: Some(pace),
            ..boards
        })
    }

    /// Tells emulated boards that everything they sent was handled. Where that fails they do not wait, which
    /// costs accuracy on a busy computer and nothing else.
    fn keep_pace(&self) {
        if let Some(pace) = &self.pace {
            let _ = pace.handled();
        }
    }

    /// Datagrams that were not understood, or that came while too many waited.
    pub fn bad_datagrams(&self) -> u32 {
        self.bad.load(Ordering::Relaxed)
    }

    fn connection(&self, role: Role) -> &Connection {
        match role {
            Role::Motion => &self.motion,
            Role::Tracker => &self.tracker,
        }
    }
}

impl Boards for NetworkBoards {
    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        self.keep_pace();
        match role {
            Role::Motion => self.motion.stream.request(request),
            Role::Tracker => self.tracker.stream.request(request),
        }
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let waiting = self.incoming.try_recv().map_err(|_| self.keep_pace());
        match waiting.or_else(|()| self.incoming.recv_timeout(timeout)) {
            Ok((role, Ok(datagram))) => Ok(Some((role, datagram))),
            Ok((role, Err(source))) => Err(LinkError::Lost { role, source }),
            // Both readers have ended, each after an error that was returned before.
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => Ok(None),
        }
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        let mut buffer = [0; framing::MAX_DATAGRAM];
        let bytes = framing::encode_datagram(datagram, &mut buffer)
            .map_err(|source| LinkError::Frame { role, source })?;
        let connection = self.connection(role);
        connection
            .datagrams
            .send_to(bytes, connection.board)
            .map(drop)
            .map_err(|source| LinkError::Lost { role, source })
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn identity(&self, role: Role) -> &Identity {
        &self.connection(role).identity
    }

    fn path_states_target(&self) -> ([u8; 4], u16) {
        self.path_states_target
    }

    fn datagram_port(&self, role: Role) -> u16 {
        self.connection(role).datagram_port
    }
}

/// One board. Each has a UDP socket of its own: of an emulated board the source port tells nothing.
struct Connection {
    stream: Stream,
    datagrams: UdpSocket,
    datagram_port: u16,
    board: SocketAddrV4,
    identity: Identity,
    reader: Option<JoinHandle<()>>,
    unwanted: Arc<AtomicBool>,
}

impl Connection {
    fn open(
        role: Role,
        endpoint: &Endpoint,
        patience: Patience,
        sender: &SyncSender<Incoming>,
        bad: &Arc<AtomicU32>,
    ) -> Result<Self, LinkError> {
        let unreachable = |source| LinkError::Unreachable {
            role,
            address: endpoint.to_string(),
            source,
        };
        let (stream, identity) = Stream::open(role, endpoint, patience)?;
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
        // On the interface that leads to the board, so that no other network can put in a word.
        let here = stream.socket.local_addr().map_err(unreachable)?.ip();
        let datagrams = UdpSocket::bind((here, 0)).map_err(unreachable)?;
        datagrams
            .set_read_timeout(Some(READER_WAKES))
            .map_err(unreachable)?;
        let datagram_port = datagrams.local_addr().map_err(unreachable)?.port();
        let unwanted = Arc::new(AtomicBool::new(false));
        let reader = Reader {
            role,
            board: *board.ip(),
            datagrams: datagrams.try_clone().map_err(unreachable)?,
            sender: sender.clone(),
            bad: Arc::clone(bad),
            unwanted: Arc::clone(&unwanted),
        };
        Ok(Self {
            stream,
            datagrams,
            datagram_port,
            board,
            identity,
            reader: Some(std::thread::spawn(|| reader.run())),
            unwanted,
        })
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.unwanted.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
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
                Ok((length, from)) => self.decode(&buffer[..length], from).map(Ok),
                Err(error) if waits(&error) || error.kind() == io::ErrorKind::ConnectionReset => None,
                Err(error) => Some(Err(error)),
            };
            let Some(received) = received else { continue };
            let failed = received.is_err();
            match self.sender.try_send((self.role, received)) {
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
            .filter(|_| from.ip() == IpAddr::V4(self.board));
        if datagram.is_none() {
            self.bad.fetch_add(1, Ordering::Relaxed);
        }
        datagram
    }
}

/// The request stream of one board.
struct Stream {
    role: Role,
    socket: TcpStream,
    patience: Duration,
}

impl Stream {
    /// Connects and says Hello. Tries again while the board refuses: it may be booting, or still be busy
    /// with the end of the last session.
    fn open(role: Role, endpoint: &Endpoint, patience: Patience) -> Result<(Self, Identity), LinkError> {
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
            Response::Done | Response::MotionStatus(_) | Response::TrackerStatus(_) => {
                return Err(LinkError::Unexpected { role });
            }
        };
        stream.patience = patience.answer;
        Ok((stream, identity))
    }

    /// One request and its answer. After an error the stream is closed: a late answer must not be taken for
    /// that of the next request.
    fn request(&mut self, request: &Request) -> Result<Response, LinkError> {
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

/// Whether `error` means that a time-out has passed: systems differ in the name.
fn waits(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::protocol::{ClockRequest, Refusal};
    use std::net::TcpListener;

    const BRIEF: Patience = Patience {
        connect: Duration::from_millis(500),
        answer: Duration::from_millis(300),
    };
    const AMPLE: Duration = Duration::from_secs(10);

    /// A board on this machine that takes one session and answers with `answer`; the thread ends with the
    /// session. `None` leaves the request unanswered, empty bytes end the session.
    struct Fake {
        endpoint: Endpoint,
        datagrams: UdpSocket,
        thread: Option<JoinHandle<()>>,
    }

    impl Fake {
        fn new(mut answer: impl FnMut(Request) -> Option<Vec<u8>> + Send + 'static) -> Self {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
            let datagrams = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
            datagrams.set_read_timeout(Some(AMPLE)).unwrap();
            let endpoint = Endpoint {
                host: "127.0.0.1".into(),
                request_port: listener.local_addr().unwrap().port(),
                datagram_port: datagrams.local_addr().unwrap().port(),
            };
            let thread = std::thread::spawn(move || {
                let (mut stream, _) = listener.accept().unwrap();
                stream.set_read_timeout(Some(AMPLE)).unwrap();
                let mut prefix = [0; 2];
                while stream.read_exact(&mut prefix).is_ok() {
                    let mut body = vec![0; usize::from(u16::from_le_bytes(prefix))];
                    stream.read_exact(&mut body).unwrap();
                    let Some(bytes) = answer(framing::decode_message(&body).unwrap()) else {
                        continue;
                    };
                    if bytes.is_empty() {
                        return;
                    }
                    // In two pieces, as a stream may bring it.
                    let (head, tail) = bytes.split_at(1);
                    stream.write_all(head).unwrap();
                    stream.write_all(tail).unwrap();
                }
            });
            Self {
                endpoint,
                datagrams,
                thread: Some(thread),
            }
        }

        /// A board of `role` that answers Hello, and everything else with `answer`.
        fn board(role: Role, mut answer: impl FnMut(Request) -> Option<Vec<u8>> + Send + 'static) -> Self {
            Self::new(move |request| match request {
                Request::Hello { .. } => Some(bytes(&Response::Identity(identity(role)))),
                request => answer(request),
            })
        }

        fn silent(role: Role) -> Self {
            Self::board(role, |_| None)
        }
    }

    impl Drop for Fake {
        fn drop(&mut self) {
            // Wakes a thread that still waits for its session.
            let _ = TcpStream::connect(("127.0.0.1", self.endpoint.request_port));
            if let Some(thread) = self.thread.take() {
                let _ = thread.join();
            }
        }
    }

    fn identity(role: Role) -> Identity {
        Identity {
            schema_hash: SCHEMA_HASH,
            role,
            firmware: "0.1.0".try_into().unwrap(),
            board: "fake".try_into().unwrap(),
            simulated_machine: true,
        }
    }

    fn bytes(response: &Response) -> Vec<u8> {
        let mut buffer = [0; 2050];
        framing::encode_message(response, &mut buffer).unwrap().to_vec()
    }

    fn connect(motion: &Fake, tracker: &Fake) -> Result<NetworkBoards, LinkError> {
        NetworkBoards::connect(&motion.endpoint, &tracker.endpoint, None, BRIEF)
    }

    fn message(result: Result<NetworkBoards, LinkError>) -> String {
        result.err().expect("must not connect").to_string()
    }

    #[test]
    fn requests_go_to_the_board_they_are_meant_for() {
        let answer = |request| {
            let response = match request {
                Request::Home => Response::Done,
                _ => Response::Refused(Refusal::NotHomed),
            };
            Some(bytes(&response))
        };
        let motion = Fake::board(Role::Motion, answer);
        let tracker = Fake::board(Role::Tracker, |_| {
            Some(bytes(&Response::Refused(Refusal::NotMine)))
        });
        let mut boards = connect(&motion, &tracker).unwrap();
        assert_eq!(boards.identity(Role::Tracker), &identity(Role::Tracker));
        for _ in 0..3 {
            assert_eq!(
                boards.request(Role::Motion, &Request::Home).unwrap(),
                Response::Done
            );
            let refused = boards.request(Role::Tracker, &Request::Home).unwrap();
            assert_eq!(refused, Response::Refused(Refusal::NotMine));
        }
        let status = boards.request(Role::Motion, &Request::Status).unwrap();
        assert_eq!(status, Response::Refused(Refusal::NotHomed));
    }

    #[test]
    fn datagrams_come_from_both_boards_in_order_and_bad_ones_are_counted() {
        let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
        let mut boards = connect(&motion, &tracker).unwrap();
        let datagram = |asked_us| Datagram::ClockRequest(ClockRequest { asked_us });
        let send = |board: &Fake, port, bytes: &[u8]| {
            board.datagrams.send_to(bytes, ("127.0.0.1", port)).unwrap();
        };
        let mut buffer = [0; 64];
        let ports = (
            boards.datagram_port(Role::Motion),
            boards.datagram_port(Role::Tracker),
        );
        send(&motion, ports.0, &[1, 2, 3, 4, 5]);
        for k in 0..20 {
            send(
                &motion,
                ports.0,
                framing::encode_datagram(&datagram(k), &mut buffer).unwrap(),
            );
            send(
                &tracker,
                ports.1,
                framing::encode_datagram(&datagram(100 + k), &mut buffer).unwrap(),
            );
        }
        let (mut from_motion, mut from_tracker) = (0, 100);
        for _ in 0..40 {
            let (role, received) = boards.receive(AMPLE).unwrap().unwrap();
            let next = match role {
                Role::Motion => &mut from_motion,
                Role::Tracker => &mut from_tracker,
            };
            assert_eq!(received, datagram(*next));
            *next += 1;
        }
        assert_eq!(boards.receive(Duration::ZERO).unwrap(), None);
        assert_eq!(boards.bad_datagrams(), 1);
    }

    #[test]
    fn datagrams_reach_the_board() {
        let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
        let mut boards = connect(&motion, &tracker).unwrap();
        let datagram = Datagram::ClockRequest(ClockRequest { asked_us: 5 });
        boards.send(Role::Tracker, &datagram).unwrap();
        let mut buffer = [0; 64];
        let (length, from) = tracker.datagrams.recv_from(&mut buffer).unwrap();
        assert_eq!(framing::decode_datagram(&buffer[..length]), Ok(datagram));
        assert_eq!(from.port(), boards.datagram_port(Role::Tracker));
        assert_eq!(
            boards.path_states_target(),
            ([127, 0, 0, 1], tracker.endpoint.datagram_port)
        );
    }

    #[test]
    fn a_board_that_is_not_there_is_named_with_its_address() {
        // A port that was just free, and is not listened on.
        let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let nowhere = Endpoint {
            request_port: port,
            ..Endpoint::board("127.0.0.1")
        };
        let error = message(NetworkBoards::connect(&nowhere, &nowhere, None, BRIEF));
        assert!(
            error.starts_with(&format!("the motion board does not answer at 127.0.0.1:{port}")),
            "{error}"
        );
    }

    #[test]
    fn a_name_that_does_not_exist_is_an_unreachable_board() {
        let nobody = Endpoint::board("no such host");
        let error = message(NetworkBoards::connect(&nobody, &nobody, None, BRIEF));
        assert!(error.contains("does not answer at no such host:7100"), "{error}");
    }

    #[test]
    fn swapped_boards_are_recognised() {
        let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
        let error = message(connect(&tracker, &motion));
        assert!(
            error.contains("a tracker board answers") && error.contains("swapped"),
            "{error}"
        );
    }

    #[test]
    fn another_schema_is_recognised() {
        let old = Identity {
            schema_hash: 0x1234,
            ..identity(Role::Motion)
        };
        let motion = Fake::new(move |_| Some(bytes(&Response::Identity(old.clone()))));
        let tracker = Fake::silent(Role::Tracker);
        let error = message(connect(&motion, &tracker));
        assert!(
            error.contains("another version of the protocol") && error.contains("0000000000001234"),
            "{error}"
        );
    }

    #[test]
    fn a_silent_board_is_given_up_and_its_late_answers_are_never_used() {
        let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
        let mut boards = connect(&motion, &tracker).unwrap();
        let error = boards
            .request(Role::Motion, &Request::Status)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("motion board was lost (no answer within 0.3 s)"),
            "{error}"
        );
        assert!(matches!(
            boards.request(Role::Motion, &Request::Status),
            Err(LinkError::Lost {
                role: Role::Motion,
                ..
            })
        ));
    }

    #[test]
    fn a_board_that_hangs_up_is_lost() {
        let motion = Fake::board(Role::Motion, |_| Some(Vec::new()));
        let tracker = Fake::silent(Role::Tracker);
        let mut boards = connect(&motion, &tracker).unwrap();
        let error = boards.request(Role::Motion, &Request::Home).unwrap_err();
        assert!(
            matches!(
                error,
                LinkError::Lost {
                    role: Role::Motion,
                    ..
                }
            ),
            "{error}"
        );
    }

    #[test]
    fn an_answer_that_is_no_message_is_an_error_not_a_panic() {
        for answer in [vec![2, 0, 0xFF, 0xFF], vec![0xFF, 0xFF, 1]] {
            let motion = Fake::board(Role::Motion, move |_| Some(answer.clone()));
            let tracker = Fake::silent(Role::Tracker);
            let mut boards = connect(&motion, &tracker).unwrap();
            let error = boards.request(Role::Motion, &Request::Home).unwrap_err();
            assert!(
                matches!(
                    error,
                    LinkError::Frame {
                        role: Role::Motion,
                        ..
                    }
                ),
                "{error}"
            );
        }
    }
}
