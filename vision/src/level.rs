//! One resolution of the picture in the band engine: its cells against what a surface makes them expect.

use crate::cells::Cells;
use crate::height_field::HeightField;
use wide::f32x4;

/// Cells that one turn of the inner loop takes.
const LANES: usize = 4;

/// Columns of cells that share an amplitude.
const GROUP: usize = 16;

/// Smallest amplitude, in squares of the relative texture.
const SMALLEST_AMPLITUDE: f32 = 1e-7;

/// Rounds that find the amplitude of a picture without a band.
const FLAT_ROUNDS: usize = 4;

/// Cells of one resolution, and what the last pass over them gave.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub cells: Cells,
    /// Sums of every column.
    pub sums: Vec<Sums>,
    /// s \[mm\].
    profile_mm: f64,
    sin: f64,
    cos: f64,
    /// Amplitudes A of the groups of columns.
    amplitudes: Vec<f32>,
}

/// Sums over a column of cells; ψ is a cell's score, g = dlnP/dx, x the depth over the profile's width.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Σ ψ·g, Σ ψ·g·x.
    pub score: [f32; 2],
    /// Σ g², Σ g²·x, Σ g²·x².
    pub information: [f32; 3],
    /// Σ w·ψ, Σ w of the amplitude.
    amplitude: [f32; 2],
}

/// How x depends on a cell's row: x = first + step · row.
#[derive(Clone, Copy)]
struct Depths {
    first: f32,
    step: f32,
}

impl Level {
    /// Cells seen with a profile of the width s, by a camera tilted by α.
    pub fn new(cells: Cells, profile_mm: f64, tilt_rad: f64) -> Self {
        let groups = cells.columns.div_ceil(GROUP);
        let (sin, cos) = tilt_rad.sin_cos();
        Self {
            sums: vec![Sums::default(); cells.columns],
            cells,
            profile_mm,
            sin,
            cos,
            amplitudes: vec![0.0; groups],
        }
    }

    /// dx/dn.
    pub fn per_height(&self, focus: f64) -> f64 {
        -1.0 / (self.cos * self.profile_mm * focus.exp())
    }

    /// Amplitudes to begin with.
    pub fn reset(&mut self) {
        let cells = &self.cells;
        let (energy, heard) = cells
            .energy
            .iter()
            .zip(&cells.noise)
            .filter(|(_, noise)| **noise < 1.0)
            .fold((0.0, 1.0), |(sum, count), (energy, noise)| {
                (sum + (energy - noise).max(0.0), count + 1.0)
            });
        self.amplitudes.fill((energy / heard).max(SMALLEST_AMPLITUDE));
    }

    /// Compares all cells with `surface`, then moves the amplitudes.
    pub fn pass<const N: usize, S: HeightField<N>>(&mut self, surface: &S, at: &[f64; N]) {
        let compare = if S::SHARPEST {
            compare::<true>
        } else {
            compare::<false>
        };
        let cells = &self.cells;
        for group in 0..self.amplitudes.len() {
            let amplitude = self.amplitudes[group];
            let mut moved = [0.0, 0.0];
            for column in group * GROUP..cells.columns.min((group + 1) * GROUP) {
                let lateral = f64::from(cells.lateral(column));
                let weight = surface.weight(at, lateral, f64::from(cells.pitch_mm)) as f32;
                if weight == 0.0 {
                    self.sums[column] = Sums::default();
                    continue;
                }
                let depths = self.depths(surface.height(at, lateral).0, at[N - 1]);
                let (energy, noise) = cells.column(column);
                let sums = compare(energy, noise, amplitude, depths).times(weight);
                moved[0] += sums.amplitude[0];
                moved[1] += sums.amplitude[1];
                self.sums[column] = sums;
            }
            self.amplitudes[group] = moved_amplitude(amplitude, moved);
        }
    }

    /// Largest amplitude over the noise there.
    pub fn contrast(&self) -> f64 {
        let noise = self.cells.noise.iter().copied().fold(f32::INFINITY, f32::min);
        let amplitude = self.amplitudes.iter().copied().fold(0.0, f32::max);
        f64::from(amplitude / noise)
    }

    /// How much better `surface` explains the cells than a picture that is equally sharp everywhere: the logarithm of
    /// the likelihoods' ratio a cell.
    pub fn gain<const N: usize>(&self, surface: &impl HeightField<N>, at: &[f64; N]) -> f64 {
        let cells = &self.cells;
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for (group, amplitude) in self.amplitudes.iter().enumerate() {
            let columns = group * GROUP..cells.columns.min((group + 1) * GROUP);
            let flat = flat_amplitude(cells, columns.clone(), *amplitude);
            for column in columns {
                let lateral = f64::from(cells.lateral(column));
                if surface.weight(at, lateral, f64::from(cells.pitch_mm)) < 1.0 {
                    continue;
                }
                let (energy, noise) = cells.column(column);
                let depths = self.depths(surface.height(at, lateral).0, at[N - 1]);
                let ratio = likelihood_ratio(energy, noise, [*amplitude, flat], depths) / cells.rows as f32;
                sum += f64::from(ratio);
                count += 1.0;
            }
        }
        sum / count.max(1.0)
    }

    /// Depths of a column over a surface of this height.
    fn depths(&self, height: f64, focus: f64) -> Depths {
        let per_height = self.per_height(focus);
        // x = (r sin α − n) / (s cos α).
        let per_row = -per_height * self.sin;
        Depths {
            first: (f64::from(self.cells.origin_mm[0]) * per_row + height * per_height) as f32,
            step: (f64::from(self.cells.pitch_mm) * per_row) as f32,
        }
    }
}

/// Amplitude of columns without a band: their x is 0 everywhere.
fn flat_amplitude(cells: &Cells, columns: std::ops::Range<usize>, amplitude: f32) -> f32 {
    let mut flat = 0.3 * amplitude;
    for _ in 0..FLAT_ROUNDS {
        let mut moved = [0.0, 0.0];
        for column in columns.clone() {
            let (energy, noise) = cells.column(column);
            let sums = compare::<false>(
                energy,
                noise,
                flat,
                Depths {
                    first: 0.0,
                    step: 0.0,
                },
            );
            moved[0] += sums.amplitude[0];
            moved[1] += sums.amplitude[1];
        }
        flat = moved_amplitude(flat, moved);
    }
    flat
}

/// An amplitude after a pass.
fn moved_amplitude(amplitude: f32, [score, weight]: [f32; 2]) -> f32 {
    if weight > 0.0 {
        (amplitude * (1.0 + (score / weight).clamp(-0.5, 1.0))).max(SMALLEST_AMPLITUDE)
    } else {
        amplitude
    }
}

impl Sums {
    /// All of them times `weight`.
    fn times(self, weight: f32) -> Self {
        Self {
            score: self.score.map(|x| x * weight),
            information: self.information.map(|x| x * weight),
            amplitude: self.amplitude.map(|x| x * weight),
        }
    }
}

/// Sums over a column of cells. If the sharpest count most, each counts √T.
fn compare<const SHARPEST: bool>(energy: &[f32], noise: &[f32], amplitude: f32, depths: Depths) -> Sums {
    let one = f32x4::splat(1.0);
    let amplitude = f32x4::splat(amplitude);
    let mut sums = [f32x4::ZERO; 7];
    let mut x = f32x4::from(std::array::from_fn(|lane| {
        depths.first + depths.step * lane as f32
    }));
    let step = f32x4::splat(depths.step * LANES as f32);
    for (energy, noise) in energy.as_chunks().0.iter().zip(noise.as_chunks().0) {
        let (energy, noise) = (f32x4::new(*energy), f32x4::new(*noise));
        let square = one + x * x;
        let root = square.sqrt();
        let profile = one / (square * root);
        let signal = amplitude * profile;
        let expected = signal + noise;
        let both = expected + energy;
        let per_product = one / (expected * both);
        let psi = (energy - expected) * expected * per_product;
        let share = signal * both * per_product;
        let g = f32x4::splat(-3.0) * x * share * (root * profile);
        let counted_g = if SHARPEST { profile.sqrt() * g } else { g };
        let counted_gx = counted_g * x;
        let w = share * profile;
        let terms = [
            psi * counted_g,
            psi * counted_gx,
            g * counted_g,
            g * counted_gx,
            g * x * counted_gx,
            w * psi,
            w,
        ];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term;
        }
        x += step;
    }
    let [score, score_x, one, two, three, amplitude, weight] = sums.map(f32x4::reduce_add);
    Sums {
        score: [score, score_x],
        information: [one, two, three],
        amplitude: [amplitude, weight],
    }
}

/// Logarithm of the likelihood of a column with a band, over that without.
fn likelihood_ratio(energy: &[f32], noise: &[f32], amplitudes: [f32; 2], depths: Depths) -> f32 {
    let mut x = depths.first;
    let mut sum = 0.0;
    for (energy, noise) in energy.chunks_exact(LANES).zip(noise.chunks_exact(LANES)) {
        // One logarithm for several cells.
        let mut ratio = 1.0;
        for (energy, noise) in energy.iter().zip(noise) {
            let square = 1.0 + x * x;
            let banded = amplitudes[0] / (square * square.sqrt()) + noise;
            let level = amplitudes[1] + noise;
            let apart = (level + energy) / (banded + energy);
            ratio *= banded / level * apart * apart;
            x += depths.step;
        }
        sum += ratio.ln();
    }
    sum
}
