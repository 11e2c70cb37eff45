//! Energy of a texture over depth.

use std::iter::Sum;

/// Bins over the depth, and how many of them are one expected width of the profile.
const BINS: usize = 24;
const PER_WIDTH: f64 = 8.0;

/// The width is looked for within so many times the expected one, in so many halvings.
const WITHIN: f64 = 4.0;
const HALVINGS: usize = 40;

/// Steps that find the amplitude.
const STEPS: usize = 12;

/// Mean energies and noise of cells, by their depth.
#[derive(Clone, Debug)]
pub(super) struct Fading {
    /// Expected width s of the profile \[mm\].
    expected_mm: f64,
    bins: [Bin; BINS],
}

/// Sums over cells of about the same depth.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    cells: f64,
    depth_mm: f64,
    energy: f64,
    noise: f64,
}

impl Fading {
    /// Without cells.
    pub fn new(expected_mm: f64) -> Self {
        Self {
            expected_mm,
            bins: [Bin::default(); BINS],
        }
    }

    /// Adds a cell at a depth \[mm\]; one without a say, or far out of focus, does not count.
    pub fn add(&mut self, depth_mm: f64, energy: f32, noise: f32) {
        let depth_mm = depth_mm.abs();
        let bin = self
            .bins
            .get_mut((depth_mm * PER_WIDTH / self.expected_mm) as usize);
        if let Some(bin) = bin.filter(|_| noise < 1.0) {
            bin.cells += 1.0;
            bin.depth_mm += depth_mm;
            bin.energy += f64::from(energy);
            bin.noise += f64::from(noise);
        }
    }

    /// Width s of the profile that fits the energies best \[mm\]: the likeliest one if energies scatter by as much as
    /// they are on average.
    pub fn width_mm(&self) -> f64 {
        let misfit = |width_mm: f64| self.misfit(width_mm);
        let (mut low, mut high) = (self.expected_mm / WITHIN, self.expected_mm * WITHIN);
        for _ in 0..HALVINGS {
            // Two places a third from either end, in the logarithm.
            let third = (high / low).powf(1.0 / 3.0);
            if misfit(low * third) < misfit(high / third) {
                high /= third;
            } else {
                low *= third;
            }
        }
        (low * high).sqrt()
    }

    /// Σ (ln P + E/P), P = A·T + noise with the best amplitude A.
    fn misfit(&self, width_mm: f64) -> f64 {
        let heard = || self.bins.iter().filter(|bin| bin.cells > 0.0);
        let profile = |bin: &Bin| (1.0 + (bin.depth_mm / bin.cells / width_mm).powi(2)).powf(-1.5);
        let mut amplitude = heard().map(|bin| bin.energy / bin.cells).fold(0.0, f64::max);
        for _ in 0..STEPS {
            let (mut score, mut information) = (0.0, 0.0);
            for bin in heard() {
                let t = profile(bin);
                let expected = amplitude * t + bin.noise / bin.cells;
                score += t * (bin.energy - bin.cells * expected) / (expected * expected);
                information += bin.cells * (t / expected).powi(2);
            }
            if information > 0.0 {
                amplitude = (amplitude + score / information).max(0.1 * amplitude);
            }
        }
        let misfit = |bin: &Bin| {
            let expected = amplitude * profile(bin) + bin.noise / bin.cells;
            bin.cells * expected.ln() + bin.energy / expected
        };
        heard().map(misfit).sum()
    }
}

impl<'a> Sum<&'a Self> for Fading {
    fn sum<I: Iterator<Item = &'a Self>>(all: I) -> Self {
        let add = |mut sum: Self, one: &Self| {
            for (sum, one) in sum.bins.iter_mut().zip(&one.bins) {
                sum.cells += one.cells;
                sum.depth_mm += one.depth_mm;
                sum.energy += one.energy;
                sum.noise += one.noise;
            }
            sum.expected_mm = one.expected_mm;
            sum
        };
        all.fold(Self::new(0.0), add)
    }
}
