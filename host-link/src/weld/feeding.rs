//! Giving a path to the motion board as fast as it takes it: elements and events go by its credits, in constant
//! memory on both sides.

use super::JobError;
use super::session::Session;
use crate::boards::LinkError;
use heapless::Vec;
use shared::protocol::{
    LOAD_ELEMENTS, LOAD_EVENTS, PathElement, PathEvent, Refusal, Request, Response, Role, Room,
};
use shared::trajectory::{Element, Join};
use std::iter::Peekable;
use std::time::Duration;

/// How often the board is asked for room while it has none: shorter than what it holds ever lasts.
const ASK_PERIOD: Duration = Duration::from_millis(10);

/// A path on its way to the motion board.
pub(super) struct Feeding<'a> {
    elements: Peekable<Box<dyn Iterator<Item = Element> + 'a>>,
    events: Peekable<Box<dyn Iterator<Item = PathEvent> + 'a>>,
    /// Elements that go next, and where they end \[mm\].
    batch: Vec<PathElement, LOAD_ELEMENTS>,
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
    /// A path that begins at path length `start_s` \[mm\].
    pub fn new(
        elements: impl Iterator<Item = Element> + 'a,
        events: impl Iterator<Item = PathEvent> + 'a,
        start_s: f64,
    ) -> Self {
        let elements: Box<dyn Iterator<Item = Element> + 'a> = Box::new(elements);
        let events: Box<dyn Iterator<Item = PathEvent> + 'a> = Box::new(events);
        Self {
            elements: elements.peekable(),
            events: events.peekable(),
            batch: Vec::new(),
            end_s: start_s,
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
            Err(LinkError::Refused {
                refusal: Refusal::WrongState { .. } | Refusal::NoPath,
                ..
            }) => {
                self.done = true;
                session.refresh()?;
            }
            sent => sent?,
        }
        self.next_ask = session.boards.now() + ASK_PERIOD;
        Ok(())
    }

    fn send(&mut self, session: &mut Session) -> Result<(), LinkError> {
        let mut room = ask(session)?;
        while !self.done {
            self.fill(session.progress.single_block());
            if self.batch.is_empty() && self.ended.is_some() {
                break;
            }
            // Events go before the elements that carry them.
            let mut events: Vec<PathEvent, LOAD_EVENTS> = Vec::new();
            let most = LOAD_EVENTS.min(usize::from(room.events));
            while self.event_is_due() && events.len() < most {
                events.extend(self.events.next());
            }
            if !events.is_empty() {
                room = load(session, &Request::LoadEvents(events))?;
                continue;
            }
            if self.event_is_due() || self.batch.len() > usize::from(room.elements) {
                break;
            }
            let last = self.elements.peek().is_none();
            let elements = std::mem::take(&mut self.batch);
            room = load(session, &Request::LoadElements { elements, last })?;
            self.done = last;
        }
        Ok(())
    }

    fn fill(&mut self, single_block: bool) {
        while !self.batch.is_full() && self.ended.is_none() {
            let Some(mut element) = self.elements.next() else {
                return;
            };
            self.end_s += element.length;
            if single_block && let Some(next) = self.elements.peek().filter(|next| next.line != element.line)
            {
                element.join = Join::Stop;
                self.ended = Some(EndedBlock {
                    end_s: self.end_s,
                    next_line: next.line,
                });
            }
            // There is room.
            let _ = self.batch.push(PathElement::from(&element));
        }
    }

    /// Whether the next event happens on the elements that go next, or after the last of them.
    fn event_is_due(&mut self) -> bool {
        let ends = self.elements.peek().is_none();
        let end_s = self.end_s;
        self.events
            .peek()
            .is_some_and(|event| ends || event.s_mm <= end_s)
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
