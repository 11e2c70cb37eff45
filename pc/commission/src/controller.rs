//! The frequency response of a position loop's controller, as the board computes it.

use crate::Complex;
use rustfft::algorithm::Radix4;
use rustfft::{Fft, FftDirection};
use shared::control::{LoopFilter, LoopFilterState, MotorConfig};
use shared::parameter::ParameterError;
use shared::protocol::CAPTURE_TICKS;
use shared::ticks::SERVO_PERIOD_S;
use std::f64::consts::TAU;

/// Periods over which an impulse dies away in the filters.
const PERIODS: usize = 8;

/// What the filters of `motor` do to each line of a capture, by their number: the spectrum of their answer to an impulse.
///
/// # Errors
/// A parameter of a filter is out of range.
pub fn filters(motor: &MotorConfig) -> Result<Vec<Complex>, ParameterError> {
    let filter = LoopFilter::build("motor", motor, SERVO_PERIOD_S)?;
    let mut spectrum = vec![Complex::default(); CAPTURE_TICKS];
    if filter.is_off() {
        spectrum.fill(Complex::from(1.0));
        return Ok(spectrum);
    }
    let mut state = LoopFilterState::default();
    for tick in 0..PERIODS * CAPTURE_TICKS {
        let impulse = if tick == 0 { 1.0 } else { 0.0 };
        spectrum[tick % CAPTURE_TICKS] += filter.step(&mut state, impulse);
    }
    Radix4::new(CAPTURE_TICKS, FftDirection::Forward).process(&mut spectrum);
    Ok(spectrum)
}

/// Proportional, integral and derivative part at a frequency \[1/s\], from following error to command: the laws of
/// `shared::control::Pid` with z = exp(jωT).
pub fn pid(motor: &MotorConfig, hz: f64) -> Complex {
    let back = Complex::from_polar(1.0, -TAU * hz * SERVO_PERIOD_S);
    let keep = motor.derivative_filter_s / (motor.derivative_filter_s + SERVO_PERIOD_S);
    let integral = motor.ki * SERVO_PERIOD_S / (1.0 - back);
    let derivative = motor.kd * (1.0 - keep) / SERVO_PERIOD_S * (1.0 - back) / (1.0 - keep * back);
    motor.kp + integral + derivative
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::control::{HomeConfig, NotchConfig, Pid, PidState, Setpoint};
    use shared::motion::Chirp;

    pub fn motor() -> MotorConfig {
        MotorConfig {
            counts_per_unit: 10_000.0,
            velocity_at_10v: 400.0,
            kp: 80.0,
            ki: 900.0,
            integral_limit: 1e6,
            anti_windup_time_s: 0.0,
            kd: 0.02,
            derivative_filter_s: 0.001,
            velocity_feed_forward: 1.0,
            acceleration_feed_forward_s: 0.0,
            notches: Default::default(),
            low_pass: None,
            friction: None,
            max_command: 1e6,
            following_error_base: 1.0,
            following_error_time_s: 0.1,
            vibration_limit: 0.0,
            home_sequence: 0,
            home: HomeConfig {
                velocity: -10.0,
                mark_position: 0.0,
                max_travel: 100.0,
            },
        }
    }

    /// The controller itself, run on a sine until it swings evenly.
    #[test]
    fn it_is_that_of_the_controller_itself() {
        let mut motor = motor();
        let notch = NotchConfig {
            frequency_hz: 80.0,
            damping: 0.4,
            depth: 0.1,
        };
        motor.notches.push(notch).expect("there is room");
        let pid_itself = Pid::build("X", &motor, 1.0, SERVO_PERIOD_S).expect("sound");
        let filters = filters(&motor).expect("sound");
        for line in [5, 20, 41, 60, 200, 450] {
            let omega = TAU * Chirp::LINE_HZ * f64::from(line) * SERVO_PERIOD_S;
            let mut state = PidState::default();
            let mut found = Complex::default();
            for tick in 0..8 * CAPTURE_TICKS {
                let phase = omega * tick as f64;
                let setpoint = Setpoint {
                    position: phase.cos(),
                    ..Setpoint::default()
                };
                let command = pid_itself.step(&mut state, &setpoint, 0.0, 0.0).expect("finite");
                if tick >= 7 * CAPTURE_TICKS {
                    found += command * Complex::from_polar(2.0 / CAPTURE_TICKS as f64, -phase);
                }
            }
            let hz = Chirp::LINE_HZ * f64::from(line);
            let computed = pid(&motor, hz) * filters[line as usize];
            let off = (found - computed).norm() / computed.norm();
            assert!(off < 1e-3, "{hz} Hz: {found} {computed}");
        }
    }
}
