//! Filter sections of second order: notch and low-pass, by the bilinear transform with the corner where it was asked for
//! (mathematics 0.10).
//!
//! The crate `biquad` keeps coefficients and state in one structure, and its notch has no depth.

use crate::parameter::{ParameterError, check, positive, within};
use core::f64::consts::PI;

/// Coefficients of one section, a0 being 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Biquad {
    b0: f64,
    b1: f64,
    b2: f64,
    a1: f64,
    a2: f64,
}

/// Memory of a [`Biquad`], as the transposed direct form II has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BiquadState {
    s1: f64,
    s2: f64,
}

/// Names of the parameters of a section in the machine file.
pub(super) struct Names {
    pub frequency: &'static str,
    pub damping: &'static str,
}

/// Frequency and damping of both poles, as they are used.
struct Poles {
    /// tan(π·f·T).
    k: f64,
    damping: f64,
}

impl Poles {
    fn build(
        owner: &str,
        names: &Names,
        frequency_hz: f64,
        damping: f64,
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let nyquist = 0.5 / positive(owner, "period_s", period_s)?;
        let frequency = within(owner, names.frequency, frequency_hz, 0.0..=nyquist)?;
        let frequency = check(owner, names.frequency, frequency, |hz| hz > 0.0 && hz < nyquist)?;
        Ok(Self {
            k: libm::tan(PI * frequency * period_s),
            damping: positive(owner, names.damping, damping)?,
        })
    }

    /// The section with the numerator n0 + n1·z⁻¹ + n2·z⁻².
    fn under(&self, n0: f64, n1: f64, n2: f64) -> Biquad {
        let (k, square) = (2.0 * self.damping * self.k, self.k * self.k);
        let scale = 1.0 / (1.0 + k + square);
        Biquad {
            b0: n0 * scale,
            b1: n1 * scale,
            b2: n2 * scale,
            a1: 2.0 * (square - 1.0) * scale,
            a2: (1.0 - k + square) * scale,
        }
    }
}

impl Biquad {
    /// (s² + 2·depth·ζ·ω·s + ω²)/(s² + 2ζω·s + ω²): the gain is `depth` at `frequency_hz`, and 1 far from it.
    pub fn notch(
        owner: &str,
        names: &Names,
        (frequency_hz, damping, depth): (f64, f64, f64),
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let poles = Poles::build(owner, names, frequency_hz, damping, period_s)?;
        let (k, square) = (2.0 * depth * poles.damping * poles.k, poles.k * poles.k);
        Ok(poles.under(1.0 + k + square, 2.0 * (square - 1.0), 1.0 - k + square))
    }

    /// ω²/(s² + 2ζω·s + ω²).
    pub fn low_pass(
        owner: &str,
        names: &Names,
        (frequency_hz, damping): (f64, f64),
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let poles = Poles::build(owner, names, frequency_hz, damping, period_s)?;
        let square = poles.k * poles.k;
        Ok(poles.under(square, 2.0 * square, square))
    }

    /// What comes out for `input`.
    pub fn step(&self, state: &mut BiquadState, input: f64) -> f64 {
        let output = self.b0 * input + state.s1;
        state.s1 = self.b1 * input - self.a1 * output + state.s2;
        state.s2 = self.b2 * input - self.a2 * output;
        output
    }
}
