//! Trips: what makes a servo loop stop the machine (mathematics 0.10).

use super::MotorConfig;
use crate::parameter::{ParameterError, check, not_negative, positive};
use crate::state::Fault;

/// Following-error trip |e| > e0 + |v|·t of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowingTrip {
    motor: u8,
    base: f64,
    time: f64,
    /// µm or millidegrees in one internal unit.
    report: f64,
}

impl FollowingTrip {
    /// Checks the trip of motor number `motor` with the name `owner`, whose unit (mm or degree) is `unit`
    /// internal ones.
    pub fn build(motor: u8, owner: &str, config: &MotorConfig, unit: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            motor,
            base: positive(owner, "following_error_base", config.following_error_base)? * unit,
            time: not_negative(owner, "following_error_time_s", config.following_error_time_s)?,
            report: 1e3 / unit,
        })
    }

    /// The fault if `error` (reference − position) is too large at reference velocity `velocity`, or not a
    /// number (mm or rad, s).
    pub fn check(&self, error: f64, velocity: f64) -> Result<(), Fault> {
        let limit = self.base + libm::fabs(velocity) * self.time;
        if libm::fabs(error) <= limit {
            return Ok(());
        }
        Err(Fault::FollowingError {
            motor: self.motor,
            seen_um: (libm::fabs(error) * self.report) as f32,
            limit_um: (limit * self.report) as f32,
        })
    }
}

/// Finds a grating that counts further in one tick than its motor can go: 1.5 × the largest command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderCheck {
    motor: u8,
    limit: i32,
}

impl EncoderCheck {
    /// Checks the scale of motor number `motor` with the name `owner`; called every `period_s` \[s\].
    pub fn build(
        motor: u8,
        owner: &str,
        config: &MotorConfig,
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let scale = check(owner, "counts_per_unit", config.counts_per_unit, |c| c != 0.0)?;
        let speed = positive(owner, "max_command", config.max_command)?;
        let period = positive(owner, "period_s", period_s)?;
        let counts = libm::ceil(libm::fabs(scale) * speed * period * 1.5);
        Ok(Self {
            motor,
            limit: counts as i32,
        })
    }

    /// The fault if the grating went from `last` to `now` counts in one tick.
    pub fn check(&self, last: i64, now: i64) -> Result<(), Fault> {
        if now.abs_diff(last) <= self.limit.unsigned_abs().into() {
            return Ok(());
        }
        let step = now.saturating_sub(last);
        Err(Fault::EncoderStep {
            motor: self.motor,
            seen: step.clamp(i32::MIN.into(), i32::MAX.into()) as i32,
            limit: self.limit,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::HomeConfig;
    use crate::units::DEG_PER_RAD;

    fn motor() -> MotorConfig {
        MotorConfig {
            counts_per_unit: -10_000.0,
            velocity_at_10v: 150.0,
            kp: 100.0,
            ki: 0.0,
            integral_limit: 0.0,
            anti_windup_time_s: 0.0,
            kd: 0.0,
            derivative_filter_s: 0.0,
            velocity_feed_forward: 1.0,
            acceleration_feed_forward_s: 0.0,
            notches: heapless::Vec::new(),
            low_pass: None,
            friction: None,
            max_command: 120.0,
            following_error_base: 0.1,
            following_error_time_s: 0.05,
            vibration_limit: 0.0,
            home_sequence: 0,
            home: HomeConfig {
                velocity: 1.0,
                mark_position: 0.0,
                max_travel: 1.0,
            },
        }
    }

    #[test]
    fn the_following_error_trip_grows_with_speed_and_reports_millidegrees() {
        let trip = FollowingTrip::build(4, "A", &motor(), 1.0 / DEG_PER_RAD).unwrap();
        let degrees = |x: f64| x / DEG_PER_RAD;
        assert_eq!(trip.check(degrees(0.0999), 0.0), Ok(()));
        assert_eq!(trip.check(degrees(-5.0999), degrees(-100.0)), Ok(()));
        assert_eq!(
            trip.check(degrees(-5.11), degrees(100.0)),
            Err(Fault::FollowingError {
                motor: 4,
                seen_um: 5110.0,
                limit_um: 5100.0
            })
        );
        assert!(trip.check(f64::NAN, 0.0).is_err());
    }

    #[test]
    fn a_grating_may_go_one_and_a_half_times_as_far_as_its_motor() {
        // 120 °/s × 10 000 /° × 0.25 ms × 1.5 = 450 counts.
        let check = EncoderCheck::build(4, "A", &motor(), 0.000_25).unwrap();
        assert_eq!(check.check(-5_000_000_000, -5_000_000_450), Ok(()));
        assert_eq!(
            check.check(0, 451),
            Err(Fault::EncoderStep {
                motor: 4,
                seen: 451,
                limit: 450
            })
        );
        assert!(check.check(i64::MIN, i64::MAX).is_err());
    }
}
