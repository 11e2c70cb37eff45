//! The thread that tells all viewers, waiting for none: one that is behind loses messages, and is told everything anew once it has taken
//! what it had.

use super::VIEWERS;
use super::stage::Stage;
use super::thinning::Thinner;
use crate::viewing::wire::Message;
use host_link::events::Subscription;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::Bytes;

/// Time between two messages: what a screen is drawn in.
const FRAME: Duration = Duration::from_millis(50);
/// Messages that wait for a viewer.
const WAITING: usize = 8;
/// Events that are taken in one turn.
const A_TURN: usize = 8192;

/// All that watch.
#[derive(Clone, Debug, Default)]
pub(super) struct Viewers(Arc<Mutex<Vec<Viewer>>>);

/// One of them, as the publisher sees it.
#[derive(Debug)]
struct Viewer {
    messages: SyncSender<Bytes>,
    waiting: Arc<AtomicUsize>,
    /// Its messages were lost, or it is new.
    is_behind: bool,
}

/// The end of its connection. Drop it to leave.
#[derive(Debug)]
pub(super) struct Seat {
    messages: Receiver<Bytes>,
    waiting: Arc<AtomicUsize>,
    viewers: Viewers,
}

impl Viewers {
    /// A seat, if there is one left.
    pub fn sit(&self) -> Option<Seat> {
        let mut all = self.all();
        if all.len() >= VIEWERS {
            return None;
        }
        let (sender, messages) = sync_channel(WAITING);
        let waiting = Arc::new(AtomicUsize::new(0));
        all.push(Viewer {
            messages: sender,
            waiting: Arc::clone(&waiting),
            is_behind: true,
        });
        Some(Seat {
            messages,
            waiting,
            viewers: self.clone(),
        })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.all().len()
    }

    fn all(&self) -> MutexGuard<'_, Vec<Viewer>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Seat {
    /// The next message, if one comes within `timeout`; an error once there will be none any more.
    pub fn receive(&self, timeout: Duration) -> Result<Option<Bytes>, Closed> {
        use std::sync::mpsc::RecvTimeoutError;
        match self.messages.recv_timeout(timeout) {
            Ok(message) => {
                self.waiting.fetch_sub(1, Ordering::AcqRel);
                Ok(Some(message))
            }
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(Closed),
        }
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let own = &self.waiting;
        self.viewers
            .all()
            .retain(|viewer| !Arc::ptr_eq(&viewer.waiting, own));
    }
}

/// The screen is served no more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closed;

impl Viewer {
    /// Without waiting.
    fn send(&mut self, message: Bytes) {
        self.waiting.fetch_add(1, Ordering::AcqRel);
        if self.messages.try_send(message).is_err() {
            self.waiting.fetch_sub(1, Ordering::AcqRel);
            self.is_behind = true;
        }
    }

    /// It is behind, and has taken what it had.
    fn can_catch_up(&self) -> bool {
        self.is_behind && self.waiting.load(Ordering::Acquire) == 0
    }
}

/// Until `stop`.
pub(super) fn run(stage: &Stage, viewers: &Viewers, stop: &AtomicBool) {
    let began = Instant::now();
    let mut thinner = Thinner::default();
    let mut events = None;
    while !stop.load(Ordering::Relaxed) {
        let due = Instant::now() + FRAME;
        take(&mut thinner, stage, &mut events, began);
        tell(&mut thinner, viewers, began.elapsed());
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    viewers.all().clear();
}

fn take(thinner: &mut Thinner, stage: &Stage, events: &mut Option<Subscription>, began: Instant) {
    let mut taken = stage.take();
    let begun = taken.begun.as_mut();
    let next = begun.map(|begun| begun.events.take());
    thinner.stage(taken);
    if let Some(next) = next {
        *events = next;
    }
    for _ in 0..A_TURN {
        let Some(Ok(received)) = events.as_ref().map(|events| events.receive(Duration::ZERO)) else {
            break;
        };
        thinner.take(&received.event, began.elapsed());
    }
}

fn tell(thinner: &mut Thinner, viewers: &Viewers, now: Duration) {
    if viewers.count() == 0 {
        thinner.tell_nobody();
        return;
    }
    // Encoded while nobody has to wait for a seat; who sits down meanwhile is behind.
    let changes = encoded(&thinner.changes(now));
    let is_new = viewers.all().iter().any(Viewer::can_catch_up);
    let all = if is_new { encoded(&thinner.all(now)) } else { None };
    let Some(changes) = changes else { return };
    thinner.sent(changes.len());
    for viewer in viewers.all().iter_mut() {
        if !viewer.is_behind {
            viewer.send(changes.clone());
        } else if let Some(all) = all.clone().filter(|_| viewer.can_catch_up()) {
            viewer.is_behind = false;
            viewer.send(all);
        }
    }
}

/// What cannot be written is told to nobody: there is no such message.
fn encoded(message: &Message) -> Option<Bytes> {
    message.encode().ok().map(Bytes::from)
}
