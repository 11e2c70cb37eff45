//! Depth of field, and how errors in the picture become errors of the measurement (mathematics 0.12).

use crate::optics::Optics;

/// What a picture is read with, standard deviations in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readings {
    /// Of an edge's column in one row.
    pub edge: f64,
    /// Of the band's row in one block of columns.
    pub row: f64,
    /// Rows in which both edges are read.
    pub rows: f64,
    /// Columns from the first block to the last.
    pub span: f64,
    /// Blocks of columns.
    pub blocks: f64,
}

/// Standard deviations of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Of the seam's lateral position \[mm\].
    pub lateral_mm: f64,
    /// Of the gap's width \[mm\].
    pub width_mm: f64,
    /// Of the height \[mm\].
    pub height_mm: f64,
    /// Of the roll slope.
    pub roll: f64,
}

impl Readings {
    /// What readings of a plate give.
    pub fn precision(&self, optics: &Optics) -> Precision {
        let g = optics.object_pixel_mm();
        let sin = optics.tilt_rad.sin();
        Precision {
            lateral_mm: g * self.edge / (2.0 * self.rows).sqrt(),
            width_mm: g * self.edge * (2.0 / self.rows).sqrt(),
            height_mm: g * sin * self.row / self.blocks.sqrt(),
            roll: sin * self.row * (12.0 / self.blocks).sqrt() / self.span,
        }
    }
}

impl Optics {
    /// Depth of field: λ/NA² + e/(M·NA) with the pixel pitch e \[mm\].
    pub fn depth_of_field_mm(&self) -> f64 {
        self.wavelength_mm / self.aperture.powi(2) + self.pixel_mm / (self.magnification * self.aperture)
    }

    /// How wide the band of a level plate is in the focal plane, along the rows: depth of field / tan α \[mm\].
    pub fn band_mm(&self) -> f64 {
        self.depth_of_field_mm() / self.tilt_rad.tan()
    }
}
