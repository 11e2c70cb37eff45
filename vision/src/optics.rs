//! What a camera is made of.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Finest object pixel that is measured \[mm\].
const FINEST_MM: f64 = 0.0024;

/// Lens and sensor of a camera whose optical axis is tilted against the plate (mathematics 0.12).
///
/// Columns of its picture go along +u, across the seam; rows along (cos α, 0, sin α) in the frame (a along travel, u, n
/// out of the plate). What the axis meets in the focal plane is the middle of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Optics {
    /// Magnification of the lens.
    pub magnification: f64,
    /// Pitch of the pixels of a picture on the sensor, binned as they are \[mm\].
    pub pixel_mm: f64,
    /// α: angle between focal plane and plate \[rad\].
    pub tilt_rad: f64,
    /// Numerical aperture.
    pub aperture: f64,
    /// Wavelength of the light \[mm\].
    pub wavelength_mm: f64,
    /// Rows of a picture.
    pub rows: usize,
    /// Pixels a row.
    pub columns: usize,
}

/// Why a camera cannot be like that.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum OpticsError {
    /// A figure is not above zero and finite.
    #[error("{what} of the camera is {value}; it has to be above zero")]
    NotPositive {
        /// Which one.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// The focal plane is not tilted against the plate.
    #[error("the camera's tilt of {degrees}° is not between 5° and 85°")]
    Tilt {
        /// What it is.
        degrees: f64,
    },
}

impl Optics {
    /// Checks the figures.
    pub fn check(&self) -> Result<(), OpticsError> {
        let positive = [
            ("the magnification", self.magnification),
            ("the pixel pitch", self.pixel_mm),
            ("the numerical aperture", self.aperture),
            ("the wavelength", self.wavelength_mm),
            ("the number of rows", self.rows as f64),
            ("the number of columns", self.columns as f64),
        ];
        for (what, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(OpticsError::NotPositive { what, value });
            }
        }
        let degrees = self.tilt_rad.to_degrees();
        if !(5.0..=85.0).contains(&degrees) {
            return Err(OpticsError::Tilt { degrees });
        }
        Ok(())
    }

    /// g: what a pixel sees of the object in the focal plane \[mm\].
    pub fn object_pixel_mm(&self) -> f64 {
        self.pixel_mm / self.magnification
    }

    /// How many pixels a side count as one where a picture is measured: finer ones than 2.4 µm tell nothing more.
    pub fn binning(&self) -> usize {
        let mut binning = 1;
        while self.object_pixel_mm() * (binning as f64) < FINEST_MM {
            binning *= 2;
        }
        binning
    }

    /// Row and column of the optical axis.
    pub fn centre(&self) -> [f64; 2] {
        [(self.rows as f64 - 1.0) / 2.0, (self.columns as f64 - 1.0) / 2.0]
    }
}
