//! Conversions at the edge, and the few scalar functions every part needs.

use core::f64::consts::PI;

/// Degrees in one radian.
pub const DEG_PER_RAD: f64 = 180.0 / PI;
/// mm/s in one m/min.
pub const MM_S_PER_M_MIN: f64 = 1000.0 / 60.0;

/// Reduces an angle to (−π, π]. `angle` in rad.
pub fn wrap(angle: f64) -> f64 {
    let turns = libm::ceil((angle - PI) / (2.0 * PI));
    angle - turns * 2.0 * PI
}

/// `angle` plus as many turns as bring it next to `near`, within half a turn \[rad\].
pub fn next_to(angle: f64, near: f64) -> f64 {
    near + wrap(angle - near)
}

/// Rounds to the nearest integer, halves away from zero (mathematics C).
pub fn round_half_away(x: f64) -> f64 {
    libm::copysign(libm::floor(libm::fabs(x) + 0.5), x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrap_keeps_plus_pi_and_folds_minus_pi() {
        assert_eq!(wrap(PI), PI);
        assert_eq!(wrap(-PI), PI);
        assert!((wrap(7.0) - (7.0 - 2.0 * PI)).abs() < 1e-15);
    }

    #[test]
    fn an_angle_comes_next_to_another_over_any_number_of_turns() {
        let turn = 2.0 * PI;
        assert!((next_to(-3.0, 3.0) - (turn - 3.0)).abs() < 1e-14);
        assert!((next_to(0.1, -5.0 * turn) - (0.1 - 5.0 * turn)).abs() < 1e-14);
    }

    #[test]
    fn halves_round_away_from_zero() {
        assert_eq!(round_half_away(2.5), 3.0);
        assert_eq!(round_half_away(-2.5), -3.0);
        assert_eq!(round_half_away(0.49), 0.0);
    }
}
