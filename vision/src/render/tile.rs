//! A piece of textured work as the camera sees it, at many blurs.

use super::blur::{Kernel, Lens};
use super::grid::Grid;
use super::parallel::in_parallel;
use super::sums::Sums;
use super::texture::{Field, PERIOD_MM, Texture};
use crate::optics::{Optics, OpticsError};

/// How many blurs a tile has.
const LEVELS: usize = 16;

/// The largest blur is that of this part of the depth between top and bottom of a picture of a level plate.
const DEEPEST: f64 = 0.6;

/// Samples a pixel, odd.
const SAMPLES: usize = 3;

/// Up to this radius \[pixels\] a disc is taken from the samples, beyond from every second pixel.
const FINE: f64 = 6.0;

/// What taking every second pixel and going straight between them blurs by, as the square of a disc's radius \[pixels²\].
const HALVING: f64 = 4.0;

/// A period of a texture in pixels of a camera's picture: seen at the tilt, on a plate or a wall, smeared by travel,
/// blurred by diffraction and pixels, and at each level by a disc. Cameras of the same make may share it.
#[derive(Clone, Debug)]
pub struct Tile {
    texture: Texture,
    optics: Optics,
    slope: f64,
    grid: Grid,
    /// Pixels of the tile for one of the picture: a period is a whole number of them.
    scale: [f64; 2],
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
    /// Makes the tile of a texture for a camera. `slope` is dn/du of the surface, 0 of a plate (roll up to 10° does no
    /// harm); `smear_mm` how far the work travels during an exposure. It takes a part of a second on
    /// every core.
    pub fn new(texture: Texture, optics: Optics, slope: f64, smear_mm: f64) -> Result<Self, OpticsError> {
        optics.check()?;
        let lens = Lens::new(&optics);
        let (sin, cos) = optics.tilt_rad.sin_cos();
        let pixels =
            [PERIOD_MM[0] * cos, PERIOD_MM[1] / slope.hypot(1.0)].map(|period| period / lens.pixel_mm);
        let even = |count: f64| 2 * (count / 2.0).round().max(1.0) as usize;
        let size = pixels.map(even);
        let lower = 2 * (slope * sin * size[1] as f64 / 2.0).round() as i64;
        let grid = Grid { size, lower };
        let deepest = DEEPEST * optics.rows as f64 * optics.tilt_rad.tan() * lens.spread;
        let sharp = sharp(texture, grid, &lens, smear_mm * cos);
        let fine = Sums::new(&sharp, grid.finer(SAMPLES), SAMPLES, FINE.min(deepest));
        let half = grid.halved();
        let coarse = Sums::new(&grid.means(&fine.discs(0.0)), half, 1, deepest / 2.0);
        let levels = in_parallel(LEVELS, |k| {
            let radius = deepest * (k as f64 / (LEVELS - 1) as f64).powf(1.6);
            let seen = if radius <= FINE {
                fine.discs(radius)
            } else {
                let disc = (radius * radius - HALVING).sqrt();
                half.doubled(&coarse.discs(disc / 2.0))
            };
            Level::new(radius, &seen, grid, optics.columns)
        });
        Ok(Self {
            texture,
            optics,
            slope,
            grid,
            levels,
            scale: [0, 1].map(|k| size[k] as f64 / pixels[k]),
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

    /// Its rows and columns for one of the picture.
    pub(super) fn scale(&self) -> [f64; 2] {
        self.scale
    }
}

impl Level {
    fn new(radius: f64, seen: &[f32], grid: Grid, columns: usize) -> Self {
        let low = seen.iter().fold(f32::MAX, |m, &x| m.min(x));
        let high = seen.iter().fold(f32::MIN, |m, &x| m.max(x));
        let step = ((high - low) / 255.0).max(1e-6);
        let length = grid.size[1] + columns;
        let one = 1.0 / step;
        let period: Vec<u8> = seen.iter().map(|x| ((x - low) * one + 0.5) as u8).collect();
        let mut codes = Vec::with_capacity(grid.size[0] * length);
        for row in 0..grid.size[0] {
            grid.stretch(&period, row, [0, columns], &mut codes);
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

/// A period of the texture as a camera sees it that is all in focus: smeared by travel, diffraction and pixels. A row
/// has [`SAMPLES`] values a pixel.
fn sharp(texture: Texture, grid: Grid, lens: &Lens, smear_mm: f64) -> Vec<f32> {
    let field = Field::new(texture);
    let per_pixel = SAMPLES as f64;
    let diffraction = lens.diffraction_mm / lens.pixel_mm * per_pixel;
    let across = Kernel::new(diffraction, &[per_pixel]);
    let along = Kernel::new(diffraction, &[per_pixel, smear_mm / lens.pixel_mm * per_pixel]);
    let [rows, columns] = grid.size;
    let fine = grid.finer(SAMPLES);
    let step = [
        PERIOD_MM[0] / (rows * SAMPLES) as f64,
        PERIOD_MM[1] / fine.size[1] as f64,
    ];
    let lower = grid.lower as f64 / columns as f64;
    // Columns first: along them a wall is not skewed, and of the rows not all are needed.
    let seen = in_parallel(fine.size[1], |column| {
        let column = column as f64 - (SAMPLES / 2) as f64;
        let first = -lower * column - along.reach() as f64;
        let mut places = vec![0.0; (rows - 1) * SAMPLES + along.0.len()];
        field.along(first * step[0], step[0], column * step[1], &mut places);
        let line = places.windows(along.0.len()).step_by(SAMPLES);
        line.map(|places| places.iter().zip(&along.0).map(|(x, weight)| x * weight).sum())
            .collect::<Vec<f32>>()
    });
    let mut lines = vec![0.0; rows * fine.size[1]];
    for (row, line) in lines.chunks_exact_mut(fine.size[1]).enumerate() {
        line.iter_mut()
            .zip(&seen)
            .for_each(|(to, column)| *to = column[row]);
    }
    let rows = in_parallel(rows, |row| {
        let mut line = Vec::with_capacity(fine.size[1] + across.0.len());
        fine.stretch(&lines, row, [across.reach(); 2], &mut line);
        let mut out = vec![0.0; fine.size[1]];
        for (k, &weight) in across.0.iter().enumerate() {
            out.iter_mut()
                .zip(&line[k..])
                .for_each(|(out, x)| *out += weight * x);
        }
        out
    });
    rows.concat()
}
