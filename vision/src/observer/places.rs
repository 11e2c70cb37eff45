//! Where the seam was in the latest pictures.

use super::running::Running;
use super::seam::{MeanPoint, Moved};
use crate::report::Measured;

/// Points of the seam, seen from where the camera began \[mm\].
#[derive(Clone, Debug)]
pub(super) struct Places {
    travel: Running,
    lateral: Running,
    height: Running,
}

impl Places {
    /// Room for this many.
    pub fn new(room: usize) -> Self {
        Self {
            travel: Running::new(room),
            lateral: Running::new(room),
            height: Running::new(room),
        }
    }

    /// How many there is room for.
    pub fn room(&self) -> usize {
        self.travel.room()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.travel.len()
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.travel.clear();
        self.lateral.clear();
        self.height.clear();
    }

    /// Adds what a camera saw that has moved by `camera` since it began.
    pub fn push(&mut self, measured: &Measured, camera: &Moved) {
        self.travel.push(measured.travel_mm + camera.travel_mm);
        self.lateral.push(measured.lateral_mm + camera.lateral_mm);
        self.height.push(measured.height_mm + camera.height_mm);
    }

    /// Their mean for a camera that has moved by `camera` since it began, if there are at least `fewest`.
    pub fn mean(&self, fewest: usize, camera: &Moved) -> Option<MeanPoint> {
        Some(MeanPoint {
            travel_mm: self.travel.mean(fewest)? - camera.travel_mm,
            lateral_mm: self.lateral.mean(fewest)? - camera.lateral_mm,
            height_mm: self.height.mean(fewest)? - camera.height_mm,
        })
    }

    /// How much they climb along travel, if there are at least `fewest` and the camera travelled.
    pub fn pitch(&self, fewest: usize) -> Option<f64> {
        Running::slope(&self.height, &self.travel, fewest)
    }
}
