//! As much of a program on the PC as it takes to switch the drives of both boards on, at moments of the boards' time.

use crate::pair::{Pair, PairError};
use crate::time::Time;
use config::machine::{MachineError, MachineFile};
use shared::protocol::framing::{MAX_MESSAGE, decode_message, encode_message};
use shared::protocol::{Request, Response, SCHEMA_HASH};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use thiserror::Error;

/// The dual-beam gantry's machine file.
const MACHINE: &str = include_str!("../../machines/dual-beam-gantry.toml");
/// Boot and negotiation of the link take 1.6 s, the boards' addresses one second each at most.
pub const LINK_LIMIT: Time = Time::ms(5000);
/// Boards' time within which an answer comes, and within which drives go on after it.
const ANSWER_LIMIT: Time = Time::ms(3000);

/// Why the drives are not on.
#[derive(Debug, Error)]
pub enum SessionError {
    /// A board is not on the net.
    #[error("a board is not on the net after {LINK_LIMIT}")]
    Link,
    /// Its ports are not to be had.
    #[error(transparent)]
    Pair(#[from] PairError),
    /// The connection fails.
    #[error("the connection to a board: {0}")]
    Connection(#[from] io::Error),
    /// The board does not do what it is asked.
    #[error("a board answers {0} to a request")]
    Answer(String),
    /// The enables stay low.
    #[error("the drives are not enabled after {ANSWER_LIMIT}")]
    Drives,
    /// The machine file cannot be used.
    #[error("the machine file: {0}")]
    Machine(#[from] MachineError),
}

/// Requests that give the boards the dual-beam gantry's parameters, in the order of the boards.
pub fn parameters() -> Result<Vec<Request>, SessionError> {
    let machine = MachineFile::parse("dual-beam-gantry.toml", MACHINE)?;
    let tracker = machine.tracking.map(|unit| Request::ConfigureTracker(unit.board));
    let motion = Request::ConfigureMotion(machine.motion);
    Ok([motion].into_iter().chain(tracker).collect())
}

/// Connections to both boards.
pub struct Session([TcpStream; 2]);

impl Session {
    /// Connects to both boards, once they are on the net, and sends them the dual-beam gantry's parameters.
    pub fn open(pair: &mut Pair) -> Result<Self, SessionError> {
        let mut session = Self::connect(pair)?;
        for (board, request) in parameters()?.iter().enumerate() {
            session.done(pair, board, request)?;
        }
        Ok(session)
    }

    /// Connects to both boards, once they are on the net, and greets them.
    pub fn connect(pair: &mut Pair) -> Result<Self, SessionError> {
        if !pair.run_to_link(LINK_LIMIT) {
            return Err(SessionError::Link);
        }
        let connect = |(requests, _)| {
            let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, requests))?;
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            Ok::<_, io::Error>(stream)
        };
        let [motion, tracker] = pair.ports()?;
        let mut session = Self([connect(motion)?, connect(tracker)?]);
        let hello = Request::Hello {
            schema_hash: SCHEMA_HASH,
        };
        for board in 0..2 {
            session.ask(pair, board, &hello)?;
        }
        Ok(session)
    }

    /// Lets both boards begin to home; all their drives are on when it returns.
    pub fn enable(&mut self, pair: &mut Pair) -> Result<(), SessionError> {
        for board in 0..2 {
            self.done(pair, board, &Request::Home)?;
        }
        let end = pair.now() + ANSWER_LIMIT;
        while !pair.boards.iter().all(|board| board.drives_on()) {
            if pair.now() >= end {
                return Err(SessionError::Drives);
            }
            pair.run_slice();
        }
        Ok(())
    }

    /// A request that the board does.
    pub fn done(&mut self, pair: &mut Pair, board: usize, request: &Request) -> Result<(), SessionError> {
        match self.ask(pair, board, request)? {
            Response::Done => Ok(()),
            other => Err(SessionError::Answer(format!("{other:?}"))),
        }
    }

    /// A request and its answer; the boards run meanwhile.
    pub fn ask(
        &mut self,
        pair: &mut Pair,
        board: usize,
        request: &Request,
    ) -> Result<Response, SessionError> {
        let [answer] = self.ask_together(pair, board, [request])?;
        Ok(answer)
    }

    /// Requests that go out at once, and their answers.
    pub fn ask_together<const N: usize>(
        &mut self,
        pair: &mut Pair,
        board: usize,
        requests: [&Request; N],
    ) -> Result<[Response; N], SessionError> {
        let mut buffer = [0; 2 + MAX_MESSAGE];
        let mut all = Vec::new();
        for request in requests {
            all.extend_from_slice(encode_message(request, &mut buffer).map_err(io::Error::other)?);
        }
        self.0[board].write_all(&all)?;
        let end = pair.now() + ANSWER_LIMIT;
        let mut answers = [const { Response::Done }; N];
        for answer in &mut answers {
            self.read(pair, board, &mut buffer[..2], end)?;
            let length = usize::from(u16::from_le_bytes([buffer[0], buffer[1]]));
            let body = buffer
                .get_mut(..length)
                .ok_or(io::ErrorKind::InvalidData)
                .map_err(io::Error::from)?;
            self.read(pair, board, body, end)?;
            *answer = decode_message(body).map_err(io::Error::other)?;
        }
        Ok(answers)
    }

    fn read(&mut self, pair: &mut Pair, board: usize, to: &mut [u8], end: Time) -> io::Result<()> {
        let mut filled = 0;
        while filled < to.len() {
            match self.0[board].read(&mut to[filled..]) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock && pair.now() < end => {
                    pair.run_slice();
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}
