//! Settings of seam teaching.

use config::{RangeError, in_range};
use serde::Deserialize;

/// How to teach seams. Every key has a value that suits a thin rib.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SeamTeaching {
    /// Largest and smallest distance of two points \[mm\].
    pub largest_step_mm: f64,
    /// See `largest_step_mm`.
    pub smallest_step_mm: f64,
    /// Largest distance of the seam from the chord between two points \[mm\].
    pub chord_mm: f64,
    /// Largest turn of the seam between two points \[deg\].
    pub turn_deg: f64,
    /// Pictures of each camera for a point.
    pub pictures: usize,
    /// Seams this near to the middle of their bands are centred \[mm\].
    pub centred_mm: f64,
    /// What is seen less surely counts as not seen, 0…1.
    pub least_quality: f64,
    /// How far around its place a seam is searched \[mm\].
    pub search_mm: f64,
    /// Distance of two looks of a search across the seam and in height \[mm\]: a little less than a camera sees.
    pub search_step_mm: [f64; 2],
    /// The machine comes to rest for so long before a look \[s\].
    pub settle_s: f64,
    /// Speed from point to point \[m/min\].
    pub speed_m_min: f64,
}

impl Default for SeamTeaching {
    fn default() -> Self {
        Self {
            largest_step_mm: 20.0,
            smallest_step_mm: 1.0,
            chord_mm: 0.03,
            turn_deg: 2.0,
            pictures: 8,
            centred_mm: 0.05,
            least_quality: 0.5,
            search_mm: 4.0,
            search_step_mm: [0.8, 0.35],
            settle_s: 0.2,
            speed_m_min: 3.0,
        }
    }
}

impl SeamTeaching {
    /// Checks the settings; errors name the key.
    pub fn check(&self) -> Result<(), RangeError> {
        let above_zero = [
            ("smallest_step_mm", self.smallest_step_mm),
            ("chord_mm", self.chord_mm),
            ("turn_deg", self.turn_deg),
            ("centred_mm", self.centred_mm),
            ("search_mm", self.search_mm),
            ("search_step_mm", self.search_step_mm[0]),
            ("search_step_mm", self.search_step_mm[1]),
            ("speed_m_min", self.speed_m_min),
        ];
        for (key, value) in above_zero {
            in_range(key, value, value > 0.0, "above 0")?;
        }
        in_range("settle_s", self.settle_s, self.settle_s >= 0.0, "0 or more")?;
        let largest = self.largest_step_mm;
        in_range(
            "largest_step_mm",
            largest,
            largest >= self.smallest_step_mm,
            "smallest_step_mm or more",
        )?;
        let quality = self.least_quality;
        in_range(
            "least_quality",
            quality,
            (0.0..=1.0).contains(&quality),
            "between 0 and 1",
        )?;
        in_range("pictures", self.pictures as f64, self.pictures >= 1, "1 or more")?;
        Ok(())
    }
}
