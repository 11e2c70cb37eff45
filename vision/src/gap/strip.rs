//! The strip of the picture along the sharp band, straightened and evenly lit.

use super::{between, quantile};
use crate::layer::Layer;
use crate::noise::LayerNoise;

/// Half the height of the strip along the band in which a gap's edges are read \[mm along the rows\].
pub const EDGE_ROWS_MM: f64 = 0.08;

/// Height of a group of rows \[mm\].
const GROUP_MM: f64 = 0.0104;

/// Most groups.
pub(crate) const GROUPS: usize = 16;

/// Share of the groups that has to be dark in a column, less one.
const PERSISTENCE: f64 = 0.7;

/// Share of the columns darker than what counts as the light there.
const LIGHT: f64 = 0.7;

/// Windows over which the light is taken.
const WINDOWS: usize = 9;

/// Slants of a seam that are tried \[columns a row\].
const SLANTS: [f64; 5] = [-0.12, -0.06, 0.0, 0.06, 0.12];

/// Noise over what was calibrated that is believed: of coarse pixels it is mostly texture.
const NOISIEST: f32 = 3.0;

/// The strip: for every column the brightness of groups of rows over the light.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    /// Number of groups.
    pub groups: usize,
    /// Rows of a group.
    rows: usize,
    /// Pixel \[mm\].
    pitch_mm: f64,
    /// What the camera was calibrated to.
    calibrated: LayerNoise,
    /// Variance of a pixel in each column by what differs from row to row: noise, as texture is coarser than fine pixels.
    noise: Vec<f32>,
    /// Brightness of each group in a column over the light there.
    pub values: Vec<[f32; GROUPS]>,
    /// Which columns lie in the picture over the whole height of the strip.
    pub seen: Vec<bool>,
    /// Brightness that all but 30 % of the groups keep under, at the best slant.
    pub quiet: Vec<f32>,
    /// That slant \[columns a row\].
    pub slant: f64,
    /// What a column's values were multiplied by.
    gains: Vec<f32>,
    /// Medians of columns, and room to sort them.
    medians: Vec<f32>,
    sorted: Vec<f32>,
    /// `quiet` of a slant being tried.
    tried: Vec<f32>,
}

/// Where the band lies in a layer: row of its middle for a column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BandLine {
    /// Row at the first column, rows a column.
    pub first: f64,
    pub slope: f64,
}

impl BandLine {
    /// The band of the plate n = h + q·u.
    pub fn of_plate(layer: &Layer, height: f64, roll: f64, sin: f64) -> Self {
        let row_mm = (height + roll * layer.origin_mm[1]) / sin - layer.origin_mm[0];
        Self {
            first: row_mm / layer.pitch_mm,
            slope: roll / sin,
        }
    }

    /// Row at a column.
    pub fn row(&self, column: f64) -> f64 {
        self.first + self.slope * column
    }
}

impl Strip {
    /// Room for strips of a layer.
    pub fn new(layer: &Layer, calibrated: LayerNoise) -> Self {
        let rows = ((GROUP_MM / layer.pitch_mm).round() as usize).max(1);
        let groups = (2.0 * EDGE_ROWS_MM / layer.pitch_mm / rows as f64).round() as usize;
        let columns = layer.columns;
        Self {
            groups: groups.clamp(3, GROUPS),
            rows,
            pitch_mm: layer.pitch_mm,
            calibrated,
            noise: vec![0.0; columns],
            values: vec![[0.0; GROUPS]; columns],
            seen: vec![false; columns],
            quiet: vec![1.0; columns],
            slant: 0.0,
            gains: vec![1.0; columns],
            medians: vec![0.0; columns],
            sorted: Vec::with_capacity(columns),
            tried: vec![1.0; columns],
        }
    }

    /// Rows from the band to the middle of a group.
    pub fn offset(&self, group: usize) -> f64 {
        (group as f64 - (self.groups as f64 - 1.0) / 2.0) * self.rows as f64
    }

    /// Groups in a length along the rows.
    pub fn groups_of(&self, length_mm: f64) -> usize {
        (length_mm / (self.rows as f64 * self.pitch_mm)).round() as usize
    }

    /// Brightness of the plate to the left of a column and to the right, before it is divided by the light: that which most
    /// columns within `reach` of them do not exceed, from `margin` columns on. None of a side without any.
    pub fn lights(&mut self, columns: [f64; 2], margin: f64, reach: f64) -> [Option<f32>; 2] {
        let [left, right] = columns;
        let clamp = |column: f64| (column.round().max(0.0) as usize).min(self.medians.len());
        let sides = [
            clamp(left - margin - reach)..clamp(left - margin),
            clamp(right + margin)..clamp(right + margin + reach),
        ];
        sides.map(|side| {
            self.sorted.clear();
            let medians = self.medians[side].iter().filter(|median| !median.is_nan());
            self.sorted.extend(medians);
            quantile(&mut self.sorted, LIGHT)
        })
    }

    /// Variance that the camera's noise makes of the values of a column, if they are as bright as that.
    pub fn noise(&self, column: usize, brightness: f32) -> f32 {
        let (rows, gain) = (self.rows as f32, self.gains[column]);
        let expected = self.calibrated.variance((brightness / gain / rows).max(0.0));
        rows * self.noise[column].min(NOISIEST * expected) * gain * gain
    }

    /// Cuts the strip out. False if not half of it lies in the picture.
    pub fn fill(&mut self, layer: &Layer, line: BandLine) -> bool {
        let height = self.groups * self.rows;
        let mut seen = 0;
        for column in 0..layer.columns {
            let first = (line.row(column as f64) - (height as f64 - 1.0) / 2.0).round();
            self.seen[column] = first >= 0.0 && first + height as f64 <= layer.rows as f64;
            if !self.seen[column] {
                self.medians[column] = f32::NAN;
                continue;
            }
            seen += 1;
            let mut place = first as usize * layer.columns + column;
            let values = &mut self.values[column];
            let (mut before, mut bends) = ([0; 2], 0);
            for (group, value) in values[..self.groups].iter_mut().enumerate() {
                let mut sum = 0;
                for row in 0..self.rows {
                    let pixel = i32::from(layer.pixels[place]);
                    sum += pixel;
                    if group * self.rows + row >= 2 {
                        bends += i64::from(pixel - 2 * before[0] + before[1]).pow(2);
                    }
                    before = [pixel, before[0]];
                    place += layer.columns;
                }
                *value = sum as f32;
            }
            self.noise[column] = bends as f32 / (6 * (height - 2)) as f32;
            let mut sorted = *values;
            self.medians[column] = kth(&mut sorted[..self.groups], self.groups / 2);
        }
        if 2 * seen < layer.columns {
            return false;
        }
        self.level();
        self.search_slant();
        true
    }

    /// Divides by the light.
    fn level(&mut self) {
        let columns = self.values.len();
        let mut lights = [0.0_f32; WINDOWS];
        for (window, light) in lights.iter_mut().enumerate() {
            let middle = window * (columns - 1) / (WINDOWS - 1);
            let window = middle.saturating_sub(columns / 4)..(middle + columns / 4).min(columns);
            self.sorted.clear();
            let medians = &self.medians[window];
            self.sorted
                .extend(medians.iter().filter(|median| !median.is_nan()));
            *light = quantile(&mut self.sorted, LIGHT).unwrap_or(0.0);
        }
        let brightest = lights.iter().copied().fold(1.0, f32::max);
        for column in 0..columns {
            let window = column as f32 * (WINDOWS - 1) as f32 / (columns - 1) as f32;
            let left = (window as usize).min(WINDOWS - 2);
            let light = between([lights[left], lights[left + 1]], window - left as f32);
            let one = 1.0 / light.max(0.05 * brightest);
            self.gains[column] = one;
            if self.seen[column] {
                self.values[column].iter_mut().for_each(|value| *value *= one);
            } else {
                self.values[column] = [1.0; GROUPS];
            }
        }
    }

    /// Takes the slant under which most is dark.
    fn search_slant(&mut self) {
        let mut most = -1.0;
        for slant in SLANTS {
            self.quieten(slant);
            let darkness: f32 = self.tried.iter().map(|quiet| (0.75 - quiet).max(0.0)).sum();
            if darkness > most {
                most = darkness;
                self.slant = slant;
                std::mem::swap(&mut self.quiet, &mut self.tried);
            }
        }
    }

    /// The brightness that has to persist, along lines of a slant.
    fn quieten(&mut self, slant: f64) {
        let columns = self.values.len() as isize;
        let shifts: [isize; GROUPS] =
            std::array::from_fn(|group| (slant * self.offset(group)).round() as isize);
        let rank = (PERSISTENCE * (self.groups as f64 - 1.0)).round() as usize;
        for column in 0..columns {
            let mut along = [0.0; GROUPS];
            let groups = along[..self.groups].iter_mut().zip(&shifts).enumerate();
            for (group, (to, shift)) in groups {
                let from = (column + shift).clamp(0, columns - 1);
                *to = self.values[from as usize][group];
            }
            self.tried[column as usize] = kth(&mut along[..self.groups], rank);
        }
    }
}

/// The value of this rank among a few.
fn kth(values: &mut [f32], rank: usize) -> f32 {
    for end in 1..values.len() {
        let value = values[end];
        let mut place = end;
        while place > 0 && values[place - 1] > value {
            values[place] = values[place - 1];
            place -= 1;
        }
        values[place] = value;
    }
    values[rank]
}
