//! The picture at several resolutions.

use crate::image::Image;

/// Largest value of a pixel: sums of squares of 4 × 4 cells then stay below 2^32.
const CEILING: u32 = 4080;

/// A picture in whole numbers, with the optical axis in its middle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layer {
    pub pixels: Vec<u16>,
    pub rows: usize,
    pub columns: usize,
    /// Object pixel in the focal plane \[mm\].
    pub pitch_mm: f64,
    /// Steps of the camera's 8 bits in one of a pixel here.
    pub scale: f32,
    /// Pixels of the camera in one here.
    pub binned: f64,
    /// Largest value a pixel can have.
    largest: u32,
    /// Position of the middle of the first row and column, from the optical axis \[mm\].
    pub origin_mm: [f64; 2],
}

impl Layer {
    /// Room for the camera's picture.
    pub fn of_camera(rows: usize, columns: usize, centre: [f64; 2], pitch_mm: f64) -> Self {
        Self {
            pixels: vec![0; rows * columns],
            rows,
            columns,
            pitch_mm,
            scale: 1.0,
            binned: 1.0,
            largest: 255,
            origin_mm: centre.map(|centre| -centre * pitch_mm),
        }
    }

    /// Room for this picture at half the resolution.
    pub fn halved(&self) -> Self {
        let (rows, columns) = (self.rows / 2, self.columns / 2);
        let shift = self.shift();
        Self {
            pixels: vec![0; rows * columns],
            rows,
            columns,
            pitch_mm: 2.0 * self.pitch_mm,
            scale: self.scale * (1 << shift) as f32 / 4.0,
            binned: 4.0 * self.binned,
            largest: (4 * self.largest) >> shift,
            origin_mm: self.origin_mm.map(|origin| origin + self.pitch_mm / 2.0),
        }
    }

    /// Bits that a sum of four pixels has to lose.
    fn shift(&self) -> u32 {
        if 4 * self.largest > CEILING { 2 } else { 0 }
    }

    /// Takes a picture of the camera.
    pub fn fill(&mut self, image: &Image) {
        for (row, to) in self.pixels.chunks_exact_mut(self.columns).enumerate() {
            for (to, from) in to.iter_mut().zip(image.row(row)) {
                *to = u16::from(*from);
            }
        }
    }

    /// Takes a picture of twice the resolution, 2 × 2 pixels in one.
    pub fn fill_halved(&mut self, finer: &Self) {
        let shift = finer.shift();
        let round = (1 << shift) >> 1;
        for (row, to) in self.pixels.chunks_exact_mut(self.columns).enumerate() {
            let (above, below) = finer.pixels[2 * row * finer.columns..].split_at(finer.columns);
            let pairs = above.chunks_exact(2).zip(below.chunks_exact(2));
            for (to, (above, below)) in to.iter_mut().zip(pairs) {
                *to = (above[0] + above[1] + below[0] + below[1] + round) >> shift;
            }
        }
    }

    /// A row of pixels.
    pub fn row(&self, row: usize) -> &[u16] {
        &self.pixels[row * self.columns..][..self.columns]
    }
}
