//! How far a loop is from where it would swing.

use crate::Complex;

/// Margins of an open loop that is stable by itself but for integrators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// By so much the gain may grow \[dB\].
    pub gain_db: f64,
    /// The frequency at which it would swing then \[Hz\], if there is one.
    pub gain_hz: Option<f64>,
    /// By so much the phase may fall where the gain is 1 \[°\].
    pub phase_deg: f64,
    /// The frequency at which it would swing then \[Hz\], if there is one.
    pub phase_hz: Option<f64>,
    /// Peak of the sensitivity 1/(1 + L): by so much the loop makes some errors larger.
    pub peak: f64,
    /// Highest frequency at which the gain is 1 \[Hz\]; 0 if it never is.
    pub crossover_hz: f64,
}

impl Margins {
    /// Of an open loop at frequencies \[Hz\], upwards; between two of them it goes straight.
    pub fn of(open_loop: &[(f64, Complex)]) -> Self {
        let mut margins = Self {
            gain_db: f64::INFINITY,
            gain_hz: None,
            phase_deg: f64::INFINITY,
            phase_hz: None,
            peak: 0.0,
            crossover_hz: 0.0,
        };
        for (_, value) in open_loop {
            margins.peak = margins.peak.max(1.0 / (1.0 + value).norm());
        }
        for pair in open_loop.windows(2) {
            let ((f0, from), (f1, to)) = (pair[0], pair[1]);
            let at = |part: f64| (f0 + part * (f1 - f0), from + (to - from) * part);
            if from.im.signum() != to.im.signum() {
                let (hz, value) = at(from.im / (from.im - to.im));
                let gain_db = -20.0 * value.norm().log10();
                // To the right of 0 it crosses the axis without harm.
                if value.re < 0.0 && gain_db < margins.gain_db {
                    (margins.gain_db, margins.gain_hz) = (gain_db, Some(hz));
                }
            }
            let (before, after) = (from.norm() - 1.0, to.norm() - 1.0);
            if before.signum() != after.signum() {
                let (hz, value) = at(before / (before - after));
                let phase_deg = (-value).arg().to_degrees();
                if phase_deg < margins.phase_deg {
                    (margins.phase_deg, margins.phase_hz) = (phase_deg, Some(hz));
                }
                margins.crossover_hz = margins.crossover_hz.max(hz);
            }
        }
        margins
    }

    /// The lesser ones of both; the crossover is that of `self`.
    #[must_use]
    pub fn or_worse(self, other: &Self) -> Self {
        let gain = if other.gain_db < self.gain_db {
            other
        } else {
            &self
        };
        let phase = if other.phase_deg < self.phase_deg {
            other
        } else {
            &self
        };
        Self {
            gain_db: gain.gain_db,
            gain_hz: gain.gain_hz,
            phase_deg: phase.phase_deg,
            phase_hz: phase.phase_hz,
            peak: self.peak.max(other.peak),
            crossover_hz: self.crossover_hz,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn sampled(of: impl Fn(f64) -> Complex) -> Vec<(f64, Complex)> {
        (1..200_000)
            .map(|k| f64::from(k) * 0.005)
            .map(|hz| (hz, of(TAU * hz)))
            .collect()
    }

    /// An integrator with dead time has both margins in closed form.
    #[test]
    fn those_of_an_integrator_with_dead_time_are_as_computed() {
        let (gain, dead) = (100.0, 0.004);
        let open = sampled(|omega| Complex::from_polar(gain / omega, -FRAC_PI_2 - omega * dead));
        let margins = Margins::of(&open);
        let phase = 90.0 - (gain * dead).to_degrees();
        assert!((margins.phase_deg - phase).abs() < 0.01, "{margins:?}");
        let crosses = FRAC_PI_2 / dead;
        let in_db = 20.0 * (crosses / gain).log10();
        assert!((margins.gain_db - in_db).abs() < 0.01, "{margins:?} {in_db}");
        assert!((margins.crossover_hz - gain / TAU).abs() < 0.01, "{margins:?}");
        let near = |found: Option<f64>, hz: f64| found.is_some_and(|found| (found - hz).abs() < 1e-3);
        assert!(near(margins.gain_hz, crosses / TAU), "{margins:?}");
        assert!(near(margins.phase_hz, gain / TAU), "{margins:?}");
    }

    /// (s + 1)⁻³ · k swings by itself at k = 8.
    #[test]
    fn a_loop_that_swings_has_none() {
        let open = |k: f64| sampled(move |omega| k / Complex::new(1.0, omega).powi(3));
        let margins = Margins::of(&open(4.0));
        assert!((margins.gain_db - 6.02).abs() < 0.05, "{margins:?}");
        assert!(Margins::of(&open(10.0)).gain_db < 0.0);
        assert!(Margins::of(&open(10.0)).phase_deg < 0.0);
        assert!(Margins::of(&open(7.9)).peak > 50.0);
    }
}
