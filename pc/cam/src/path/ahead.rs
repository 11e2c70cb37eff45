//! What an iterator gives, some items ahead on a thread of its own: the same items in the same order.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::{mem, panic, vec};

/// Items that are handed over at once, and how many times as many wait at most.
const BATCH: usize = 128;
const WAITING: usize = 4;
/// Items for which there is no thread.
const FEW: usize = 2048;

/// An iterator that goes on on another thread once it has given more than some.
pub struct Ahead<I: Iterator>(State<I>);

enum State<I: Iterator> {
    Here(I, usize),
    There {
        batches: Receiver<Vec<I::Item>>,
        batch: vec::IntoIter<I::Item>,
        thread: Option<JoinHandle<()>>,
    },
    Ended,
}

impl<I> Ahead<I>
where
    I: Iterator + Send + 'static,
    I::Item: Send,
{
    /// The items of `items`.
    pub fn new(items: I) -> Self {
        Self(State::Here(items, 0))
    }
}

impl<I> Iterator for Ahead<I>
where
    I: Iterator + Send + 'static,
    I::Item: Send,
{
    type Item = I::Item;

    fn next(&mut self) -> Option<I::Item> {
        loop {
            match &mut self.0 {
                State::Here(items, given) if *given < FEW => {
                    *given += 1;
                    return items.next();
                }
                State::Here(..) => {
                    if let State::Here(items, _) = mem::replace(&mut self.0, State::Ended) {
                        self.0 = hand_over(items);
                    }
                }
                State::There {
                    batches,
                    batch,
                    thread,
                } => {
                    if let Some(item) = batch.next() {
                        return Some(item);
                    }
                    match (batches.recv(), thread.take()) {
                        (Ok(next), running) => (*batch, *thread) = (next.into_iter(), running),
                        (Err(_), ended) => {
                            self.0 = State::Ended;
                            if let Some(Err(panicked)) = ended.map(JoinHandle::join) {
                                panic::resume_unwind(panicked);
                            }
                        }
                    }
                }
                State::Ended => return None,
            }
        }
    }
}

fn hand_over<I>(items: I) -> State<I>
where
    I: Iterator + Send + 'static,
    I::Item: Send,
{
    let (sender, batches) = sync_channel(WAITING);
    State::There {
        batches,
        batch: Vec::new().into_iter(),
        thread: Some(thread::spawn(move || send(items, &sender))),
    }
}

/// Gives all of `items`, until nobody wants more.
fn send<T>(mut items: impl Iterator<Item = T>, sender: &SyncSender<Vec<T>>) {
    loop {
        let batch: Vec<T> = items.by_ref().take(BATCH).collect();
        if batch.is_empty() || sender.send(batch).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_items_come_in_their_order() {
        for count in [0, 1, FEW, FEW + 1, FEW + BATCH, 10 * FEW + 3] {
            assert!(Ahead::new(0..count).eq(0..count), "{count}");
        }
    }

    #[test]
    fn it_ends_where_nobody_wants_more() {
        let (sender, alive) = sync_channel::<()>(0);
        let endless = (0_u64..).inspect(move |_| {
            let _ = &sender;
        });
        assert_eq!(Ahead::new(endless).nth(3 * FEW), Some(3 * FEW as u64));
        // The thread has ended once what it holds is gone.
        assert!(alive.recv().is_err());
    }

    #[test]
    #[should_panic(expected = "on the way")]
    fn a_panic_is_handed_on() {
        let items = (0..10 * FEW).inspect(|item| assert!(*item < 3 * FEW, "on the way"));
        Ahead::new(items).for_each(drop);
    }
}
