//! The search for the marks, first, again, and in vain.

use super::bench::{Bench, FULL_SPEED, MARK, config};
use shared::config::MotionConfig;
use shared::io::{DacCode, MOTORS, MotionCommand};
use shared::protocol::Request;
use shared::state::{Fault, State};

/// Axis positions that the marks 2 below the power-up position mean (mm, degrees).
fn expected(bench: &Bench) -> [f64; 6] {
    let at = |motor: usize, mark: f64| bench.position[motor] + 2.0 + mark;
    [
        at(0, MARK),
        at(2, MARK),
        at(3, MARK),
        at(4, 0.0),
        at(5, 0.0),
        at(6, 0.0),
    ]
}

fn agrees(bench: &mut Bench) {
    bench.run_ms(100);
    let (axes, expected) = (bench.status().axes, expected(bench));
    for axis in 0..6 {
        // A few counts.
        assert!(
            (axes[axis] - expected[axis]).abs() < 5e-4,
            "axis {axis}: {axes:?} {expected:?}"
        );
    }
}

#[test]
fn homing_again_finds_the_same_positions() {
    let mut bench = Bench::homed();
    assert!(bench.status().homed);
    agrees(&mut bench);
    bench.load_line(5.0);
    bench.run();
    bench.until(State::Idle, 2000);
    bench.done(&Request::Home);
    bench.run_ms(2);
    let status = bench.status();
    assert_eq!((status.state, status.homed), (State::Homing, false));
    bench.until(State::Idle, 5000);
    assert!(bench.status().homed);
    agrees(&mut bench);
}

#[test]
fn drives_whose_brakes_open_late_are_told_nothing_before() {
    let braked = |drive_enable_ms| {
        let mut bench = Bench::new();
        bench.done(&Request::ConfigureMotion(MotionConfig {
            drive_enable_ms,
            ..config()
        }));
        bench.run_ms(3);
        bench.done(&Request::Home);
        bench.blocked = [true; MOTORS];
        bench.run_ms(2);
        for _ in 2..250 {
            bench.run_ms(1);
            if drive_enable_ms > 0 {
                assert!(bench.command.enable && bench.command.dac == [DacCode::ZERO; MOTORS]);
            }
        }
        bench.blocked = [false; MOTORS];
        bench
    };
    let mut bench = braked(260);
    bench.until(State::Idle, 5000);
    agrees(&mut bench);
    assert!(matches!(braked(0).fault(), Some(Fault::NoMovement { .. })));
}

#[test]
fn an_axis_that_sags_while_its_brake_opens_stays_where_it_came_to_rest() {
    let mut bench = Bench::new();
    bench.done(&Request::ConfigureMotion(MotionConfig {
        drive_enable_ms: 100,
        ..config()
    }));
    bench.run_ms(3);
    bench.done(&Request::Home);
    bench.run_ms(50);
    bench.position[3] -= 0.05;
    bench.run_ms(51);
    // The search begins, 1 mm/s after each ms; no step back to where it was, which would be kp times 0.05 mm.
    bench.run_ms(2);
    let told = bench.command.dac[3].ratio() * FULL_SPEED;
    assert!(told.abs() < 2.0, "{told}");
    bench.until(State::Idle, 5000);
    agrees(&mut bench);
}

#[test]
fn a_mark_that_is_not_found_is_named_and_the_drives_go_off() {
    for missing in 0..7_u8 {
        let mut bench = Bench::configured();
        bench.marks[usize::from(missing)] = None;
        bench.done(&Request::Home);
        bench.until(State::Fault, 40_000);
        assert_eq!(bench.fault(), Some(Fault::MarkNotFound { motor: missing }));
        bench.run_ms(1);
        assert_eq!(bench.command, MotionCommand::SAFE);
        assert!(!bench.status().homed);
    }
}

#[test]
fn marks_that_ask_for_more_than_the_skew_trip_are_not_believed() {
    let mut bench = Bench::configured();
    bench.marks[1] = Some(-2.4);
    bench.done(&Request::Home);
    bench.until(State::Fault, 40_000);
    let fault = bench.fault();
    assert!(
        matches!(fault, Some(Fault::GantrySkew { seen_um, .. }) if (seen_um - 400.0).abs() < 1.0),
        "{fault:?}"
    );
}

/// A PC need not wait between its parameters and the order to home, wherever the machine stands, in whatever
/// scale it was before.
#[test]
fn home_right_after_new_parameters_waits_for_them() {
    let mut bench = Bench::new();
    bench.slipped = [987_654_321; 7];
    bench.run_ms(5);
    let mut other = config();
    other.motors[2].as_mut().unwrap().counts_per_unit *= -0.5;
    for config in [other, config()] {
        bench.done(&Request::Disable);
        bench.done(&Request::ConfigureMotion(config));
        bench.done(&Request::Home);
        let before = bench.position;
        bench.run_ms(5);
        assert_eq!((bench.status().state, bench.fault()), (State::Homing, None));
        // Nothing has jumped.
        for (motor, before) in before.into_iter().enumerate() {
            assert!((bench.position[motor] - before).abs() < 0.05, "motor {motor}");
        }
    }
    bench.until(State::Idle, 5000);
    agrees(&mut bench);
}

#[test]
fn parameters_and_homing_within_one_tick_are_no_fault() {
    let mut bench = Bench::homed();
    bench.done(&Request::Disable);
    bench.run_ms(100);
    bench.done(&Request::ConfigureMotion(config()));
    bench.done(&Request::Home);
    bench.until(State::Idle, 5000);
    assert_eq!(bench.fault(), None);
}

#[test]
fn what_searches_and_what_has_its_reference_is_told() {
    let mut bench = Bench::configured();
    assert_eq!((bench.status().referenced, bench.status().searching), (0, 0));
    bench.done(&Request::Home);
    let (mut seen, mut found) = (0, 0);
    while bench.status().state == State::Homing {
        let status = bench.status();
        assert_eq!(
            status.searching & status.referenced,
            0,
            "nothing searches for what it has"
        );
        assert_eq!(status.referenced & found, found, "what is found stays found");
        (seen, found) = (seen | status.searching, status.referenced);
        bench.run_ms(1);
    }
    let status = bench.status();
    // All seven motors.
    assert_eq!(
        (seen, found, status.referenced, status.searching),
        (0x7f, 0x7f, 0x7f, 0)
    );
}
