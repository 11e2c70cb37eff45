//! Random numbers that are the same in every run and on every target (SplitMix64).

use nalgebra::Vector3;

/// The state.
pub struct Random(pub u64);

impl Random {
    /// Uniform in low…high.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 31;
        low + (high - low) * (x >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A vector with components in ±`size`.
    pub fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.within(-size, size))
    }
}
