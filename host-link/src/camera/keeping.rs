//! A camera whose pictures somebody else wants to see too.

use super::{Arrival, Camera, CameraError, Picture};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Pictures that are kept until the oldest is dropped.
const ROOM: usize = 64;

/// The newest pictures of a camera, for whoever has a clone of it.
#[derive(Clone, Debug, Default)]
pub struct Shelf(Arc<Mutex<VecDeque<Picture>>>);

impl Shelf {
    /// Takes all pictures, the oldest first.
    pub fn take(&self) -> Vec<Picture> {
        // A picture is put there whole or not at all.
        let mut pictures = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pictures.drain(..).collect()
    }

    fn put(&self, picture: &Picture) {
        let mut pictures = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if pictures.len() == ROOM {
            pictures.pop_front();
        }
        pictures.push_back(picture.clone());
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
