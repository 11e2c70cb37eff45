//! An operator who works a machine by hand.

use crate::Operator;
use host_link::events::{Event, Question};
use host_link::{ByHand, Command, Jog, Remote};
use shared::protocol::{MotionSample, MotionStatus, TrackerStatus};
use std::collections::VecDeque;

/// So often an operator who holds to a jog asks for it again \[ms\].
const AGAIN_MS: u32 = 50;
/// A jog, homing included, takes no longer \[ms\].
const LONGEST_MS: u32 = 60_000;

/// What an operator does until the machine waits again.
pub enum Deed<'a> {
    /// Asks for this once, now.
    Asks(ByHand),
    /// Asks for a jog as of when it was made.
    AsksLate(Jog),
    /// Holds to a jog for so many ms.
    Holds(Jog, u32, Then<'a>),
}

/// What comes after that.
pub enum Then<'a> {
    /// Nothing any more.
    Silence,
    /// Something else is asked for.
    Asks(ByHand),
    /// This happens, on the thread of the job.
    Happens(Box<dyn FnMut() + 'a>),
}

/// The boards while the machine waits.
#[derive(Clone, Debug)]
pub struct Rest {
    /// The motion board.
    pub motion: MotionStatus,
    /// The tracker board, where there is one.
    pub tracker: Option<TrackerStatus>,
    /// Messages since it waited last.
    pub told: Vec<String>,
    /// What the motion board told since then.
    pub samples: Vec<MotionSample>,
    /// Its newest path tick when the operator asked for the last time.
    pub asked: u32,
}

/// Does one deed after the other, each when the machine waits; then has the drives switched off.
pub struct Hands<'a> {
    deeds: VecDeque<Deed<'a>>,
    /// What is held to, and since which path tick.
    held: Option<(Jog, u32, Then<'a>, u32)>,
    tick: u32,
    asked: u32,
    waits: bool,
    told: Vec<String>,
    samples: Vec<MotionSample>,
    rests: Vec<Rest>,
}

impl<'a> Hands<'a> {
    /// Does these `deeds`.
    pub fn new(deeds: impl IntoIterator<Item = Deed<'a>>) -> Self {
        Self {
            deeds: deeds.into_iter().collect(),
            held: None,
            tick: 0,
            asked: 0,
            waits: false,
            told: Vec::new(),
            samples: Vec::new(),
            rests: Vec::new(),
        }
    }

    /// All places where the machine waited: before the first deed, and after each.
    ///
    /// # Panics
    /// If not all was done.
    pub fn rests(self) -> Vec<Rest> {
        assert!(self.deeds.is_empty(), "{} deeds are left", self.deeds.len());
        self.rests
    }

    fn ask(&mut self, what: ByHand, remote: &Remote) {
        self.asked = self.tick;
        remote.send(Command::ByHand(what)).expect("a job that waits");
    }

    fn next(&mut self, remote: &Remote) {
        match self.deeds.pop_front() {
            None => self.ask(ByHand::Off, remote),
            Some(Deed::Asks(ByHand::Jog(jog))) => self.ask(ByHand::Jog(jog.again()), remote),
            Some(Deed::Asks(what)) => self.ask(what, remote),
            Some(Deed::AsksLate(jog)) => self.ask(ByHand::Jog(jog), remote),
            Some(Deed::Holds(jog, ms, then)) => {
                self.ask(ByHand::Jog(jog.again()), remote);
                self.held = Some((jog, ms, then, self.tick));
            }
        }
    }
}

impl Operator for Hands<'_> {
    fn event(&mut self, event: &Event, remote: &Remote) {
        match event {
            Event::MotionSamples(samples) => {
                self.tick = samples.last().map_or(self.tick, |newest| newest.tick);
                self.samples.extend_from_slice(samples);
            }
            Event::Message(text) => {
                self.told.push(text.clone());
                self.waits = true;
            }
            Event::Question(Question::ByHand) => self.waits = true,
            Event::Phase(_) => self.waits = false,
            // Told after it began to wait.
            Event::Status { motion, tracker } if self.waits => {
                self.rests.push(Rest {
                    motion: (**motion).clone(),
                    tracker: tracker.clone(),
                    told: std::mem::take(&mut self.told),
                    samples: std::mem::take(&mut self.samples),
                    asked: self.asked,
                });
                self.waits = false;
                self.next(remote);
            }
            _ => {}
        }
    }

    fn turn(&mut self, remote: &Remote) {
        assert!(
            self.tick.wrapping_sub(self.asked) < LONGEST_MS,
            "{} deeds are left after a minute: {:?}",
            self.deeds.len(),
            self.told
        );
        let Some((jog, ms, _, since)) = &self.held else {
            return;
        };
        if self.tick.wrapping_sub(*since) < *ms {
            if self.tick.wrapping_sub(self.asked) >= AGAIN_MS {
                self.ask(ByHand::Jog(jog.again()), remote);
            }
            return;
        }
        match self.held.take() {
            Some((.., Then::Asks(what), _)) => self.ask(what, remote),
            Some((.., Then::Happens(mut happens), _)) => happens(),
            Some((.., Then::Silence, _)) | None => {}
        }
    }
}
