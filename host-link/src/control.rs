//! How a job is driven and watched from outside: commands in, events out.

use crate::ByHand;
use crate::events::{Event, Events, Interest, Subscription};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use thiserror::Error;

/// Commands that wait for the job. A job takes one in every turn, many hundred a second.
const WAITING: usize = 256;

/// A command to a job.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Beams off, and a stop on the path.
    Hold,
    /// To continue after a hold, or with the next block; nothing where the machine does not wait.
    Resume,
    /// Back along the path, from a hold.
    Back,
    /// Another feed override, 0…2.
    Override(f64),
    /// Beams off, a stop on the path, and the end of the job.
    Stop,
    /// Whether the machine waits after every block of the program.
    SingleBlock(bool),
    /// What is asked for by hand.
    ByHand(ByHand),
    /// A line for a lesson that is led by lines.
    Answer(String),
    /// There is no operator any more who could answer a question.
    Unattended,
}

/// A command did not reach the job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CommandError {
    /// It has ended.
    #[error("the job has ended")]
    Ended,
    /// Too many wait already.
    #[error("{WAITING} commands are waiting for the job already; send this one again later")]
    Full,
}

/// The end from which a job is driven and watched; there may be any number of clones.
#[derive(Clone, Debug)]
pub struct Remote {
    commands: SyncSender<Command>,
    states: Arc<States>,
    events: Events,
}

/// What commands set at once, however many orders wait.
#[derive(Debug, Default)]
struct States {
    stop: Arc<AtomicBool>,
    single_block: AtomicBool,
    unattended: AtomicBool,
}

/// The job's end.
#[derive(Debug)]
pub struct Control {
    commands: Receiver<Command>,
    /// Commands that have come and are not taken yet, by kind.
    orders: VecDeque<Command>,
    answers: VecDeque<String>,
    by_hand: VecDeque<ByHand>,
    states: Arc<States>,
    events: Events,
}

/// Both ends of the control of one job.
pub fn control() -> (Remote, Control) {
    let (sender, receiver) = sync_channel(WAITING);
    let (states, events) = (Arc::new(States::default()), Events::default());
    let remote = Remote {
        commands: sender,
        states: Arc::clone(&states),
        events: events.clone(),
    };
    let control = Control {
        commands: receiver,
        orders: VecDeque::new(),
        answers: VecDeque::new(),
        by_hand: VecDeque::new(),
        states,
        events,
    };
    (remote, control)
}

impl Remote {
    /// Sends `command` to the job. Commands are taken one after the other; a stop, single block and
    /// [`Command::Unattended`] take effect at once.
    ///
    /// # Errors
    /// [`CommandError`], of orders only.
    pub fn send(&self, command: Command) -> Result<(), CommandError> {
        let States {
            stop,
            single_block,
            unattended,
        } = &*self.states;
        match command {
            Command::Stop => stop.store(true, Ordering::Relaxed),
            Command::SingleBlock(on) => single_block.store(on, Ordering::Relaxed),
            Command::Unattended => unattended.store(true, Ordering::Relaxed),
            order => {
                unattended.store(false, Ordering::Relaxed);
                self.commands.try_send(order).map_err(|error| match error {
                    TrySendError::Full(_) => CommandError::Full,
                    TrySendError::Disconnected(_) => CommandError::Ended,
                })?;
            }
        }
        Ok(())
    }

    /// Set when the job is to stop, for threads that wait on its behalf.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.states.stop)
    }

    /// The events of the job from now on; see [`Events::subscribe`].
    pub fn subscribe(&self, interest: Interest, capacity: usize) -> Subscription {
        self.events.subscribe(interest, capacity)
    }
}

impl Control {
    /// The events of the job.
    pub fn events(&self) -> &Events {
        &self.events
    }

    /// Tells all subscribers.
    pub fn publish(&self, event: Event) {
        self.events.publish(event);
    }

    /// Whether the job is to stop.
    pub fn stopped(&self) -> bool {
        self.states.stop.load(Ordering::Relaxed)
    }

    /// Whether the machine waits after every block of the program.
    pub fn single_block(&self) -> bool {
        self.states.single_block.load(Ordering::Relaxed)
    }

    /// Whether there is no operator any more who could answer.
    pub fn unattended(&self) -> bool {
        self.states.unattended.load(Ordering::Relaxed)
    }

    /// The next order that waits.
    pub fn order(&mut self) -> Option<Command> {
        self.sort();
        self.orders.pop_front()
    }

    /// The next answer that waits, for the part of the job that asked.
    pub fn answer(&mut self) -> Option<String> {
        self.sort();
        self.answers.pop_front()
    }

    /// What waits that was asked for by hand; it stays there until it is [taken](Self::take_by_hand).
    pub fn by_hand(&mut self) -> Option<&ByHand> {
        self.sort();
        self.by_hand.front()
    }

    /// The same, taken.
    pub fn take_by_hand(&mut self) -> Option<ByHand> {
        self.sort();
        self.by_hand.pop_front()
    }

    /// No more are taken than may wait, so that too many commands are an error for their sender.
    fn sort(&mut self) {
        while self.orders.len().max(self.answers.len()).max(self.by_hand.len()) < WAITING {
            match self.commands.try_recv() {
                Ok(Command::Answer(text)) => self.answers.push_back(text),
                Ok(Command::ByHand(asked)) => self.by_hand.push_back(asked),
                Ok(order) => self.orders.push_back(order),
                Err(_) => return,
            }
        }
    }
}

impl Drop for Control {
    fn drop(&mut self) {
        self.events.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_overtakes_all_commands_and_needs_no_room() {
        let (remote, mut control) = control();
        for _ in 0..WAITING {
            remote.send(Command::Hold).unwrap();
        }
        assert_eq!(remote.send(Command::Hold), Err(CommandError::Full));
        assert_eq!(remote.send(Command::Stop), Ok(()));
        assert!(control.stopped());
        assert_eq!(control.order(), Some(Command::Hold));
        drop(control);
        assert_eq!(remote.send(Command::Resume), Err(CommandError::Ended));
    }

    #[test]
    fn answers_wait_for_whoever_asks_and_do_not_hold_up_orders() {
        let (remote, mut control) = control();
        for command in [
            Command::Answer("u 1".into()),
            Command::Hold,
            Command::Answer("done".into()),
        ] {
            remote.send(command).unwrap();
        }
        assert_eq!(control.order(), Some(Command::Hold));
        assert_eq!(control.order(), None);
        assert_eq!(control.answer().as_deref(), Some("u 1"));
        assert_eq!(control.answer().as_deref(), Some("done"));
        assert_eq!(control.answer(), None);
    }

    #[test]
    fn single_block_and_absence_are_states_and_no_orders() {
        let (remote, mut control) = control();
        for command in [Command::SingleBlock(true), Command::Unattended] {
            remote.send(command).unwrap();
        }
        assert_eq!(control.order(), None);
        assert!(control.single_block() && control.unattended());
        // There is an operator again.
        remote.send(Command::Override(0.5)).unwrap();
        assert_eq!(control.order(), Some(Command::Override(0.5)));
        assert!(!control.unattended());
    }
}
