//! The position loop, tick by tick.

use shared::control::{HomeConfig, MotorConfig, Pid, PidState, Setpoint};

const PERIOD_S: f64 = 250e-6;

/// Gains that make each term easy to count: kp 10, ki 100, anti-windup in 5 ms, limit 4 mm/s.
fn pid(kd: f64) -> Pid {
    let config = MotorConfig {
        kp: 10.0,
        ki: 100.0,
        integral_limit: 50.0,
        anti_windup_time_s: 0.005,
        kd,
        derivative_filter_s: 0.0,
        velocity_feed_forward: 0.0,
        acceleration_feed_forward_s: 0.0,
        notches: heapless::Vec::new(),
        low_pass: None,
        friction: None,
        max_command: 4.0,
        counts_per_unit: 10_000.0,
        velocity_at_10v: 400.0,
        following_error_base: 1.0,
        following_error_time_s: 0.05,
        vibration_limit: 0.0,
        home_sequence: 0,
        home: HomeConfig {
            velocity: 10.0,
            mark_position: 0.0,
            max_travel: 100.0,
        },
    };
    Pid::build("Y", &config, 1.0, PERIOD_S).unwrap()
}

fn at(position: f64) -> Setpoint {
    Setpoint {
        position,
        ..Setpoint::default()
    }
}

#[test]
fn one_input_that_is_not_finite_is_refused_and_changes_nothing() {
    let pid = pid(0.0);
    let mut state = PidState::default();
    pid.step(&mut state, &at(0.1), 0.0, 0.0).unwrap();
    let before = state;
    for bad in [f64::NAN, f64::INFINITY] {
        for (setpoint, position, extra) in [(bad, 0.0, 0.0), (0.0, bad, 0.0), (0.0, 0.0, bad)] {
            assert!(pid.step(&mut state, &at(setpoint), position, extra).is_err());
            assert_eq!(state, before, "{setpoint} {position} {extra}");
        }
    }
}

#[test]
fn what_the_limit_cuts_off_unwinds_the_integral() {
    let pid = pid(0.0);
    let mut state = PidState::default();
    // 1 mm off: 10 mm/s and 0.025 of the integral are wanted, 4 are given, so 6.025 are too much.
    assert_eq!(pid.step(&mut state, &at(1.0), 0.0, 0.0), Ok(4.0));
    // The next integral is 0.025 + 0.00025·(100·0.2 − 6.025/0.005) = −0.271 25, beside 10·0.2.
    let command = pid.step(&mut state, &at(0.2), 0.0, 0.0).unwrap();
    assert!((command - (2.0 - 0.271_25)).abs() < 1e-12, "{command}");
}

#[test]
fn an_error_that_grows_is_answered_by_its_derivative() {
    let pid = pid(0.001);
    let mut state = PidState::default();
    pid.step(&mut state, &at(0.0), 0.0, 0.0).unwrap();
    // 0.1 mm in a tick are 400 mm/s: 0.4 of the derivative beside 1.0 and 0.0025.
    let command = pid.step(&mut state, &at(0.1), 0.0, 0.0).unwrap();
    assert!((command - 1.4025).abs() < 1e-12, "{command}");
}
