//! Vibration of a motor: that part of its following error which is quicker than motion along a path makes it.

use micromath::F32Ext;

/// The mean that is taken off follows an error by this part in a millisecond: what is left are frequencies above 10 Hz.
const SLOW: f32 = 1.0 / 16.0;
/// Part of one new square in the mean of the squares: about a second counts.
const WEIGHT: f32 = 1.0 / 1024.0;
/// No error counts for more than so many times the limit: so a swing has to last 0.3 s to be above it, however large it is. What a
/// hard start or stop leaves of itself is gone before.
const MOST: f32 = 2.0;

/// Root mean square of a motor's following error above 10 Hz (mm or rad), and the highest so far. Single precision is good enough here and
/// nowhere else, and for what is told of it the root of micromath, which is off by per cents; the limit is compared without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    slow: f32,
    mean_square: f32,
    highest: f32,
}

impl Vibration {
    /// Stillness.
    pub const NONE: Self = Self {
        slow: 0.0,
        mean_square: 0.0,
        highest: 0.0,
    };

    /// Takes the following error of a millisecond, with its sign, of a motor with this `limit`, above 0.
    pub fn add(&mut self, error: f64, limit: f32) {
        let error = error as f32;
        self.slow += SLOW * (error - self.slow);
        let quick = (error - self.slow).clamp(-MOST * limit, MOST * limit);
        self.mean_square += WEIGHT * (quick * quick - self.mean_square);
        self.highest = self.highest.max(self.mean_square);
    }

    /// Begins anew, as the motor does not follow meanwhile; the highest stays.
    pub fn rest(&mut self) {
        *self = Self {
            highest: self.highest,
            ..Self::NONE
        };
    }

    /// Whether it is more than `limit`.
    pub fn exceeds(&self, limit: f32) -> bool {
        self.mean_square > limit * limit
    }

    /// What it is now.
    pub fn level(&self) -> f32 {
        F32Ext::sqrt(self.mean_square)
    }

    /// The highest so far.
    pub fn highest(&self) -> f32 {
        F32Ext::sqrt(self.highest)
    }
}

#[cfg(test)]
mod tests {
    use super::Vibration;
    use core::f64::consts::TAU;

    const LIMIT: f32 = 0.01;

    /// After `ms` of a sine with this `amplitude` \[mm\].
    fn shaken(amplitude: f64, hz: f64, ms: u32) -> Vibration {
        let mut vibration = Vibration::NONE;
        for ms in 0..ms {
            vibration.add(amplitude * libm::sin(TAU * hz * 1e-3 * f64::from(ms)), LIMIT);
        }
        vibration
    }

    #[test]
    fn a_sine_above_the_corner_counts_whole_and_one_below_it_hardly() {
        for hz in [80.0, 200.0, 470.0] {
            let seen = shaken(0.01, hz, 5000).level() / 0.007_071;
            assert!((0.9..1.1).contains(&seen), "{hz} Hz: {seen}");
        }
        let seen = shaken(0.01, 1.0, 5000).level() / 0.007_071;
        assert!(seen < 0.15, "{seen}");
    }

    #[test]
    fn a_swing_exceeds_its_limit_when_it_has_lasted_and_is_forgotten_at_rest() {
        for amplitude in [0.05, 1.0] {
            assert!(!shaken(amplitude, 80.0, 250).exceeds(LIMIT), "{amplitude}");
        }
        let mut vibration = shaken(0.05, 80.0, 450);
        assert!(vibration.exceeds(LIMIT));
        vibration.rest();
        assert!(!vibration.exceeds(1e-6) && vibration.highest() > LIMIT);
        // 0.0092 mm rms.
        assert!(!shaken(0.013, 80.0, 60_000).exceeds(LIMIT));
        assert!(shaken(0.016, 80.0, 5000).exceeds(LIMIT));
    }
}
