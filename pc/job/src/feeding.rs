//! Giving a path to the motion board as fast as it takes it: elements and events go by its credits, in constant
//! memory on both sides.

use crate::JobError;
use crate::session::Session;
use cam::path::{Leg, PathError, PlannedPath};
use heapless::Vec;
use host_link::boards::LinkError;
use shared::protocol::{
    LOAD_ELEMENTS, LOAD_EVENTS, PathElement, PathEvent, Refusal, Request, Response, Role, Room,
};
use shared::trajectory::Join;
use std::collections::VecDeque;
use std::iter::Peekable;
use std::time::Duration;

/// How often the board is asked for room while it has none: shorter than what it holds ever lasts.
const ASK_PERIOD: Duration = Duration::from_millis(10);

/// A path on its way to the motion board.
pub(super) struct Feeding<'a> {
    legs: Peekable<Box<dyn Iterator<Item = Result<Leg, PathError>> + 'a>>,
    /// Elements that go next.
    batch: Vec<PathElement, LOAD_ELEMENTS>,
    /// Events on them that have not gone yet; they go first.
    events: VecDeque<PathEvent>,
    /// Where the batch ends \[mm\].
    end_s: f64,
    next_ask: Duration,
    done: bool,
    /// Single block: nothing goes beyond the block that ends with the batch, or ended with the one before.
    ended: Option<EndedBlock>,
}

/// A block of the program after which the machine rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EndedBlock {
    /// Path length where it ends \[mm\].
    pub end_s: f64,
    /// Line of the next one.
    pub next_line: u32,
}

impl<'a> Feeding<'a> {
    /// What the board is given of `path`; every block as it is written if the machine may rest after each.
    pub fn new(path: &'a PlannedPath, single_block: bool) -> Self {
        let legs = if single_block {
            path.given_blocks()
        } else {
            path.given_legs()
        };
        Self {
            legs: legs.peekable(),
            batch: Vec::new(),
            events: VecDeque::new(),
            end_s: path.start_s,
            next_ask: Duration::ZERO,
            done: false,
            ended: None,
        }
    }

    /// The block after which nothing goes to the board before [`Self::next_block`].
    pub fn ended_block(&self) -> Option<EndedBlock> {
        self.ended.filter(|_| self.batch.is_empty())
    }

    /// Begins the next block, or all the rest if the operator wants no single block any more.
    pub fn next_block(&mut self, session: &mut Session) -> Result<(), JobError> {
        self.ended = None;
        self.next_ask = Duration::ZERO;
        self.go_on(session)
    }

    /// Sends all that there is room for; to be called often while the path runs.
    ///
    /// A board that has left the path takes no more: what it stopped for is in its state.
    pub fn go_on(&mut self, session: &mut Session) -> Result<(), JobError> {
        let now = session.boards.now();
        if self.done || now < self.next_ask {
            return Ok(());
        }
        match self.send(session) {
            Err(JobError::Link(LinkError::Refused {
                refusal: Refusal::WrongState { .. } | Refusal::NoPath,
                ..
            })) => {
                self.done = true;
                session.refresh()?;
            }
            sent => sent?,
        }
        self.next_ask = session.boards.now() + ASK_PERIOD;
        Ok(())
    }

    fn send(&mut self, session: &mut Session) -> Result<(), JobError> {
        let mut room = ask(session)?;
        while !self.done {
            self.fill(session.control.single_block())?;
            if self.batch.is_empty() && self.ended.is_some() {
                break;
            }
            if !self.events.is_empty() {
                let count = self.events.len().min(LOAD_EVENTS).min(usize::from(room.events));
                if count == 0 {
                    break;
                }
                let events = self.events.drain(..count).collect();
                room = load(session, &Request::LoadEvents(events))?;
                continue;
            }
            if self.batch.len() > usize::from(room.elements) {
                break;
            }
            let last = self.legs.peek().is_none();
            let elements = std::mem::take(&mut self.batch);
            room = load(session, &Request::LoadElements { elements, last })?;
            self.done = last;
        }
        Ok(())
    }

    /// Takes elements until the batch is full, has more events than go at once, or ends with a single block.
    fn fill(&mut self, single_block: bool) -> Result<(), PathError> {
        while !self.batch.is_full() && self.events.len() < LOAD_EVENTS && self.ended.is_none() {
            let Some(leg) = self.legs.next() else { break };
            let Leg { events, mut element } = leg?;
            self.events.extend(events);
            self.end_s += element.length;
            if single_block
                && let Some(Ok(next)) = self.legs.peek()
                && next.element.line != element.line
            {
                element.join = Join::Stop;
                self.ended = Some(EndedBlock {
                    end_s: self.end_s,
                    next_line: next.element.line,
                });
            }
            // There is room.
            let _ = self.batch.push(PathElement::from(&element));
            // What happens just at its end is sent with it: the board may be there before the next one comes.
            if let Some(Ok(next)) = self.legs.peek_mut() {
                let at_end = next.events.partition_point(|event| event.s_mm <= self.end_s);
                self.events.extend(next.events.drain(..at_end));
            }
        }
        Ok(())
    }
}

/// What there is room for: no elements need none.
fn ask(session: &mut Session) -> Result<Room, LinkError> {
    let nothing = Request::LoadElements {
        elements: Vec::new(),
        last: false,
    };
    load(session, &nothing)
}

fn load(session: &mut Session, request: &Request) -> Result<Room, LinkError> {
    let role = Role::Motion;
    match session.boards.request(role, request)? {
        Response::Room(room) => Ok(room),
        Response::Refused(refusal) => Err(LinkError::Refused { role, refusal }),
        _ => Err(LinkError::Unexpected { role }),
    }
}
