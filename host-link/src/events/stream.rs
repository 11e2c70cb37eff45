//! Queues of events for subscribers: bounded, and never delaying the job.

use super::Event;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Which events a subscriber takes besides those that are never lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interest {
    /// Phases, questions, faults and the end.
    Milestones,
    /// All events but pictures.
    Samples,
    /// All events.
    Pictures,
}

impl Interest {
    fn takes(self, event: &Event) -> bool {
        match event {
            Event::Picture(_) => self == Self::Pictures,
            event => !event.is_sample() || self != Self::Milestones,
        }
    }
}

/// The job's end of its events.
#[derive(Clone, Debug, Default)]
pub struct Events {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    queues: Mutex<Vec<Arc<Queue>>>,
    /// Subscribers with an interest in pictures.
    pictures: AtomicUsize,
}

/// Events for one subscriber.
#[derive(Debug)]
struct Queue {
    interest: Interest,
    capacity: usize,
    state: Mutex<State>,
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct State {
    events: VecDeque<Arc<Event>>,
    /// How many of them are samples.
    samples: usize,
    /// Samples lost since the last event was taken.
    lost: u64,
    /// There will be no more.
    closed: bool,
    /// The subscription has ended.
    abandoned: bool,
}

/// An event, and what was lost before it.
#[derive(Clone, Debug)]
pub struct Received {
    /// Samples that were lost since the event before, as the subscriber was too slow.
    pub lost: u64,
    /// The event.
    pub event: Arc<Event>,
}

/// Why there is no event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoEvent {
    /// None came within the time.
    Timeout,
    /// The job has ended and all its events are taken.
    Ended,
}

impl Events {
    /// Tells all subscribers. Never waits for any of them.
    pub fn publish(&self, event: Event) {
        let mut queues = locked(&self.shared.queues);
        if queues.is_empty() {
            return;
        }
        let event = Arc::new(event);
        queues.retain(|queue| !queue.interest.takes(&event) || queue.push(&event));
    }

    /// Whether anybody wants pictures: they are only worth copying then.
    pub fn want_pictures(&self) -> bool {
        self.shared.pictures.load(Ordering::Relaxed) > 0
    }

    /// A new subscriber, which keeps up to `capacity` samples that it has not taken yet.
    pub fn subscribe(&self, interest: Interest, capacity: usize) -> Subscription {
        let queue = Arc::new(Queue {
            interest,
            capacity: capacity.max(1),
            state: Mutex::default(),
            arrived: Condvar::new(),
        });
        if interest == Interest::Pictures {
            self.shared.pictures.fetch_add(1, Ordering::Relaxed);
        }
        locked(&self.shared.queues).push(Arc::clone(&queue));
        Subscription {
            queue,
            shared: Arc::clone(&self.shared),
        }
    }

    /// Ends all subscriptions after the events sent so far.
    pub fn close(&self) {
        for queue in locked(&self.shared.queues).drain(..) {
            locked(&queue.state).closed = true;
            queue.arrived.notify_all();
        }
    }
}

impl Queue {
    /// Whether any subscription is left.
    fn push(&self, event: &Arc<Event>) -> bool {
        let mut state = locked(&self.state);
        if state.abandoned {
            return false;
        }
        let sample = event.is_sample();
        if sample && state.samples == self.capacity {
            let oldest = state.events.iter().position(|event| event.is_sample());
            if let Some(oldest) = oldest {
                state.events.remove(oldest);
            }
            state.lost += 1;
        } else if sample {
            state.samples += 1;
        }
        state.events.push_back(Arc::clone(event));
        drop(state);
        self.arrived.notify_one();
        true
    }
}

/// A subscriber's end. Drop it to end the subscription.
#[derive(Debug)]
pub struct Subscription {
    queue: Arc<Queue>,
    shared: Arc<Shared>,
}

impl Subscription {
    /// The next event, if one comes within `timeout`.
    ///
    /// # Errors
    /// [`NoEvent`].
    pub fn receive(&self, timeout: Duration) -> Result<Received, NoEvent> {
        let end = Instant::now() + timeout;
        let mut state = locked(&self.queue.state);
        loop {
            if let Some(event) = state.events.pop_front() {
                state.samples -= usize::from(event.is_sample());
                let lost = std::mem::take(&mut state.lost);
                return Ok(Received { lost, event });
            }
            if state.closed {
                return Err(NoEvent::Ended);
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(NoEvent::Timeout);
            }
            let waited = self.queue.arrived.wait_timeout(state, left);
            (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Events until the job has ended.
impl Iterator for Subscription {
    type Item = Received;

    fn next(&mut self) -> Option<Received> {
        loop {
            match self.receive(Duration::from_secs(3600)) {
                Ok(received) => return Some(received),
                Err(NoEvent::Ended) => return None,
                Err(NoEvent::Timeout) => {}
            }
        }
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        let mut state = locked(&self.queue.state);
        state.abandoned = true;
        state.events.clear();
        if self.queue.interest == Interest::Pictures {
            self.shared.pictures.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::events::Phase;

    fn progress(done_mm: f64) -> Event {
        Event::Progress {
            done_mm,
            length_mm: 100.0,
        }
    }

    fn taken(subscription: &Subscription) -> Vec<(u64, String)> {
        std::iter::from_fn(|| subscription.receive(Duration::ZERO).ok())
            .map(|received| {
                let what = match &*received.event {
                    Event::Progress { done_mm, .. } => format!("{done_mm}"),
                    Event::Phase(phase) => phase.to_string(),
                    other => format!("{other:?}"),
                };
                (received.lost, what)
            })
            .collect()
    }

    #[test]
    fn a_slow_subscriber_loses_the_oldest_samples_and_is_told_but_nothing_else() {
        let events = Events::default();
        let (slow, milestones) = (
            events.subscribe(Interest::Samples, 3),
            events.subscribe(Interest::Milestones, 1),
        );
        events.publish(Event::Phase(Phase::Homing));
        for mm in 0..10 {
            events.publish(progress(f64::from(mm)));
            if mm == 7 {
                events.publish(Event::Phase(Phase::Welding));
            }
        }
        let own = |told: [(u64, &str); 5]| told.map(|(lost, what)| (lost, what.to_owned()));
        assert_eq!(
            taken(&slow),
            own([
                (7, "searching reference marks"),
                (0, "7"),
                (0, "welding"),
                (0, "8"),
                (0, "9")
            ])
        );
        assert_eq!(
            taken(&milestones),
            [
                (0, "searching reference marks".to_owned()),
                (0, "welding".to_owned())
            ]
        );
        events.publish(progress(10.0));
        assert_eq!(taken(&slow), [(0, "10".to_owned())]);
    }

    #[test]
    fn subscriptions_end_with_the_job_and_events_do_not_wait_for_who_has_left() {
        let events = Events::default();
        let left = events.subscribe(Interest::Pictures, 10);
        let mut stays = events.subscribe(Interest::Samples, 10);
        assert!(events.want_pictures());
        drop(left);
        assert!(!events.want_pictures());
        events.publish(progress(1.0));
        assert_eq!(locked(&events.shared.queues).len(), 1);
        events.close();
        assert!(stays.next().is_some());
        assert!(stays.next().is_none());
        assert_eq!(stays.receive(Duration::from_secs(9)).unwrap_err(), NoEvent::Ended);
    }

    #[test]
    fn a_subscriber_on_another_thread_gets_what_is_told() {
        let events = Events::default();
        let subscription = events.subscribe(Interest::Samples, 1000);
        let taker = std::thread::spawn(move || subscription.count());
        for mm in 0..100 {
            events.publish(progress(f64::from(mm)));
        }
        events.close();
        assert_eq!(taker.join().unwrap(), 100);
    }
}
