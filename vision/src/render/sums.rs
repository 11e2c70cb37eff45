//! Means over discs, by sums along rows.

use super::blur::Discs;
use super::grid::Grid;

/// Sums along the rows of a period and a bit more on both sides.
///
/// There may be several samples a pixel along a row. The sums up to the first of each pixel then lie side by side, then
/// those up to the second: what is added up for one pixel after the other is in one piece.
pub(super) struct Sums {
    /// Of what the values are above 1, so that they stay small and f32 will do.
    sums: Vec<f32>,
    grid: Grid,
    /// Samples a pixel.
    samples: usize,
    /// Pixels added on each side.
    margin: usize,
    /// Pixels of a row.
    length: usize,
}

impl Sums {
    /// Sums that discs up to `radius` \[pixels\] can be taken from, of values with an odd number of `samples` a pixel
    /// along the rows. `grid` counts samples.
    pub fn new(values: &[f32], grid: Grid, samples: usize, radius: f64) -> Self {
        let margin = radius.ceil() as usize + 2;
        let columns = grid.size[1] / samples;
        let length = columns + 2 * margin + 1;
        let mut sums = vec![0.0; grid.size[0] * samples * length];
        let mut line = Vec::new();
        for (row, sums) in sums.chunks_exact_mut(samples * length).enumerate() {
            let mut sum = 0.0;
            line.clear();
            grid.stretch(values, row, [margin * samples; 2], &mut line);
            for (k, x) in line.iter().enumerate() {
                sum += x - 1.0;
                sums[(k + 1) % samples * length + (k + 1) / samples] = sum;
            }
        }
        Self {
            sums,
            grid,
            samples,
            margin,
            length,
        }
    }

    /// Means over discs around every pixel; a radius below 0.5 blurs along the row only.
    pub fn discs(&self, radius: f64) -> Vec<f32> {
        let mut discs = Discs::default();
        discs.provide(radius);
        let disc = discs.of(radius);
        let halves = &disc.half_widths;
        let samples = self.samples as f64;
        let area = disc.area * samples;
        let [rows, columns] = self.grid.size;
        let columns = columns / self.samples;
        let mut means = vec![0.0; rows * columns];
        let start = (self.margin * self.samples + self.samples / 2) as f64 + 0.5;
        for (row, line) in means.chunks_exact_mut(columns).enumerate() {
            for k in 1 - halves.len() as i64..halves.len() as i64 {
                let from = self.grid.row(row as i64 + k, 0);
                let half = halves[k.unsigned_abs() as usize] * samples;
                // The ends lie the same way between two samples in every column.
                let [left, right] = [start - half, start + half];
                let parts = [left, right].map(|end| end.fract() as f32);
                let [a, b] = self.around(from, left as usize);
                let [c, d] = self.around(from, right as usize);
                for ((out, (a, b)), (c, d)) in line.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
                    *out += (c + (d - c) * parts[1]) - (a + (b - a) * parts[0]);
                }
            }
            let one = 1.0 / area as f32;
            line.iter_mut().for_each(|sum| *sum = 1.0 + *sum * one);
        }
        means
    }

    /// Sums up to a sample and to the next, for all pixels from the first on.
    fn around(&self, row: usize, sample: usize) -> [&[f32]; 2] {
        [sample, sample + 1].map(|sample| {
            let (pixel, phase) = (sample / self.samples, sample % self.samples);
            &self.sums[(row * self.samples + phase) * self.length..][pixel..self.length]
        })
    }
}
