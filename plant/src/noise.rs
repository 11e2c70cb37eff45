//! Noise that is the same in every run.

/// Uniform noise of mean 0 and standard deviation 1 (xorshift of Marsaglia, 32 bits).
#[derive(Clone, Debug, PartialEq)]
pub struct Noise(u32);

impl Noise {
    /// From any `seed`; streams of a machine differ by their `stream`.
    pub fn new(seed: u32, stream: u32) -> Self {
        // Any odd multiplier spreads neighbouring seeds; 0 is the one state that xorshift does not leave.
        let mixed = seed
            .wrapping_add(stream.wrapping_mul(0x9e37_79b9))
            .wrapping_mul(0x85eb_ca6b);
        Self(mixed | 1)
    }

    /// The next value.
    pub fn draw(&mut self) -> f64 {
        const SQRT_3: f64 = 1.732_050_807_568_877_2;
        let mut x = self.0;
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        self.0 = x;
        (f64::from(x) / f64::from(u32::MAX) * 2.0 - 1.0) * SQRT_3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_mean_is_0_its_deviation_1_and_streams_differ() {
        for seed in 0..20 {
            let (mut one, mut other) = (Noise::new(seed, 0), Noise::new(seed, 1));
            let (mut sum, mut squares, mut products) = (0.0, 0.0, 0.0);
            const N: u32 = 10_000;
            for _ in 0..N {
                let (a, b) = (one.draw(), other.draw());
                sum += a;
                squares += a * a;
                products += a * b;
            }
            let n = f64::from(N);
            // Five standard deviations of each.
            assert!((sum / n).abs() < 0.05, "{seed}: {}", sum / n);
            assert!((squares / n - 1.0).abs() < 0.05, "{seed}: {}", squares / n);
            assert!((products / n).abs() < 0.05, "{seed}: {}", products / n);
        }
    }
}
