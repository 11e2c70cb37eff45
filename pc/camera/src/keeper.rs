//! Keeps the pictures of a running camera in a folder.

use crate::{CameraError, Recorder, Shelf};
use std::path::Path;
use std::thread::JoinHandle;

/// What became of the pictures that were to be kept.
#[derive(Debug, Default)]
pub struct Kept {
    /// Those in the folder.
    pub pictures: u32,
    /// Those that could not be written in time, or at all.
    pub dropped: u32,
    /// Why none was written any more.
    pub error: Option<CameraError>,
}

/// A thread that writes what comes onto a shelf.
pub struct Keeper {
    shelf: Shelf,
    thread: Option<JoinHandle<Kept>>,
}

impl Keeper {
    /// Writes the pictures of `shelf` into `folder`, which is made.
    ///
    /// # Errors
    /// [`CameraError::Record`], also of a folder that holds pictures already.
    pub fn start(folder: &Path, shelf: Shelf) -> Result<Self, CameraError> {
        let mut recorder = Recorder::new(folder)?;
        let from = shelf.clone();
        let thread = std::thread::spawn(move || {
            let mut kept = Kept::default();
            while let Some(pictures) = from.wait() {
                for picture in &pictures {
                    if kept.error.is_none() {
                        kept.error = recorder.add(picture).err();
                    }
                    match kept.error {
                        None => kept.pictures += 1,
                        Some(_) => kept.dropped += 1,
                    }
                }
            }
            kept
        });
        Ok(Self {
            shelf,
            thread: Some(thread),
        })
    }

    /// Ends once all is written that came.
    pub fn end(mut self) -> Kept {
        let kept = self.join().unwrap_or_default();
        Kept {
            dropped: kept.dropped + self.shelf.dropped(),
            ..kept
        }
    }

    fn join(&mut self) -> Option<Kept> {
        self.shelf.close();
        // A panic in it was told there.
        self.thread.take()?.join().ok()
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.join();
    }
}
