//! A spool that a thread of its own fills, so that whoever has the records need not wait for the disk.

use super::{Spool, Spooling};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::mpsc::{SendError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;

/// Batches that may wait for the disk: of samples of a board a minute, 15 MB.
const WAITING: usize = 60;

/// Fills a spool; its thread begins with the first batch.
#[derive(Debug)]
pub struct Writer<T> {
    spooling: Spooling,
    running: Option<Running<T>>,
    /// Records that there was no room for.
    too_slow: u64,
}

#[derive(Debug)]
struct Running<T> {
    queue: SyncSender<Vec<T>>,
    thread: JoinHandle<Spool<T>>,
}

impl<T: Serialize + DeserializeOwned + Clone + Send + 'static> Writer<T> {
    /// One without records.
    pub fn new(spooling: Spooling) -> Self {
        Self {
            spooling,
            running: None,
            too_slow: 0,
        }
    }

    /// Puts a batch at the end. Where the disk is a minute behind, it waits or loses the batch, as [`Spooling::waits`] says.
    pub fn hand_over(&mut self, batch: Vec<T>) {
        let spooling = &self.spooling;
        let running = self
            .running
            .get_or_insert_with(|| Running::start(spooling.clone()));
        let lost = if spooling.waits {
            running.queue.send(batch).err().map(|SendError(batch)| batch)
        } else {
            let sent = running.queue.try_send(batch).err();
            sent.map(|(TrySendError::Full(batch) | TrySendError::Disconnected(batch))| batch)
        };
        self.too_slow += lost.map_or(0, |batch| batch.len() as u64);
    }

    /// All of them, and `rest` behind.
    pub fn finish(self, rest: impl IntoIterator<Item = T>) -> Spool<T> {
        let mut spool = match self.running {
            Some(Running { queue, thread }) => {
                drop(queue);
                thread
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            }
            None => Spool::new(self.spooling),
        };
        rest.into_iter().for_each(|record| spool.push(record));
        if self.too_slow > 0 {
            spool.lose(self.too_slow, "the disk did not keep pace");
        }
        spool
    }
}

impl<T: Serialize + DeserializeOwned + Clone + Send + 'static> Running<T> {
    fn start(spooling: Spooling) -> Self {
        let (queue, batches) = sync_channel::<Vec<T>>(WAITING);
        let write = move || {
            let mut spool = Spool::new(spooling);
            batches
                .into_iter()
                .flatten()
                .for_each(|record| spool.push(record));
            spool
        };
        Self {
            queue,
            thread: std::thread::spawn(write),
        }
    }
}
