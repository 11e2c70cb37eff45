//! Energy of the texture, in square cells of the picture.
//!
//! A lens that is out of focus takes the texture away; what is left of its energy, over what the camera's noise adds,
//! shows the defocus. Only differences across the seam count: travel smears along the rows.

use crate::layer::Layer;
use crate::noise::{LayerNoise, PhotonTransfer};

/// Expected energy of a cell that has no say: no model explains it and none is moved by it. It is not larger than that
/// needs: squares of what is left of a faint band beside it have to stay normal numbers, for others are slow.
const SILENT: f32 = 1e6;

/// Cells are padded to this many a column, for loops without a remainder.
pub(crate) const LANES: usize = 8;

/// Noise of neighbouring cells is not quite what the mean of a chi-square says; measured.
const NOISE_FACTOR: f64 = 1.25;

/// Share of a pixel's variance in the squared difference: (1, 2, 1)/4 over rows, two columns.
const FILTERED: f64 = 0.75;

/// Half the way over which the fall of the light is taken \[mm\].
const LIGHT_MM: f32 = 0.0276;

/// Energies of one level, column after column.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    /// Columns of cells.
    pub columns: usize,
    /// Cells in a column.
    pub rows: usize,
    /// Cells from one column to the next, a multiple of [`LANES`].
    pub stride: usize,
    /// Side of a cell \[mm\].
    pub pitch_mm: f32,
    /// Middle of the first cell: along the rows and along u \[mm\].
    pub origin_mm: [f32; 2],
    /// Mean squared lateral difference over squared mean.
    pub energy: Vec<f32>,
    /// What of it the camera's noise makes.
    pub noise: Vec<f32>,
    /// Pixels along a side.
    side: usize,
    /// Of a pixel of the layer.
    pixel_noise: LayerNoise,
    /// Levels that count, in steps of the layer: neither black nor saturated.
    usable: [f32; 2],
    /// Sums over a row of cells, for every column of pixels: squared differences, levels.
    squares: Vec<u32>,
    levels: Vec<u32>,
    /// A row after the (1, 2, 1) filter.
    smooth: Vec<i16>,
    /// Sum of the levels of the usable cells in a column, and their number.
    columns_light: Vec<[f32; 2]>,
}

impl Cells {
    /// Room for the cells of a layer, `side` pixels along each side.
    pub fn new(layer: &Layer, side: usize, transfer: &PhotonTransfer) -> Self {
        // The filter takes a pixel at each border.
        let columns = (layer.columns - 2) / side;
        let rows = (layer.rows - 2) / side;
        let stride = rows.next_multiple_of(LANES);
        let middle = layer.pitch_mm * (1.0 + (side as f64 - 1.0) / 2.0);
        Self {
            columns,
            rows,
            stride,
            pitch_mm: (layer.pitch_mm * side as f64) as f32,
            origin_mm: layer.origin_mm.map(|origin| (origin + middle) as f32),
            energy: vec![0.0; columns * stride],
            noise: vec![SILENT; columns * stride],
            side,
            pixel_noise: LayerNoise::new(transfer, layer),
            usable: [2.0 / layer.scale, 250.0 / layer.scale],
            squares: vec![0; layer.columns],
            levels: vec![0; layer.columns],
            smooth: vec![0; layer.columns],
            columns_light: vec![[0.0; 2]; columns],
        }
    }

    /// Position of a column's middle along u \[mm\].
    pub fn lateral(&self, column: usize) -> f32 {
        self.origin_mm[1] + column as f32 * self.pitch_mm
    }

    /// Energies and noise of a column, padded.
    pub fn column(&self, column: usize) -> (&[f32], &[f32]) {
        let place = column * self.stride..(column + 1) * self.stride;
        (&self.energy[place.clone()], &self.noise[place])
    }

    /// Measures the energies.
    pub fn fill(&mut self, layer: &Layer) {
        let side = self.side;
        self.columns_light.fill([0.0; 2]);
        for cell_row in 0..self.rows {
            self.squares.fill(0);
            self.levels.fill(0);
            for row in 1 + cell_row * side..1 + (cell_row + 1) * side {
                self.add_row(layer, row);
            }
            let squares = self.squares[1..].chunks_exact(side);
            let levels = self.levels[1..].chunks_exact(side);
            let pixels = (side * side) as f32;
            // Levels are of (1, 2, 1), four times a pixel.
            let (per_square, per_level) = (1.0 / (16.0 * pixels), 1.0 / (4.0 * pixels));
            for (column, (squares, levels)) in squares.zip(levels).take(self.columns).enumerate() {
                let level = levels.iter().sum::<u32>() as f32 * per_level;
                let square = squares.iter().sum::<u32>() as f32 * per_square;
                let place = column * self.stride + cell_row;
                if level > self.usable[0] && level < self.usable[1] {
                    let one = 1.0 / (level * level);
                    let variance = self.pixel_noise.variance(level);
                    let light = &mut self.columns_light[column];
                    *light = [light[0] + level, light[1] + 1.0];
                    self.energy[place] = square * one;
                    self.noise[place] = (NOISE_FACTOR * FILTERED) as f32 * variance * one;
                } else {
                    self.energy[place] = 0.0;
                    self.noise[place] = SILENT;
                }
            }
        }
        self.allow_for_light();
    }

    /// Adds to the noise what light that changes across the picture makes of a surface without texture: near the root of
    /// a corner it falls steeply, in all depths, and on faint texture that looks like being sharp.
    fn allow_for_light(&mut self) {
        let reach = (LIGHT_MM / self.pitch_mm).round().max(1.0) as usize;
        let per_difference = 2.0 / (2 * reach * self.side) as f32;
        for column in reach..self.columns.saturating_sub(reach) {
            let light = [column - reach, column, column + reach].map(|column| {
                let [sum, count] = self.columns_light[column];
                sum / count.max(1.0)
            });
            let slope = (light[2] - light[0]) * per_difference / light[1].max(1.0);
            for noise in &mut self.noise[column * self.stride..][..self.rows] {
                *noise += slope * slope;
            }
        }
    }

    /// Adds a row of pixels to the sums.
    fn add_row(&mut self, layer: &Layer, row: usize) {
        let rows = layer
            .row(row - 1)
            .iter()
            .zip(layer.row(row))
            .zip(layer.row(row + 1));
        for (smooth, ((above, here), below)) in self.smooth.iter_mut().zip(rows) {
            *smooth = (above + 2 * here + below) as i16;
        }
        let middle = &self.smooth[1..];
        for (level, smooth) in self.levels[1..].iter_mut().zip(middle) {
            *level += *smooth as u32;
        }
        let sides = self.smooth.iter().zip(&self.smooth[2..]);
        for (square, (left, right)) in self.squares[1..].iter_mut().zip(sides) {
            let difference = i32::from(*right) - i32::from(*left);
            *square += (difference * difference) as u32;
        }
    }
}
