//! Surfaces of metal, close up: brightness that belongs to a place on the work.

use super::random::{of_place, unit};

/// After how much a texture repeats: along travel and across \[mm\]. A picture shows a fifth of it.
pub const PERIOD_MM: [f64; 2] = [7.0656, 3.5328];

/// How a surface was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Noise of 12 and 32 µm (mathematics 0.12).
    Plain,
    /// Rolled: streaks along the seam.
    Rolled,
    /// Blasted, with glints.
    Blasted,
    /// Specular: its logarithm is what is even.
    Specular,
    /// Hardly any contrast: 6 %.
    Faint,
    /// Nothing finer than 30 µm.
    Coarse,
}

impl Finish {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Plain,
        Self::Rolled,
        Self::Blasted,
        Self::Specular,
        Self::Faint,
        Self::Coarse,
    ];

    /// The contrast surfaces like that usually have.
    pub fn contrast(self) -> f64 {
        match self {
            Self::Plain | Self::Coarse => 0.4,
            Self::Rolled | Self::Blasted => 0.35,
            Self::Specular => 1.0,
            Self::Faint => 0.06,
        }
    }

    /// Pitch along travel, pitch across \[mm\], weight.
    fn layers(self) -> &'static [(f64, f64, f64)] {
        match self {
            Self::Plain | Self::Specular | Self::Faint => &[(0.012, 0.012, 0.7), (0.032, 0.032, 0.5)],
            Self::Rolled => &[(0.3, 0.012, 0.7), (0.6, 0.04, 0.4), (0.012, 0.012, 0.25)],
            Self::Blasted => &[(0.014, 0.014, 0.7), (0.028, 0.028, 0.5)],
            Self::Coarse => &[(0.032, 0.032, 0.6), (0.07, 0.07, 0.6)],
        }
    }
}

/// A surface's looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// How it was made.
    pub finish: Finish,
    /// `tex` of mathematics 0.12: what the noise, within ±1 before its weights, is multiplied by.
    pub contrast: f64,
    /// Which piece of it.
    pub seed: u64,
}

impl Texture {
    /// A piece with the usual contrast.
    pub fn new(finish: Finish, seed: u64) -> Self {
        let contrast = finish.contrast();
        Self {
            finish,
            contrast,
            seed,
        }
    }
}

/// A texture, ready to be looked up: bilinear value noise on lattices, and glints.
#[derive(Clone, Debug)]
pub(super) struct Field {
    texture: Texture,
    layers: Vec<Lattice>,
    /// What the logarithm of a specular surface is lowered by, so that its mean is 1.
    lowered: f32,
}

#[derive(Clone, Debug)]
struct Lattice {
    /// Cells in a period, along travel and across.
    cells: [usize; 2],
    weight: f32,
    /// −1…1, row by row along travel.
    values: Vec<f32>,
}

/// Cells of glints in a period: one of [`GLINT_SHARE`] has a glint.
const GLINT_CELLS: [usize; 2] = [294, 147];
const GLINT_SHARE: u64 = 9;

impl Field {
    pub fn new(texture: Texture) -> Self {
        let lattice = |(k, &(along, across, weight)): (usize, &(f64, f64, f64))| {
            let cells = [PERIOD_MM[0] / along, PERIOD_MM[1] / across].map(|n| n.round() as usize);
            let seed = texture.seed.wrapping_mul(8).wrapping_add(k as u64);
            let value = |i: usize| (2.0 * unit(of_place(seed, i / cells[1], i % cells[1])) - 1.0) as f32;
            Lattice {
                cells,
                weight: weight as f32,
                values: (0..cells[0] * cells[1]).map(value).collect(),
            }
        };
        let layers: Vec<Lattice> = texture.finish.layers().iter().enumerate().map(lattice).collect();
        // Variance of value noise: 1/3 on the lattice, 4/9 of it between.
        let variance: f32 = layers.iter().map(|l| l.weight * l.weight).sum::<f32>() * 4.0 / 27.0;
        let lowered = variance * (texture.contrast * texture.contrast) as f32 / 2.0;
        Self {
            texture,
            layers,
            lowered,
        }
    }

    /// The texture it was made of.
    pub fn texture(&self) -> Texture {
        self.texture
    }

    /// Brightness at places along travel, `step` apart from `along` on and no more than a period and a bit \[mm\]:
    /// quicker than one by one.
    pub fn along(&self, along: f64, step: f64, across: f64, out: &mut [f32]) {
        let place = [turn(along, PERIOD_MM[0]), turn(across, PERIOD_MM[1])];
        let step = step / PERIOD_MM[0];
        out.fill(0.0);
        for layer in &self.layers {
            layer.add(place, step, out);
        }
        for (k, out) in out.iter_mut().enumerate() {
            *out = self.brightness(*out);
            if self.texture.finish == Finish::Blasted {
                *out += self.glint([turn(place[0] + k as f64 * step, 1.0), place[1]]);
            }
        }
    }

    /// Brightness at a place on the work \[mm\], 1 on average.
    pub fn at(&self, along: f64, across: f64) -> f32 {
        let place = [turn(along, PERIOD_MM[0]), turn(across, PERIOD_MM[1])];
        let noise: f32 = self.layers.iter().map(|layer| layer.at(place)).sum();
        let brightness = self.brightness(noise);
        if self.texture.finish == Finish::Blasted {
            brightness + self.glint(place)
        } else {
            brightness
        }
    }

    /// Brightness of the surface where the noise of all layers is this.
    fn brightness(&self, noise: f32) -> f32 {
        let noise = noise * self.texture.contrast as f32;
        if self.texture.finish == Finish::Specular {
            (noise - self.lowered).exp()
        } else {
            (1.0 + noise).max(0.02)
        }
    }

    /// What a glint adds: every ninth cell of 24 µm holds one of 3 to 6 µm radius.
    fn glint(&self, place: [f64; 2]) -> f32 {
        let at = [0, 1].map(|k| place[k] * GLINT_CELLS[k] as f64);
        let bits = of_place(!self.texture.seed, at[0] as usize, at[1] as usize);
        if !bits.is_multiple_of(GLINT_SHARE) {
            return 0.0;
        }
        let [x, y, radius, height] = [8, 20, 32, 44].map(|shift| ((bits >> shift) & 0xfff) as f64 / 4096.0);
        let radius = 0.12 + 0.12 * radius;
        let far = |at: f64, middle: f64| at.fract() - radius - (1.0 - 2.0 * radius) * middle;
        let distance = far(at[0], x).hypot(far(at[1], y)) / radius;
        if distance < 1.0 {
            ((0.4 + 1.6 * height) * (1.0 - distance * distance)) as f32
        } else {
            0.0
        }
    }
}

/// Where in a period a place lies, 0 to 1.
fn turn(x: f64, period: f64) -> f64 {
    let turns = x / period;
    // Quicker than `floor`, which is a call on processors that are not told to be new.
    let whole = turns as i64 as f64;
    let rest = turns - whole;
    if rest < 0.0 { rest + 1.0 } else { rest }
}

impl Lattice {
    /// Adds its noise along travel, `step` apart from `place` on, both in periods.
    fn add(&self, place: [f64; 2], step: f64, out: &mut [f32]) {
        let [rows, columns] = self.cells;
        let x = place[1] * columns as f64;
        let j = (x as usize).min(columns - 1);
        let (right, x) = ((j + 1) % columns, (x - j as f64) as f32);
        let (first, step) = (place[0] * rows as f64, step * rows as f64);
        let last = (first + out.len() as f64 * step) as usize + 1;
        let line: Vec<f32> = (0..=last)
            .map(|i| {
                let values = &self.values[i % rows * columns..][..columns];
                (values[j] + (values[right] - values[j]) * x) * self.weight
            })
            .collect();
        let (first, step) = (first as f32, step as f32);
        for (k, out) in out.iter_mut().enumerate() {
            let y = first + step * k as f32;
            let i = (y as usize).min(last - 1);
            *out += line[i] + (line[i + 1] - line[i]) * (y - i as f32);
        }
    }

    fn at(&self, place: [f64; 2]) -> f32 {
        let [rows, columns] = self.cells;
        let (y, x) = (place[0] * rows as f64, place[1] * columns as f64);
        // `place` is below 1, yet rounding may carry the product to the end.
        let (i, j) = (
            (y as u32 as usize).min(rows - 1),
            (x as u32 as usize).min(columns - 1),
        );
        let (y, x) = ((y - i as f64) as f32, (x - j as f64) as f32);
        let below = if i + 1 == rows { 0 } else { i + 1 };
        let right = if j + 1 == columns { 0 } else { j + 1 };
        let between = |row: usize| {
            let values = &self.values[row * columns..][..columns];
            values[j] + (values[right] - values[j]) * x
        };
        let (top, bottom) = (between(i), between(below));
        (top + (bottom - top) * y) * self.weight
    }
}

/// Roughness of an edge at a place along travel, standard deviation 1 (value noise of 25 µm).
pub(super) fn roughness(seed: u64, edge: usize, along: f64) -> f64 {
    const CELLS: f64 = 283.0;
    let turns = along / PERIOD_MM[0];
    let at = (turns - turns.floor()) * CELLS;
    let i = at as usize;
    let value = |i: usize| 2.0 * unit(of_place(!seed, i % CELLS as usize, edge)) - 1.0;
    let between = value(i) + (value(i + 1) - value(i)) * at.fract();
    // Variance of value noise along a line: 1/3 on the lattice, 2/3 of it between.
    between / (2.0f64 / 9.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_holds_what_its_places_hold() {
        for finish in Finish::ALL {
            let field = Field::new(Texture::new(finish, 4));
            for (along, across) in [(-0.7, 0.0), (6.9, 1.9), (3.0, -0.001)] {
                let mut line = vec![0.0; 6000];
                field.along(along, 0.00115, across, &mut line);
                for (k, seen) in line.iter().enumerate() {
                    let wanted = field.at(along + 0.00115 * k as f64, across);
                    assert!(
                        (seen - wanted).abs() < 2e-3,
                        "{finish:?} {k}: {seen} for {wanted}"
                    );
                }
            }
        }
    }
}
