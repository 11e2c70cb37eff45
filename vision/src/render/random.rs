//! Numbers that look random and can be repeated, in a row and by place.

/// SplitMix64 (mathematics 0.9). It is small, and unlike a crate's generators its numbers never change:
/// a picture is named by its seed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64(u64);

/// What a step of SplitMix64 adds to its state.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// Its scrambler.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A number that belongs to the place `i`, `j` of the pattern `seed`.
pub(super) fn of_place(seed: u64, i: usize, j: usize) -> u64 {
    mix(mix(seed.wrapping_add(STEP.wrapping_mul(i as u64 + 1))).wrapping_add(STEP.wrapping_mul(j as u64 + 1)))
}

/// 0 ≤ x < 1 out of 64 bits.
pub(super) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

impl SplitMix64 {
    /// Starts at `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        mix(self.0)
    }

    /// 0 ≤ x < 1.
    pub fn uniform(&mut self) -> f64 {
        unit(self.bits())
    }

    /// low ≤ x < high.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// low ≤ x < high, evenly in its logarithm.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// True in `share` of the cases.
    pub fn chance(&mut self, share: f64) -> bool {
        self.uniform() < share
    }

    /// Two normally distributed numbers, mean 0, standard deviation 1.
    pub fn gauss(&mut self) -> [f64; 2] {
        let (size, angle) = (1.0 - self.uniform(), std::f64::consts::TAU * self.uniform());
        let size = (-2.0 * size.ln()).sqrt();
        [size * angle.cos(), size * angle.sin()]
    }

    /// A count that is `mean` on average (Poisson); from 40 on the normal distribution stands for it.
    pub fn count(&mut self, mean: f64) -> f64 {
        if mean >= 40.0 {
            return (mean + mean.sqrt() * self.gauss()[0]).max(0.0);
        }
        let limit = (-mean).exp();
        let (mut product, mut count) = (self.uniform(), 0.0);
        while product > limit {
            product *= self.uniform();
            count += 1.0;
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_numbers_are_those_of_the_published_generator() {
        let mut random = SplitMix64::new(1_234_567);
        assert_eq!(random.bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn counts_have_their_mean_as_variance() {
        let mut random = SplitMix64::new(3);
        for mean in [0.5, 12.0, 39.0, 41.0, 900.0] {
            let counts: Vec<f64> = (0..20_000).map(|_| random.count(mean)).collect();
            let seen = counts.iter().sum::<f64>() / 20_000.0;
            let variance = counts.iter().map(|c| (c - seen).powi(2)).sum::<f64>() / 20_000.0;
            assert!(
                (seen - mean).abs() < 5.0 * (mean / 20_000.0).sqrt(),
                "{mean}: mean {seen}"
            );
            assert!(
                (variance / mean - 1.0).abs() < 0.06,
                "{mean}: variance {variance}"
            );
        }
    }
}
