//! A bounded queue of pictures, and a camera that queues a copy of each of its pictures.

use crate::{Arrival, Camera, CameraError, Picture};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Capacity of a queue: more than a second of pictures.
const CAPACITY: usize = 256;

/// The newest pictures of a camera. Clones share one queue; when it is full the oldest picture is dropped and
/// counted.
#[derive(Clone, Debug, Default)]
pub struct PictureQueue(Arc<(Mutex<Queued>, Condvar)>);

/// Content of a queue.
#[derive(Debug, Default)]
struct Queued {
    pictures: VecDeque<Picture>,
    /// When full, [`PictureQueue::push`] waits in place of dropping.
    blocking: bool,
    dropped: u32,
    closed: bool,
}

impl PictureQueue {
    /// A queue that drops no picture: when it is full the camera waits. Only for a camera for which the job
    /// waits.
    pub fn blocking() -> Self {
        let queue = Self::default();
        queue.lock().blocking = true;
        queue
    }

    /// Takes all pictures, the oldest first.
    pub fn take(&self) -> Vec<Picture> {
        self.taken(self.lock())
    }

    fn taken(&self, mut queued: MutexGuard<Queued>) -> Vec<Picture> {
        let pictures = queued.pictures.drain(..).collect();
        self.0.1.notify_all();
        pictures
    }

    /// Waits for pictures and takes them, the oldest first; `None` once the queue is closed and empty.
    pub fn wait(&self) -> Option<Vec<Picture>> {
        let waiting = |queued: &mut Queued| queued.pictures.is_empty() && !queued.closed;
        let waited = self.0.1.wait_while(self.lock(), waiting);
        let pictures = self.taken(waited.unwrap_or_else(PoisonError::into_inner));
        (!pictures.is_empty()).then_some(pictures)
    }

    /// Closes the queue: nothing waits for it any more.
    pub fn close(&self) {
        self.lock().closed = true;
        self.0.1.notify_all();
    }

    /// Number of pictures dropped because the queue was full.
    pub fn dropped(&self) -> u32 {
        self.lock().dropped
    }

    fn push(&self, picture: &Picture) {
        let full = |queued: &mut Queued| queued.pictures.len() == CAPACITY;
        let waits = |queued: &mut Queued| full(queued) && queued.blocking && !queued.closed;
        let waited = self.0.1.wait_while(self.lock(), waits);
        let mut queued = waited.unwrap_or_else(PoisonError::into_inner);
        if full(&mut queued) {
            queued.pictures.pop_front();
            queued.dropped += 1;
        }
        queued.pictures.push_back(picture.clone());
        self.0.1.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Queued> {
        // A poisoned lock is harmless: a picture is queued whole or not at all.
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A camera that also puts a copy of each of its pictures in a queue.
pub struct RecordingCamera {
    camera: Box<dyn Camera>,
    queue: PictureQueue,
}

impl RecordingCamera {
    /// Copies the pictures of `camera` to `queue`.
    pub fn new(camera: Box<dyn Camera>, queue: PictureQueue) -> Self {
        Self { camera, queue }
    }
}

impl Camera for RecordingCamera {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        self.camera.strobed(capture, time_us);
    }

    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        let arrival = self.camera.next(timeout, picture)?;
        if arrival == Arrival::Picture {
            self.queue.push(picture);
        }
        Ok(arrival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(capture: u32) -> Picture {
        Picture {
            capture,
            ..Picture::default()
        }
    }

    #[test]
    fn a_full_queue_drops_the_oldest_and_counts_them() {
        let queue = PictureQueue::default();
        let capacity = CAPACITY as u32;
        (0..capacity + 3).for_each(|capture| queue.push(&picture(capture)));
        let numbers: Vec<u32> = queue.take().iter().map(|picture| picture.capture).collect();
        assert_eq!(numbers, (3..capacity + 3).collect::<Vec<_>>());
        assert_eq!(queue.dropped(), 3);
    }

    #[test]
    fn a_blocking_queue_makes_the_camera_wait_until_there_is_room() {
        let queue = PictureQueue::blocking();
        let all = 3 * CAPACITY as u32;
        let taker = queue.clone();
        let thread = std::thread::spawn(move || {
            let all = std::iter::from_fn(|| taker.wait()).flatten();
            all.map(|picture| picture.capture).collect::<Vec<_>>()
        });
        (0..all).for_each(|capture| queue.push(&picture(capture)));
        queue.close();
        assert_eq!(thread.join().expect("it ends"), (0..all).collect::<Vec<_>>());
        assert_eq!(queue.dropped(), 0);
    }

    #[test]
    fn a_waiting_thread_gets_all_pictures_and_then_the_end() {
        let queue = PictureQueue::default();
        let waiting = queue.clone();
        let thread = std::thread::spawn(move || {
            let mut numbers = Vec::new();
            while let Some(pictures) = waiting.wait() {
                numbers.extend(pictures.iter().map(|picture| picture.capture));
            }
            numbers
        });
        (0..5).for_each(|capture| queue.push(&picture(capture)));
        queue.close();
        assert_eq!(thread.join().expect("it ends"), [0, 1, 2, 3, 4]);
        assert_eq!(queue.wait(), None);
    }
}
