//! How a surface looks close up: a periodic field of random brightness.

use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// Texels a side of the field, and their size \[mm\].
const TEXELS: usize = 1024;
const TEXEL_MM: f64 = 0.004;

/// A field with a mean of 1.
#[derive(Clone, Debug)]
pub struct Texture {
    texels: Vec<f32>,
}

/// One layer of a texture: how coarse it is along and across the seam \[mm\], and its standard deviation.
#[derive(Clone, Copy, Debug)]
pub struct Grain {
    /// Along the seam \[mm\].
    pub along_mm: f64,
    /// Across it \[mm\].
    pub across_mm: f64,
    /// Standard deviation of the brightness.
    pub contrast: f64,
}

impl Texture {
    /// The sum of `grains`; with `glints` the exponential of it, which has bright spots.
    pub fn new(grains: &[Grain], glints: bool, seed: u64) -> Self {
        let mut random = SmallRng::seed_from_u64(seed);
        let mut field = vec![0.0f32; TEXELS * TEXELS];
        for grain in grains {
            add(&mut field, grain, &mut random);
        }
        let count = field.len() as f64;
        for value in &mut field {
            *value = if glints { value.exp() } else { 1.0 + *value };
        }
        let mean = field.iter().map(|x| f64::from(*x)).sum::<f64>() / count;
        let scale = (1.0 / mean) as f32;
        field.iter_mut().for_each(|x| *x = (*x * scale).max(0.02));
        Self { texels: field }
    }

    /// Brightness at a place of the surface \[mm\].
    pub fn at(&self, along_mm: f64, across_mm: f64) -> f64 {
        let wrap = |x: f64| {
            let x = x / TEXEL_MM;
            let floor = x.floor();
            (
                (floor as i64).rem_euclid(TEXELS as i64) as usize,
                (x - floor) as f32,
            )
        };
        let ((i, di), (j, dj)) = (wrap(along_mm), wrap(across_mm));
        let texel = |i: usize, j: usize| self.texels[(i % TEXELS) * TEXELS + j % TEXELS];
        let row = |i: usize| texel(i, j) * (1.0 - dj) + texel(i, j + 1) * dj;
        f64::from(row(i) * (1.0 - di) + row(i + 1) * di)
    }
}

/// Adds white noise that is smoothed twice by boxes of the grain's size, which is close to a Gaussian.
fn add(field: &mut [f32], grain: &Grain, random: &mut SmallRng) {
    let mut noise: Vec<f32> = (0..field.len()).map(|_| random.random::<f32>() - 0.5).collect();
    let width = |mm: f64| ((mm / TEXEL_MM).round() as usize).clamp(1, TEXELS / 4);
    for _ in 0..2 {
        smooth(&mut noise, width(grain.across_mm), 1);
        smooth(&mut noise, width(grain.along_mm), TEXELS);
    }
    let power = noise.iter().map(|x| f64::from(x * x)).sum::<f64>() / noise.len() as f64;
    let gain = (grain.contrast / power.sqrt()) as f32;
    field.iter_mut().zip(&noise).for_each(|(sum, x)| *sum += gain * x);
}

/// Mean of `width` neighbours, along lines of texels that are `stride` apart.
fn smooth(field: &mut [f32], width: usize, stride: usize) {
    if width == 1 {
        return;
    }
    let across = if stride == 1 { TEXELS } else { 1 };
    let mut line = vec![0.0f32; TEXELS];
    for start in 0..TEXELS {
        let at = |k: usize| start * across + k * stride;
        (0..TEXELS).for_each(|k| line[k] = field[at(k)]);
        let mut sum: f32 = line[..width].iter().sum();
        for k in 0..TEXELS {
            field[at(k)] = sum / width as f32;
            sum += line[(k + width) % TEXELS] - line[k];
        }
    }
}
