//! A piece of textured work as the camera sees it, at many blurs.

use super::blur::{Discs, Kernel, Lens};
use super::texture::{Field, PERIOD_MM, Texture};
use crate::optics::{Optics, OpticsError};

/// How many blurs a tile has.
const LEVELS: usize = 16;

/// The largest blur is that of this part of the depth between top and bottom of a picture of a level plate.
const DEEPEST: f64 = 0.6;

/// Samples a pixel in each direction, odd.
const SAMPLES: usize = 3;

/// Up to this radius \[pixels\] a disc is taken from the samples, beyond from the pixels.
const FINE: f64 = 3.0;

/// A period of a texture in pixels of a camera's picture: seen at the tilt, smeared by travel, blurred by diffraction
/// and pixels, and at each level by a disc. Cameras of the same make may share it.
#[derive(Clone, Debug)]
pub struct Tile {
    texture: Texture,
    optics: Optics,
    smear_mm: f64,
    /// Pixels in a period, along rows and columns of the picture.
    size: [usize; 2],
    levels: Vec<Level>,
}

/// The tile at one blur.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// Square of the disc's radius \[pixels\].
    pub radius_squared: f32,
    /// Brightness is `low + step` × code.
    pub low: f32,
    pub step: f32,
    /// Rows of one period and one picture more, so that any row of a picture is in one piece.
    codes: Vec<u8>,
    /// Length of a row of codes.
    length: usize,
}

impl Tile {
    /// Makes the tile of a texture for a camera; `smear_mm` is how far the work travels during an exposure. It takes some
    /// seconds.
    pub fn new(texture: Texture, optics: Optics, smear_mm: f64) -> Result<Self, OpticsError> {
        optics.check()?;
        let lens = Lens::new(&optics);
        let cos = optics.tilt_rad.cos();
        let pixels = [PERIOD_MM[0] * cos, PERIOD_MM[1]].map(|period| period / lens.pixel_mm);
        let size = pixels.map(|count| (count.round() as usize).max(1));
        let fine = size.map(|count| count * SAMPLES);
        let samples = sampled(texture, fine);
        let per_pixel = SAMPLES as f64;
        let diffraction = lens.diffraction_mm / lens.pixel_mm * per_pixel;
        let smear = smear_mm * cos / lens.pixel_mm * per_pixel;
        let across = Kernel::new(diffraction, &[per_pixel]);
        let along = Kernel::new(diffraction, &[per_pixel, smear]);
        let deepest = DEEPEST * optics.rows as f64 * optics.tilt_rad.tan() * lens.spread;
        let fine = Sums::new(&smeared(&samples, fine, &across, &along), fine, FINE * per_pixel);
        let coarse = Sums::new(&fine.discs(0.0, SAMPLES), size, deepest);
        let level = |k: usize| {
            let radius = deepest * (k as f64 / (LEVELS - 1) as f64).powf(1.6);
            let seen = if radius <= FINE {
                fine.discs(radius * per_pixel, SAMPLES)
            } else {
                coarse.discs(radius, 1)
            };
            Level::new(radius, &seen, size, optics.columns)
        };
        Ok(Self {
            texture,
            optics,
            smear_mm,
            size,
            levels: (0..LEVELS).map(level).collect(),
        })
    }

    /// The texture.
    pub fn texture(&self) -> Texture {
        self.texture
    }

    /// The camera it was made for.
    pub fn optics(&self) -> &Optics {
        &self.optics
    }

    /// The travel it is smeared by \[mm\].
    pub fn smear_mm(&self) -> f64 {
        self.smear_mm
    }

    /// Its levels, from sharp to blurred.
    pub(super) fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Pixels in a period, along rows and columns.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }
}

impl Level {
    fn new(radius: f64, seen: &[f32], size: [usize; 2], columns: usize) -> Self {
        let low = seen.iter().fold(f32::MAX, |m, &x| m.min(x));
        let high = seen.iter().fold(f32::MIN, |m, &x| m.max(x));
        let step = ((high - low) / 255.0).max(1e-6);
        let length = size[1] + columns;
        let mut codes = Vec::with_capacity(size[0] * length);
        for row in seen.chunks_exact(size[1]) {
            let begin = codes.len();
            codes.extend(row.iter().map(|x| ((x - low) / step).round() as u8));
            // A picture may be wider than the period.
            while codes.len() < begin + length {
                let missing = begin + length - codes.len();
                codes.extend_from_within(begin..begin + missing.min(size[1]));
            }
        }
        Self {
            radius_squared: (radius * radius) as f32,
            low,
            step,
            codes,
            length,
        }
    }

    /// Codes of a row of the tile from a column on.
    pub fn row(&self, row: usize, column: usize) -> &[u8] {
        &self.codes[row * self.length + column..(row + 1) * self.length]
    }
}

/// A period of the texture, in so many samples along and across.
fn sampled(texture: Texture, size: [usize; 2]) -> Vec<f32> {
    let field = Field::new(texture);
    let step = [0, 1].map(|k| PERIOD_MM[k] / size[k] as f64);
    (0..size[0] * size[1])
        .map(|i| field.at((i / size[1]) as f64 * step[0], (i % size[1]) as f64 * step[1]))
        .collect()
}

/// Convolved with `across` in rows and `along` in columns, all around the period.
fn smeared(samples: &[f32], size: [usize; 2], across: &Kernel, along: &Kernel) -> Vec<f32> {
    let [rows, columns] = size;
    let mut out = vec![0.0; rows * columns];
    let mut line = vec![0.0; columns];
    for (row, out) in out.chunks_exact_mut(columns).enumerate() {
        line.fill(0.0);
        for (k, &weight) in along.0.iter().enumerate() {
            let from = around(row + k, along.reach(), rows);
            add(&mut line, weight, &samples[from * columns..][..columns]);
        }
        for (k, &weight) in across.0.iter().enumerate() {
            let (end, start) = line.split_at(around(k, across.reach(), columns));
            add(&mut out[..start.len()], weight, start);
            add(&mut out[start.len()..], weight, end);
        }
    }
    out
}

/// `at` − `back` of a period of `count`.
fn around(at: usize, back: usize, count: usize) -> usize {
    (at as i64 - back as i64).rem_euclid(count as i64) as usize
}

fn add(out: &mut [f32], weight: f32, values: &[f32]) {
    out.iter_mut().zip(values).for_each(|(out, x)| *out += weight * x);
}

/// Sums along the rows of a period and a bit more on both sides.
struct Sums {
    /// Of what the values are above 1, so that they stay small and f32 will do.
    sums: Vec<f32>,
    size: [usize; 2],
    margin: usize,
}

impl Sums {
    /// Sums that discs up to `radius` can be taken from.
    fn new(values: &[f32], size: [usize; 2], radius: f64) -> Self {
        let columns = size[1];
        let margin = radius.ceil() as usize + 2;
        let mut sums = Vec::with_capacity(size[0] * (columns + 2 * margin + 1));
        for row in values.chunks_exact(columns) {
            let mut sum = 0.0;
            sums.push(sum);
            for column in 0..columns + 2 * margin {
                sum += row[around(column, margin, columns)] - 1.0;
                sums.push(sum);
            }
        }
        Self { sums, size, margin }
    }

    /// Means over discs around every `stride`-th sample in both directions, the middle one of each square.
    fn discs(&self, radius: f64, stride: usize) -> Vec<f32> {
        let mut discs = Discs::default();
        discs.provide(radius);
        let halves = discs.of(radius);
        let area: f64 = 2.0 * (2.0 * halves.iter().sum::<f64>() - halves[0]);
        let [rows, columns] = self.size;
        let length = columns + 2 * self.margin + 1;
        let mut line = vec![0.0; columns / stride];
        let mut means = Vec::with_capacity(rows / stride * line.len());
        for row in (stride / 2..rows).step_by(stride) {
            line.fill(0.0);
            for k in 1 - halves.len() as i64..halves.len() as i64 {
                let from = (row as i64 + k).rem_euclid(rows as i64) as usize;
                let half = halves[k.unsigned_abs() as usize];
                let start = (self.margin + stride / 2) as f64 + 0.5;
                // The ends lie the same way between two samples in every column.
                for (end, sign) in [(start + half, 1.0), (start - half, -1.0)] {
                    let (whole, part) = (end as usize, end.fract() as f32);
                    let sums = &self.sums[from * length + whole..(from + 1) * length];
                    for (out, sums) in line.iter_mut().zip(sums.windows(2).step_by(stride)) {
                        *out += sign * (sums[0] + (sums[1] - sums[0]) * part);
                    }
                }
            }
            means.extend(line.iter().map(|sum| 1.0 + sum / area as f32));
        }
        means
    }
}
