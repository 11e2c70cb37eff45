//! A camera whose pictures somebody else wants too.

use crate::{Arrival, Camera, CameraError, Picture};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Pictures that are kept until the oldest is dropped: more than a second of them.
const ROOM: usize = 256;

/// The newest pictures of a camera, for whoever has a clone of it.
#[derive(Clone, Debug, Default)]
pub struct Shelf(Arc<(Mutex<Shelved>, Condvar)>);

/// What is on a shelf.
#[derive(Debug, Default)]
struct Shelved {
    pictures: VecDeque<Picture>,
    /// The camera waits for room.
    patient: bool,
    dropped: u32,
    closed: bool,
}

impl Shelf {
    /// A shelf that drops no picture: a camera that finds it full waits. Only a camera that is waited for may do so.
    pub fn patient() -> Self {
        let shelf = Self::default();
        shelf.lock().patient = true;
        shelf
    }

    /// Takes all pictures, the oldest first.
    pub fn take(&self) -> Vec<Picture> {
        self.taken(self.lock())
    }

    fn taken(&self, mut shelved: MutexGuard<Shelved>) -> Vec<Picture> {
        let pictures = shelved.pictures.drain(..).collect();
        self.0.1.notify_all();
        pictures
    }

    /// Waits for pictures and takes them, the oldest first; nothing once the shelf is closed and empty.
    pub fn wait(&self) -> Option<Vec<Picture>> {
        let waiting = |shelved: &mut Shelved| shelved.pictures.is_empty() && !shelved.closed;
        let waited = self.0.1.wait_while(self.lock(), waiting);
        let pictures = self.taken(waited.unwrap_or_else(PoisonError::into_inner));
        (!pictures.is_empty()).then_some(pictures)
    }

    /// Nobody waits for more pictures.
    pub fn close(&self) {
        self.lock().closed = true;
        self.0.1.notify_all();
    }

    /// Pictures that nobody took in time.
    pub fn dropped(&self) -> u32 {
        self.lock().dropped
    }

    fn put(&self, picture: &Picture) {
        let full = |shelved: &mut Shelved| shelved.pictures.len() == ROOM;
        let waits = |shelved: &mut Shelved| full(shelved) && shelved.patient && !shelved.closed;
        let waited = self.0.1.wait_while(self.lock(), waits);
        let mut shelved = waited.unwrap_or_else(PoisonError::into_inner);
        if full(&mut shelved) {
            shelved.pictures.pop_front();
            shelved.dropped += 1;
        }
        shelved.pictures.push_back(picture.clone());
        self.0.1.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Shelved> {
        // A picture is put there whole or not at all.
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A camera that puts a copy of each of its pictures on a shelf.
pub struct Keeping {
    camera: Box<dyn Camera>,
    shelf: Shelf,
}

impl Keeping {
    /// Keeps the pictures of `camera` on `shelf`.
    pub fn new(camera: Box<dyn Camera>, shelf: Shelf) -> Self {
        Self { camera, shelf }
    }
}

impl Camera for Keeping {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        self.camera.strobed(capture, time_us);
    }

    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        let arrival = self.camera.next(timeout, picture)?;
        if arrival == Arrival::Picture {
            self.shelf.put(picture);
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
    fn a_full_shelf_drops_the_oldest_and_counts_them() {
        let shelf = Shelf::default();
        let room = ROOM as u32;
        (0..room + 3).for_each(|capture| shelf.put(&picture(capture)));
        let numbers: Vec<u32> = shelf.take().iter().map(|picture| picture.capture).collect();
        assert_eq!(numbers, (3..room + 3).collect::<Vec<_>>());
        assert_eq!(shelf.dropped(), 3);
    }

    #[test]
    fn a_patient_camera_waits_until_there_is_room() {
        let shelf = Shelf::patient();
        let all = 3 * ROOM as u32;
        let taker = shelf.clone();
        let thread = std::thread::spawn(move || {
            let all = std::iter::from_fn(|| taker.wait()).flatten();
            all.map(|picture| picture.capture).collect::<Vec<_>>()
        });
        (0..all).for_each(|capture| shelf.put(&picture(capture)));
        shelf.close();
        assert_eq!(thread.join().expect("it ends"), (0..all).collect::<Vec<_>>());
        assert_eq!(shelf.dropped(), 0);
    }

    #[test]
    fn who_waits_gets_what_is_there_and_hears_of_the_end() {
        let shelf = Shelf::default();
        let waiting = shelf.clone();
        let thread = std::thread::spawn(move || {
            let mut numbers = Vec::new();
            while let Some(pictures) = waiting.wait() {
                numbers.extend(pictures.iter().map(|picture| picture.capture));
            }
            numbers
        });
        (0..5).for_each(|capture| shelf.put(&picture(capture)));
        shelf.close();
        assert_eq!(thread.join().expect("it ends"), [0, 1, 2, 3, 4]);
        assert_eq!(shelf.wait(), None);
    }
}
