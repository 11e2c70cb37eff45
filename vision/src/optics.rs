//! What a camera is made of.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Most pixels of a picture: more than the largest sensors of machine cameras have. What says that it has more is refused
/// before there is any memory for it.
pub const MOST_PIXELS: usize = 1 << 26;

/// Object pixels that a seam can be seen with \[mm\]: finer than a thousandth of the light's wavelength there is nothing,
/// and a gap of a tenth of a millimetre needs two.
const OBJECT_PIXEL_MM: [f64; 2] = [1e-6, 0.05];
/// Largest field of view to either side \[mm\]: a seam, with all that slides can move, takes a tenth of it.
const LARGEST_VIEW_MM: f64 = 100.0;
/// Wavelengths of light that cameras have lenses for \[mm\]: ultraviolet to thermal infrared.
const WAVELENGTH_MM: [f64; 2] = [1e-4, 2e-2];
/// Numerical apertures of lenses.
const APERTURE: [f64; 2] = [1e-3, 1.5];

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
    #[error("{what} of the camera is {value}; it must be above zero")]
    NotPositive {
        /// Which one.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// A figure that no lens or sensor has.
    #[error("{what} of the camera is {value}; it must be between {} and {}", range[0], range[1])]
    Range {
        /// Which one.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: [f64; 2],
    },
    /// More pixels than any sensor has.
    #[error("the camera has {rows} rows of {columns} pixels; {MOST_PIXELS} pixels in all are possible")]
    Pixels {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
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
        let (rows, columns) = (self.rows, self.columns);
        if rows
            .checked_mul(columns)
            .is_none_or(|pixels| pixels > MOST_PIXELS)
        {
            return Err(OpticsError::Pixels { rows, columns });
        }
        let object_pixel_mm = self.object_pixel_mm();
        let view_mm = object_pixel_mm * rows.max(columns) as f64;
        let ranges = [
            ("the wavelength in mm", self.wavelength_mm, WAVELENGTH_MM),
            ("the numerical aperture", self.aperture, APERTURE),
            (
                "the pixel pitch over the magnification in mm",
                object_pixel_mm,
                OBJECT_PIXEL_MM,
            ),
            ("the field of view in mm", view_mm, [0.0, LARGEST_VIEW_MM]),
        ];
        for (what, value, range) in ranges {
            if !(range[0]..=range[1]).contains(&value) {
                return Err(OpticsError::Range { what, value, range });
            }
        }
        Ok(())
    }

    /// g: what a pixel sees of the object in the focal plane \[mm\].
    pub fn object_pixel_mm(&self) -> f64 {
        self.pixel_mm / self.magnification
    }

    /// How many pixels a side count as one where a picture is measured: finer ones than 2.4 µm add no
    /// information.
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
