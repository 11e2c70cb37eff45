//! Writes the pictures of a running camera to a folder, on a thread of its own.

use crate::{CameraError, PictureQueue, Recorder};
use std::path::Path;
use std::thread::JoinHandle;

/// Outcome of a [`PictureWriter`].
#[derive(Debug, Default)]
pub struct WrittenPictures {
    /// Number of pictures written.
    pub pictures: u32,
    /// Number of pictures not written: the queue was full, or writing failed.
    pub dropped: u32,
    /// The first error; nothing was written after it.
    pub error: Option<CameraError>,
}

/// A thread that writes the pictures of a queue to a folder.
pub struct PictureWriter {
    queue: PictureQueue,
    thread: Option<JoinHandle<WrittenPictures>>,
}

impl PictureWriter {
    /// Creates `folder` and starts to write the pictures of `queue` to it.
    ///
    /// # Errors
    /// [`CameraError::Record`] if the folder cannot be written, [`CameraError::Holds`] if it has pictures
    /// already.
    pub fn start(folder: &Path, queue: PictureQueue) -> Result<Self, CameraError> {
        let mut recorder = Recorder::new(folder)?;
        let from = queue.clone();
        let thread = std::thread::spawn(move || {
            let mut kept = WrittenPictures::default();
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
            queue,
            thread: Some(thread),
        })
    }

    /// Closes the queue, and returns when all that is in it has been written.
    pub fn end(mut self) -> WrittenPictures {
        let kept = self.join().unwrap_or_default();
        WrittenPictures {
            dropped: kept.dropped + self.queue.dropped(),
            ..kept
        }
    }

    fn join(&mut self) -> Option<WrittenPictures> {
        self.queue.close();
        // A panic of the thread has been printed by it.
        self.thread.take()?.join().ok()
    }
}

impl Drop for PictureWriter {
    fn drop(&mut self) {
        self.join();
    }
}
