//! What the gap and the plates beside it look like in each row of a picture, and the gap in rows that are blurred.

use super::{CLEAR_MM, FLANK_MM, MIDDLE, MOST, PLATE_MM};
use crate::layer::Layer;

/// Mean brightness beside the gap and in its middle, for each bin of rows; NaN where that is not in the picture.
pub(super) struct Rows {
    pub(super) left: [f32; MOST],
    pub(super) right: [f32; MOST],
    pub(super) middle: [f32; MOST],
    /// Between the gap and the plates that are looked at.
    pub(super) flanks: [[f32; MOST]; 2],
    pub(super) count: usize,
}

/// The gap in a layer, in its rows and columns.
pub(super) struct GapLine {
    pub(super) row: f64,
    pub(super) column: f64,
    /// Columns a row along the gap, rows a column across it.
    pub(super) slant: f64,
    pub(super) tilt: f64,
    pub(super) half: f64,
    /// Blur a row from the band.
    pub(super) blur: f64,
}

impl Rows {
    pub(super) fn of(layer: &Layer, line: &GapLine, bin: usize) -> Self {
        let mut rows = Self {
            left: [f32::NAN; MOST],
            right: [f32::NAN; MOST],
            middle: [f32::NAN; MOST],
            flanks: [[f32::NAN; MOST]; 2],
            count: (layer.rows / bin).min(MOST),
        };
        let wide = PLATE_MM / layer.pitch_mm;
        let clear = line.half + CLEAR_MM / layer.pitch_mm;
        let flank = (CLEAR_MM - FLANK_MM) / layer.pitch_mm;
        let middle = (MIDDLE * line.half).max(0.5);
        for k in 0..rows.count {
            let row = (k * bin) as f64 + (bin as f64 - 1.0) / 2.0;
            let column = line.column + line.slant * (row - line.row);
            let from = clear + line.blur * (row - line.row).abs();
            let mean =
                |[first, last]: [f64; 2]| line.mean(layer, k * bin..(k + 1) * bin, column, [first, last]);
            rows.left[k] = mean([-from - wide, -from]);
            rows.right[k] = mean([from, from + wide]);
            rows.middle[k] = mean([-middle, middle]);
            let (near, far) = (from - flank, from);
            rows.flanks[0][k] = mean([-far, -near]);
            rows.flanks[1][k] = mean([near, far]);
        }
        rows
    }
}

impl GapLine {
    /// Mean of the pixels so many columns beside a column, along the lines of the work that go across the seam.
    pub(super) fn mean(
        &self,
        layer: &Layer,
        rows: std::ops::Range<usize>,
        column: f64,
        [first, last]: [f64; 2],
    ) -> f32 {
        let from = (column + first).round().max(0.0) as usize;
        let to = ((column + last).round() + 1.0).clamp(0.0, layer.columns as f64) as usize;
        let whole = last - first;
        if (to.saturating_sub(from) as f64) < 0.4 * whole {
            return f32::NAN;
        }
        let (mut sum, mut count) = (0, 0);
        // Rows by which each column lies further down, in parts of 2^16.
        let step = (self.tilt * 65536.0) as i32;
        let mut shift = (self.tilt * (from as f64 - column) * 65536.0) as i32 + (1 << 15);
        for at in from..to {
            let top = rows.start as i32 + (shift >> 16);
            shift += step;
            if top < 0 || top as usize + rows.len() > layer.rows {
                continue;
            }
            let column = layer.pixels[top as usize * layer.columns + at..].iter();
            for pixel in column.step_by(layer.columns).take(rows.len()) {
                sum += u32::from(*pixel);
            }
            count += rows.len();
        }
        if 2 * count < (to - from) * rows.len() {
            f32::NAN
        } else {
            sum as f32 / count as f32
        }
    }
}

/// Most columns to either side of the middle of the gap of which its appearance is taken.
const WIDE: usize = 96;

/// How the gap looks across, near the band: the brightness of each column from its middle.
pub(super) struct Profile {
    pub(super) columns: [f64; 2 * WIDE + 1],
    pub(super) half: usize,
    /// Half of the columns that are looked at.
    pub(super) middle: f64,
}

impl Profile {
    pub(super) fn of(layer: &Layer, line: &GapLine, rows: std::ops::Range<usize>) -> Self {
        let middle = (MIDDLE * line.half).max(0.5);
        let most = line.blur * layer.rows as f64;
        let mut profile = Self {
            columns: [0.0; 2 * WIDE + 1],
            half: ((middle + most).ceil() as usize + 1).min(WIDE),
            middle,
        };
        let rows = rows.start..rows.end.min(layer.rows);
        for (k, to) in profile.columns[..=2 * profile.half].iter_mut().enumerate() {
            let offset = k as f64 - profile.half as f64;
            let (mut sum, mut count) = (0, 0);
            for row in rows.clone() {
                let column = line.column + line.slant * (row as f64 - line.row) + offset;
                let shifted = row as f64 + line.tilt * offset;
                if column < 0.0 || shifted < 0.0 {
                    continue;
                }
                let (row, column) = (shifted.round() as usize, column.round() as usize);
                if row < layer.rows && column < layer.columns {
                    sum += u32::from(layer.pixels[row * layer.columns + column]);
                    count += 1;
                }
            }
            *to = if count > 0 {
                f64::from(sum) / f64::from(count)
            } else {
                f64::NAN
            };
        }
        profile
    }

    /// Mean brightness of the middle where a point is blurred to a disc of this radius \[columns\].
    pub(super) fn blurred(&self, radius: f64) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        // The middle one, and two between it and the ends of what is looked at.
        for at in [-0.6 * self.middle, 0.0, 0.6 * self.middle] {
            let reach = (radius.max(0.7) + self.middle).ceil() as usize;
            let reach = reach.min(self.half);
            for k in self.half - reach..=self.half + reach {
                let x = (k as f64 - self.half as f64 - at) / radius.max(0.7);
                let value = self.columns[k];
                if x.abs() < 1.0 && !value.is_nan() {
                    // What a disc lays on a line.
                    let weight = (1.0 - x * x).sqrt();
                    sum += weight * value;
                    weights += weight;
                }
            }
        }
        sum / weights
    }
}
