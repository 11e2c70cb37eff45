//! A level meter for the following error, for display only: no controller acts on it.

use micromath::F32Ext;

/// Weight of one new peak in the mean.
const WEIGHT: f32 = 0.02;
/// Levels below one nanometre (or nanoradian) are silence.
const FLOOR_UM: f32 = 1e-3;

/// Smoothed square of a motor's peak following error. The rough, fast arithmetic of micromath is good enough
/// here and nowhere else: its figures are off by per cents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    mean_square_um2: f32,
}

impl Vibration {
    /// Silence.
    pub const NONE: Self = Self { mean_square_um2: 0.0 };

    /// Adds the peak |following error| of a millisecond (mm or rad).
    pub fn add(&mut self, peak: f64) {
        let peak_um = (peak * 1000.0) as f32;
        self.mean_square_um2 += WEIGHT * (peak_um * peak_um - self.mean_square_um2);
    }

    /// log2 of the smoothed error in µm (or mrad): one more is twice as loud.
    pub fn level(&self) -> f32 {
        F32Ext::log2(F32Ext::sqrt(self.mean_square_um2).max(FLOOR_UM))
    }
}

#[cfg(test)]
mod tests {
    use super::Vibration;

    #[test]
    fn twice_the_error_is_about_one_level_more() {
        let level = |peak_mm: f64| {
            let mut vibration = Vibration::NONE;
            (0..1000).for_each(|_| vibration.add(peak_mm));
            vibration.level()
        };
        assert!((level(0.004) - 2.0).abs() < 0.2, "{}", level(0.004));
        assert!((level(0.008) - level(0.004) - 1.0).abs() < 0.2);
        assert!(level(0.0) < -9.0);
    }
}
