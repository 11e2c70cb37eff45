//! Where the band is in a picture nothing is known about: correlation on a coarse grid.

use crate::cells::Cells;

/// Steps of the grid over the heights of the band \[mm along the rows\].
const STEP_MM: f64 = 0.02;

/// Side of a block of cells \[mm\].
const BLOCK_MM: f64 = 0.0552;

/// How far beyond the picture's rows a band is looked for \[mm\].
const BEYOND_MM: f64 = 0.25;

/// Steps over the roll, to both sides: ±0.24.
const ROLL: (usize, f64) = (5, 0.048);

/// Steps of the corner over u \[mm\].
const LATERAL_MM: f64 = 0.02;

/// Share of a view's half width in which a corner is looked for.
const CORNER_VIEW: f64 = 0.8;

/// Correlations of every column of cells with the profile, for a grid of rows of the band.
#[derive(Clone, Debug)]
pub(crate) struct Coarse {
    /// Cells along the side of a block.
    block: usize,
    /// Columns and rows of blocks of cells, their side \[mm\] and the middle of the first along u \[mm\].
    columns: usize,
    rows: usize,
    pitch_mm: f64,
    lateral_mm: f64,
    /// Row of the first grid point, their number \[mm, 1\].
    first_mm: f64,
    grid: usize,
    /// The profile over the cells for every grid point, its mean taken off.
    profiles: Vec<f32>,
    /// Sums of its squares.
    norms: Vec<f32>,
    /// Correlations, column after column.
    correlations: Vec<f32>,
    /// Logarithms of the energies of a column of blocks.
    logarithms: Vec<f32>,
    sin: f64,
    /// Half of the view along the rows \[mm\].
    half_view_mm: f64,
}

/// A band on the grid.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    /// Its parameters: (h, q) of a plate or (h, u0) of a corner.
    pub at: [f64; 2],
    /// Root of the variance it explains.
    pub score: f64,
}

/// Parts of the view, each of which has its best band.
pub(crate) const PARTS: usize = 4;

/// The best bands: in parts of the view, and out of it to either side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sides {
    pub inside: [Found; PARTS],
    pub below: Found,
    pub above: Found,
}

impl Sides {
    /// The best of all.
    pub fn best(&self) -> Found {
        let others = self.inside.into_iter().chain([self.above]);
        others.fold(
            self.below,
            |best, found| if found.score > best.score { found } else { best },
        )
    }

    /// Takes a band at this part of the view, if it is better than those before.
    fn take(&mut self, part: f64, found: Found) {
        let side = if part < 0.0 {
            &mut self.below
        } else if part < 1.0 {
            &mut self.inside[(part * PARTS as f64) as usize]
        } else {
            &mut self.above
        };
        if found.score > side.score {
            *side = found;
        }
    }
}

impl Coarse {
    /// The grid over blocks of `cells` seen with a profile of the width s, by a camera tilted by α.
    pub fn new(cells: &Cells, profile_mm: f64, tilt_rad: f64) -> Self {
        let block = (BLOCK_MM / f64::from(cells.pitch_mm)).round().max(1.0) as usize;
        let (columns, rows) = (cells.columns / block, cells.rows / block);
        let pitch_mm = block as f64 * f64::from(cells.pitch_mm);
        let offset_mm = (block as f64 - 1.0) / 2.0 * f64::from(cells.pitch_mm);
        let middle = cells.origin_mm.map(|origin| f64::from(origin) + offset_mm);
        let half_view_mm = rows as f64 * pitch_mm / 2.0;
        let reach = half_view_mm + BEYOND_MM;
        let grid = (2.0 * reach / STEP_MM).ceil() as usize + 1;
        let first_mm = middle[0] - pitch_mm / 2.0 - BEYOND_MM;
        let mut profiles = vec![0.0; grid * rows];
        let mut norms = vec![0.0; grid];
        for (point, profile) in profiles.chunks_exact_mut(rows).enumerate() {
            let row_mm = first_mm + point as f64 * STEP_MM;
            for (row, value) in profile.iter_mut().enumerate() {
                let x = (middle[0] + row as f64 * pitch_mm - row_mm) * tilt_rad.tan() / profile_mm;
                *value = (1.0 + x * x).powf(-1.5) as f32;
            }
            let mean = profile.iter().sum::<f32>() / rows as f32;
            profile.iter_mut().for_each(|value| *value -= mean);
            norms[point] = profile.iter().map(|value| value * value).sum();
        }
        Self {
            block,
            columns,
            rows,
            pitch_mm,
            lateral_mm: middle[1],
            first_mm,
            grid,
            profiles,
            norms,
            correlations: vec![0.0; grid * columns],
            logarithms: vec![0.0; rows],
            sin: tilt_rad.sin(),
            half_view_mm,
        }
    }

    /// Correlates blocks of the cells.
    pub fn correlate(&mut self, cells: &Cells) {
        for column in 0..self.columns {
            let (mut sum, mut heard) = (0.0, 1e-6);
            for (row, to) in self.logarithms.iter_mut().enumerate() {
                let (mut energies, mut count) = (0.0, 0.0);
                for column in column * self.block..(column + 1) * self.block {
                    let (energy, noise) = cells.column(column);
                    for row in row * self.block..(row + 1) * self.block {
                        if noise[row] < 1.0 {
                            energies += energy[row] + 2.0 * noise[row];
                            count += 1.0;
                        }
                    }
                }
                *to = if count > 0.0 {
                    (energies / count).ln()
                } else {
                    f32::NAN
                };
                if count > 0.0 {
                    sum += *to;
                    heard += 1.0;
                }
            }
            let mean = sum / heard;
            for value in &mut self.logarithms {
                *value = if value.is_nan() { 0.0 } else { *value - mean };
            }
            let correlations = &mut self.correlations[column * self.grid..][..self.grid];
            for (to, profile) in correlations.iter_mut().zip(self.profiles.chunks_exact(self.rows)) {
                *to = profile.iter().zip(&self.logarithms).map(|(a, b)| a * b).sum();
            }
        }
    }

    /// The best plates.
    pub fn plates(&self) -> Sides {
        let mut sides = Sides::default();
        for step in 0..self.grid {
            let row_mm = self.first_mm + step as f64 * STEP_MM;
            for roll in 0..=2 * ROLL.0 {
                let q = (roll as f64 - ROLL.0 as f64) * ROLL.1;
                let score = self.score(|lateral| row_mm + q * lateral / self.sin);
                let at = [row_mm * self.sin, q];
                sides.take(self.part(row_mm), Found { at, score });
            }
        }
        sides
    }

    /// The best corners of walls with these slopes, by where their roots are.
    pub fn corners(&self, walls: [f64; 2]) -> Sides {
        let mut sides = Sides::default();
        let half = self.columns as f64 * self.pitch_mm / 2.0 * CORNER_VIEW;
        let steps = (half / LATERAL_MM) as isize;
        for step in 0..self.grid {
            let row_mm = self.first_mm + step as f64 * STEP_MM;
            for lateral in -steps..=steps {
                let u0 = lateral as f64 * LATERAL_MM;
                let score = self.score(|lateral| {
                    let from = lateral - u0;
                    let wall = if from < 0.0 { walls[0] } else { walls[1] };
                    row_mm + wall * from / self.sin
                });
                let at = [row_mm * self.sin, u0];
                sides.take(self.part(row_mm), Found { at, score });
            }
        }
        sides
    }

    /// Where a row is in the view: from 0 at its first to 1 at its last.
    fn part(&self, row_mm: f64) -> f64 {
        (row_mm - self.first_mm - BEYOND_MM) / (2.0 * self.half_view_mm)
    }

    /// Root of the variance that a band explains, 0 if it has the wrong sign.
    fn score(&self, row_at: impl Fn(f64) -> f64) -> f64 {
        let (mut correlation, mut norm) = (0.0_f32, 1e-9_f32);
        for column in 0..self.columns {
            let row_mm = row_at(self.lateral_mm + column as f64 * self.pitch_mm);
            let point = (row_mm - self.first_mm) / STEP_MM + 0.5;
            if point >= 0.0 && point < self.grid as f64 {
                let point = point as usize;
                correlation += self.correlations[column * self.grid + point];
                norm += self.norms[point];
            }
        }
        f64::from(correlation.max(0.0)) / f64::from(norm).sqrt()
    }
}
