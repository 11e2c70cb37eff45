//! The two boards as the PC sees them, whether they are real, emulated or simulated.

mod network;
mod pass_on;

pub use network::{Endpoint, NetworkBoards, Timeouts, Waker};

use shared::protocol::framing::FrameError;
use shared::protocol::{Datagram, Identity, Refusal, Request, Response, Role};
use std::time::Duration;
use thiserror::Error;

/// A session with a motion board and, where the machine has one, a tracker board.
///
/// Its constructor has said Hello to each, compared the schema hashes, and subscribed to what they send. A
/// job that uses nothing but this trait for time and data is deterministic on simulated boards.
pub trait Boards {
    /// Sends `request` and waits for the answer.
    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError>;

    /// Sends `request` and waits for nothing: the answer, if it is there at once, else [`Self::answer`] gives it. The answer to
    /// the answer to an earlier request to this board is dropped. Simulated boards answer at once.
    fn ask(&mut self, role: Role, request: &Request) -> Result<Option<Response>, LinkError> {
        self.request(role, request).map(Some)
    }

    /// The answer to what was asked of this board last, once, if it has come.
    fn answer(&mut self, _role: Role) -> Result<Option<Response>, LinkError> {
        Ok(None)
    }

    /// The next datagram of either board, in the order of arrival; `None` if none came within `timeout`, or
    /// something else is to be looked at before: an answer, or what [`Self::waker`] announced. Simulated
    /// boards advance their time here, by at most `timeout`.
    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError>;

    /// Sends a datagram to a board.
    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError>;

    /// The PC's clock since the session began; virtual time for simulated boards.
    fn now(&self) -> Duration;

    /// Who the board says it is; `None` if it is not in this session.
    fn identity(&self, role: Role) -> Option<&Identity>;

    /// The request that gives the motion board the address of the tracker board ([`Request::PathStatesTo`]);
    /// `None` without one.
    fn path_states_target(&self) -> Option<Request>;

    /// Ends the wait of [`Self::receive`] from another thread; `None` of simulated boards, whose time is not that of threads.
    fn waker(&self) -> Option<Waker> {
        None
    }

    /// Whether their time stands still while this program does something else than to receive, however long that takes.
    fn wait(&self) -> bool {
        false
    }

    /// Datagrams that were not understood, or that came while too many waited; the simulated ones all arrive.
    fn dropped_datagrams(&self) -> u32 {
        0
    }

    /// The last stall of this program, if there was one. Simulated boards have none: their time stands still
    /// meanwhile.
    fn last_stall(&self) -> Option<Stall> {
        None
    }
}

/// A time in which this program did not run: it was stopped, its computer slept, or was busy with something
/// else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stall {
    /// When it ended, by [`Boards::now`].
    pub ended: Duration,
    /// How long it was.
    pub lasted: Duration,
}

/// As [`Boards::request`], for requests that are answered by [`Response::Done`].
pub fn command(boards: &mut (impl Boards + ?Sized), role: Role, request: &Request) -> Result<(), LinkError> {
    match boards.request(role, request)? {
        Response::Done => Ok(()),
        Response::Refused(refusal) => Err(LinkError::Refused { role, refusal }),
        _ => Err(LinkError::Unexpected { role }),
    }
}

/// "motion" or "tracker".
pub fn role_name(role: Role) -> &'static str {
    match role {
        Role::Motion => "motion",
        Role::Tracker => "tracker",
    }
}

/// Why the PC cannot talk with a board.
#[derive(Debug, Error)]
pub enum LinkError {
    /// No connection.
    #[error("the {} board does not answer at {address} ({source}); is it switched on and in this network?", role_name(*.role))]
    Unreachable {
        /// Which board.
        role: Role,
        /// Where it was tried.
        address: String,
        /// What the network said.
        source: std::io::Error,
    },
    /// It is there, and does not take the connection.
    #[error("the {} board at {address} refuses the connection ({source}): another program is connected to it (a lost connection is kept for 5 s), it is booting, or something else has this address", role_name(*.role))]
    Busy {
        /// Which board.
        role: Role,
        /// Where it was tried.
        address: String,
        /// What the network said.
        source: std::io::Error,
    },
    /// The session was made without this board.
    #[error("this session has no {} board, which the machine needs; name the addresses of both boards", role_name(*.role))]
    Absent {
        /// Which board.
        role: Role,
    },
    /// The connection broke, or the board is silent.
    #[error("the connection to the {} board was lost ({source})", role_name(*.role))]
    Lost {
        /// Which board.
        role: Role,
        /// What the network said.
        source: std::io::Error,
    },
    /// Built from another protocol table.
    #[error(
        "the {} board (firmware {firmware}) speaks another version of the protocol than this program ({board:016x}, here {here:016x}); build and flash both from one source",
        role_name(*.role)
    )]
    WrongSchema {
        /// Which board.
        role: Role,
        /// Its firmware version.
        firmware: String,
        /// Its schema hash.
        board: u64,
        /// Schema hash of this program.
        here: u64,
    },
    /// A tracker board answers where the motion board should be, or the other way round.
    #[error("a {} board answers at {address}, where the {} board should be; are the addresses swapped?", role_name(*.found), role_name(*.role))]
    WrongRole {
        /// Which board should be there.
        role: Role,
        /// Which one is.
        found: Role,
        /// Where.
        address: String,
    },
    /// Bytes that are no message.
    #[error("the {} board sent a message that cannot be decoded ({source})", role_name(*.role))]
    Frame {
        /// Which board.
        role: Role,
        /// What is wrong with it.
        source: FrameError,
    },
    /// The board does not do what it was asked.
    #[error("the {} board refused: {refusal}", role_name(*.role))]
    Refused {
        /// Which board.
        role: Role,
        /// Its reason.
        refusal: Refusal,
    },
    /// An answer that does not belong to the request.
    #[error("the {} board sent an answer of the wrong kind for its request", role_name(*.role))]
    Unexpected {
        /// Which board.
        role: Role,
    },
}
