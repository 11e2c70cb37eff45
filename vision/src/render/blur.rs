//! What lens, pixels and travel blur.

use crate::optics::Optics;

/// Lengths of the focal plane at which a camera blurs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    /// Radius of the disc a defocus of 1 becomes: tan(asin NA).
    pub spread: f64,
    /// Standard deviation of the diffraction: 0.21 λ/NA \[mm\].
    pub diffraction_mm: f64,
    /// g \[mm\].
    pub pixel_mm: f64,
}

impl Lens {
    pub fn new(optics: &Optics) -> Self {
        Self {
            spread: optics.aperture.min(0.999).asin().tan(),
            diffraction_mm: 0.21 * optics.wavelength_mm / optics.aperture,
            pixel_mm: optics.object_pixel_mm(),
        }
    }
}

/// Weights of a blur along a line, odd in number, the middle one in place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Kernel(pub Vec<f32>);

impl Kernel {
    /// Boxes of these lengths after a Gaussian of this standard deviation, all in steps of the line.
    pub fn new(deviation: f64, boxes: &[f64]) -> Self {
        let mut weights = gaussian(deviation);
        for &length in boxes {
            weights = convolved(&weights, &even(length));
        }
        Self(weights.iter().map(|&w| w as f32).collect())
    }

    /// How many weights there are on each side of the middle.
    pub fn reach(&self) -> usize {
        self.0.len() / 2
    }
}

/// A box: whole weights inside, parts of one at its ends.
fn even(length: f64) -> Vec<f64> {
    let reach = ((length - 1.0) / 2.0).max(0.0).ceil() as i64;
    let inside = |k: i64| (length / 2.0 - (k.abs() as f64 - 0.5)).clamp(0.0, 1.0);
    normal((-reach..=reach).map(inside).collect())
}

fn gaussian(deviation: f64) -> Vec<f64> {
    if deviation < 0.4 {
        // Too narrow to be sampled: three weights of the same variance.
        let side = deviation * deviation / 2.0;
        return vec![side, 1.0 - 2.0 * side, side];
    }
    let reach = (3.5 * deviation).ceil() as i64;
    normal(
        (-reach..=reach)
            .map(|k| (-0.5 * (k as f64 / deviation).powi(2)).exp())
            .collect(),
    )
}

fn normal(mut weights: Vec<f64>) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    weights
}

fn convolved(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}

/// How wide discs of many radii are in the rows they cover, for radii in steps of an eighth.
#[derive(Clone, Debug, Default)]
pub(super) struct Discs(Vec<Disc>);

/// A disc around the middle of a value.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    /// Half the width in the middle row, the next one and so on, such that the disc's area is kept.
    pub half_widths: Vec<f64>,
    /// The same, as [`Part`]s.
    pub parts: Vec<Part>,
    /// Sum of the widths in all rows.
    pub area: f64,
}

/// How far a row of a disc reaches from the border of its middle value to either side: over whole values and a
/// fraction of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub whole: usize,
    pub fraction: f64,
}

const RADII_A_STEP: f64 = 8.0;

impl Discs {
    /// Sees to it that there are discs up to `radius`.
    pub fn provide(&mut self, radius: f64) {
        let count = (radius * RADII_A_STEP).round() as usize + 1;
        for k in self.0.len()..count {
            self.0.push(Disc::new((k as f64 / RADII_A_STEP).max(0.02)));
        }
    }

    /// The disc of `radius`.
    pub fn of(&self, radius: f64) -> &Disc {
        &self.0[((radius * RADII_A_STEP).round() as usize).min(self.0.len() - 1)]
    }
}

impl Disc {
    fn new(radius: f64) -> Self {
        // Area of a half disc between its middle and y.
        let area = |y: f64| {
            let y = y.clamp(-radius, radius);
            (y * (radius * radius - y * y).max(0.0).sqrt() + radius * radius * (y / radius).asin()) / 2.0
        };
        let rows = (radius - 0.5).max(0.0).ceil() as usize;
        let half_widths: Vec<f64> = (0..=rows)
            .map(|k| area(k as f64 + 0.5) - area(k as f64 - 0.5))
            .collect();
        let part = |half: &f64| Part {
            whole: (half + 0.5) as usize,
            fraction: (half + 0.5).fract(),
        };
        Self {
            parts: half_widths.iter().map(part).collect(),
            area: 2.0 * (2.0 * half_widths.iter().sum::<f64>() - half_widths[0]),
            half_widths,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(weights: &[f64]) -> (f64, f64) {
        let middle = (weights.len() / 2) as f64;
        let variance = weights
            .iter()
            .enumerate()
            .map(|(k, w)| w * (k as f64 - middle).powi(2))
            .sum();
        (weights.iter().sum(), variance)
    }

    #[test]
    fn kernels_are_whole_and_as_wide_as_asked() {
        for (deviation, length) in [(0.2, 3.0), (1.34, 4.0), (0.33, 2.17), (2.0, 1.0)] {
            let kernel = Kernel::new(deviation, &[length]);
            let weights: Vec<f64> = kernel.0.iter().map(|&w| f64::from(w)).collect();
            let (sum, variance) = moments(&weights);
            let wanted = deviation * deviation + length * length / 12.0;
            assert!((sum - 1.0).abs() < 1e-6, "{sum}");
            assert!(
                (variance - wanted).abs() < 0.2,
                "{deviation} {length}: {variance} {wanted}"
            );
        }
    }

    #[test]
    fn discs_keep_their_area_and_spread() {
        let mut discs = Discs::default();
        discs.provide(40.0);
        for radius in [0.5, 1.0, 3.25, 17.5, 40.0] {
            let half = &discs.of(radius).half_widths;
            let rows = |k: usize| if k == 0 { 1.0 } else { 2.0 };
            let area: f64 = half.iter().enumerate().map(|(k, h)| rows(k) * 2.0 * h).sum();
            let disc = std::f64::consts::PI * radius * radius;
            assert!((area / disc - 1.0).abs() < 1e-9, "{radius}: {area} {disc}");
            let along: f64 = half
                .iter()
                .enumerate()
                .map(|(k, h)| rows(k) * 2.0 * h * (k * k) as f64)
                .sum::<f64>()
                / area;
            assert!((along - radius * radius / 4.0).abs() < 0.15, "{radius}: {along}");
        }
    }
}
