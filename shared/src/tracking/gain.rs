//! How much gain a loop with dead time allows (mathematics 0.8.5).

use core::f64::consts::FRAC_PI_2;

/// The crossover where the open loop K·e^(−sT)/(s(τs+1)) has a phase margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossover {
    /// Gain K \[1/s\].
    pub gain: f64,
    /// Angular frequency ω \[rad/s\].
    pub omega: f64,
}

/// Gain of an integrating loop with dead time `delay` T > 0 \[s\] and lag `lag` τ ≥ 0 \[s\] that leaves the phase
/// margin `margin` \[rad\] in 0…π/2: ωT + atan(ωτ) = π/2 − margin, K = ω√(1+ω²τ²). With margin 0 this is the
/// stability limit.
pub fn crossover(delay: f64, lag: f64, margin: f64) -> Crossover {
    let phase = FRAC_PI_2 - margin;
    // The phase grows with ω; it is above `phase` at the upper end, which a lag of zero would reach.
    let (mut low, mut high) = (0.0, phase / delay);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle * delay + libm::atan(middle * lag) < phase {
            low = middle;
        } else {
            high = middle;
        }
    }
    let omega = high;
    Crossover {
        gain: omega * libm::sqrt(1.0 + omega * omega * lag * lag),
        omega,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    #[test]
    fn a_pure_delay_has_its_limit_at_a_quarter_period() {
        let limit = crossover(0.01, 0.0, 0.0);
        assert!((limit.gain - 50.0 * PI).abs() < 1e-9);
    }

    #[test]
    fn the_open_loop_with_a_lag_has_unit_gain_and_the_margin_at_the_crossover() {
        let (delay, lag, margin) = (0.012, 0.03, 50f64.to_radians());
        let Crossover { gain, omega } = crossover(delay, lag, margin);
        let magnitude = gain / (omega * (1.0 + (omega * lag).powi(2)).sqrt());
        let phase = -PI / 2.0 - omega * delay - (omega * lag).atan();
        assert!((magnitude - 1.0).abs() < 1e-12, "{magnitude}");
        assert!((phase + PI - margin).abs() < 1e-12, "{phase}");
    }
}
