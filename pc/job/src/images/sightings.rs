//! What each picture of a camera shows by itself, noted for who asks for it.

use std::sync::{Arc, Mutex, PoisonError};
use vision::{GapEnd, Measured, Status};

/// What one picture shows, in the frame of its camera, whether it is believed to be the seam or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Number of its capture.
    pub capture: u32,
    /// How it ended.
    pub status: Status,
    /// What may be used.
    pub measured: Option<Measured>,
    /// Where that ends, behind and ahead, if it was asked for.
    pub ends: [Option<GapEnd>; 2],
}

/// Sightings of a camera, the oldest first. Clones share one.
#[derive(Clone, Debug, Default)]
pub struct SightingLog(Arc<Mutex<Vec<Sighting>>>);

/// Those that nobody takes are forgotten beyond this many: minutes of pictures.
const MOST: usize = 1 << 16;

impl SightingLog {
    /// Takes all of them.
    pub fn take(&self) -> Vec<Sighting> {
        // A poisoned lock is harmless: a sighting is noted whole or not at all.
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(super) fn push(&self, sighting: Sighting) {
        let mut noted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if noted.len() < MOST {
            noted.push(sighting);
        }
    }
}
