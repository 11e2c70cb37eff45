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

/// A period of a texture in pixels of a camera's picture: seen at the tilt, on a plate or a wall, smeared by travel,
/// blurred by diffraction and pixels, and at each level by a disc. Cameras of the same make may share it.
#[derive(Clone, Debug)]
pub struct Tile {
    texture: Texture,
    optics: Optics,
    slope: f64,
    grid: Grid,
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

/// Values that repeat.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// After how many they do along rows and columns of the picture.
    pub size: [usize; 2],
    /// How many rows lower the surface of a wall is one period of columns further right.
    pub lower: i64,
}

impl Grid {
    fn finer(self, times: usize) -> Self {
        Self {
            size: self.size.map(|count| count * times),
            lower: self.lower * times as i64,
        }
    }

    /// The row of values in which a row goes on so many periods of columns further right.
    pub fn row(&self, row: i64, periods: i64) -> usize {
        (row - periods * self.lower).rem_euclid(self.size[0] as i64) as usize
    }

    /// A row of values and some more to its left and right.
    fn stretch<'a, T>(&self, values: &'a [T], row: usize, more: [usize; 2]) -> impl Iterator<Item = &'a T> {
        let (this, columns) = (*self, self.size[1] as i64);
        let mut at = -(more[0] as i64);
        let end = columns + more[1] as i64;
        std::iter::from_fn(move || {
            let (periods, column) = (at.div_euclid(columns), at.rem_euclid(columns));
            let count = (columns - column).min(end - at);
            let from = this.row(row as i64, periods) as i64 * columns + column;
            at += count;
            (count > 0).then(|| &values[from as usize..(from + count) as usize])
        })
        .flatten()
    }
}

impl Tile {
    /// Makes the tile of a texture for a camera. `slope` is dn/du of the surface, 0 of a plate (roll up to 10° does no
    /// harm); `smear_mm` how far the work travels during an exposure. It takes some seconds.
    pub fn new(texture: Texture, optics: Optics, slope: f64, smear_mm: f64) -> Result<Self, OpticsError> {
        optics.check()?;
        let lens = Lens::new(&optics);
        let (sin, cos) = optics.tilt_rad.sin_cos();
        let pixels =
            [PERIOD_MM[0] * cos, PERIOD_MM[1] / slope.hypot(1.0)].map(|period| period / lens.pixel_mm);
        let size = pixels.map(|count| (count.round() as usize).max(1));
        let lower = (slope * sin * size[1] as f64).round() as i64;
        let grid = Grid { size, lower };
        let fine = grid.finer(SAMPLES);
        let samples = sampled(texture, fine);
        let per_pixel = SAMPLES as f64;
        let diffraction = lens.diffraction_mm / lens.pixel_mm * per_pixel;
        let smear = smear_mm * cos / lens.pixel_mm * per_pixel;
        let across = Kernel::new(diffraction, &[per_pixel]);
        let along = Kernel::new(diffraction, &[per_pixel, smear]);
        let deepest = DEEPEST * optics.rows as f64 * optics.tilt_rad.tan() * lens.spread;
        let fine = Sums::new(&smeared(&samples, fine, &across, &along), fine, FINE * per_pixel);
        let coarse = Sums::new(&fine.discs(0.0, SAMPLES), grid, deepest);
        let level = |k: usize| {
            let radius = deepest * (k as f64 / (LEVELS - 1) as f64).powf(1.6);
            let seen = if radius <= FINE {
                fine.discs(radius * per_pixel, SAMPLES)
            } else {
                coarse.discs(radius, 1)
            };
            Level::new(radius, &seen, grid, optics.columns)
        };
        Ok(Self {
            texture,
            optics,
            slope,
            grid,
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

    /// dn/du of the surface.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Its levels, from sharp to blurred.
    pub(super) fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// How it repeats.
    pub(super) fn grid(&self) -> Grid {
        self.grid
    }
}

impl Level {
    fn new(radius: f64, seen: &[f32], grid: Grid, columns: usize) -> Self {
        let low = seen.iter().fold(f32::MAX, |m, &x| m.min(x));
        let high = seen.iter().fold(f32::MIN, |m, &x| m.max(x));
        let step = ((high - low) / 255.0).max(1e-6);
        let length = grid.size[1] + columns;
        let mut codes = Vec::with_capacity(grid.size[0] * length);
        for row in 0..grid.size[0] {
            let row = grid.stretch(seen, row, [0, columns]);
            codes.extend(row.map(|x| ((x - low) / step).round() as u8));
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

/// A period of the texture as the rows and columns of a picture see it.
fn sampled(texture: Texture, grid: Grid) -> Vec<f32> {
    let field = Field::new(texture);
    let [rows, columns] = grid.size;
    let step = [PERIOD_MM[0] / rows as f64, PERIOD_MM[1] / columns as f64];
    let lower = grid.lower as f64 / columns as f64;
    let at = |row: usize, column: usize| {
        let column = column as f64;
        field.at((row as f64 - lower * column) * step[0], column * step[1])
    };
    (0..rows * columns)
        .map(|i| at(i / columns, i % columns))
        .collect()
}

/// Convolved with `across` in rows and `along` in columns, all around the period.
fn smeared(samples: &[f32], grid: Grid, across: &Kernel, along: &Kernel) -> Vec<f32> {
    let [rows, columns] = grid.size;
    let mut lines = vec![0.0; rows * columns];
    for (row, line) in lines.chunks_exact_mut(columns).enumerate() {
        for (k, &weight) in along.0.iter().enumerate() {
            let from = (row + k) as i64 - along.reach() as i64;
            add(line, weight, &samples[grid.row(from, 0) * columns..][..columns]);
        }
    }
    let mut out = vec![0.0; rows * columns];
    let mut line = Vec::new();
    for (row, out) in out.chunks_exact_mut(columns).enumerate() {
        line.clear();
        line.extend(grid.stretch(&lines, row, [across.reach(); 2]));
        for (k, &weight) in across.0.iter().enumerate() {
            add(out, weight, &line[k..]);
        }
    }
    out
}

fn add(out: &mut [f32], weight: f32, values: &[f32]) {
    out.iter_mut().zip(values).for_each(|(out, x)| *out += weight * x);
}

/// Sums along the rows of a period and a bit more on both sides.
struct Sums {
    /// Of what the values are above 1, so that they stay small and f32 will do.
    sums: Vec<f32>,
    grid: Grid,
    margin: usize,
}

impl Sums {
    /// Sums that discs up to `radius` can be taken from.
    fn new(values: &[f32], grid: Grid, radius: f64) -> Self {
        let [rows, columns] = grid.size;
        let margin = radius.ceil() as usize + 2;
        let mut sums = Vec::with_capacity(rows * (columns + 2 * margin + 1));
        for row in 0..rows {
            let mut sum = 0.0;
            sums.push(sum);
            sums.extend(grid.stretch(values, row, [margin; 2]).map(|x| {
                sum += x - 1.0;
                sum
            }));
        }
        Self { sums, grid, margin }
    }

    /// Means over discs around every `stride`-th sample in both directions, the middle one of each square.
    fn discs(&self, radius: f64, stride: usize) -> Vec<f32> {
        let mut discs = Discs::default();
        discs.provide(radius);
        let halves = discs.of(radius);
        let area: f64 = 2.0 * (2.0 * halves.iter().sum::<f64>() - halves[0]);
        let [rows, columns] = self.grid.size;
        let length = columns + 2 * self.margin + 1;
        let mut line = vec![0.0; columns / stride];
        let mut means = Vec::with_capacity(rows / stride * line.len());
        for row in (stride / 2..rows).step_by(stride) {
            line.fill(0.0);
            for k in 1 - halves.len() as i64..halves.len() as i64 {
                let from = self.grid.row(row as i64 + k, 0);
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
