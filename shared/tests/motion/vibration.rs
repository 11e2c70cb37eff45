//! A motor that swings by less than its following-error trip stops the machine all the same: at rest, on a path, not while it is
//! excited.

use super::bench::{Bench, Y, config};
use shared::io::MotionCommand;
use shared::protocol::{CaptureState, Excitation, Excited, Request, Response};
use shared::state::{Fault, State};
use shared::ticks::SERVO_PERIOD_S;
use std::f64::consts::TAU;

/// What Y may have \[mm\].
const LIMIT: f64 = 0.02;
/// How fast something shakes it \[Hz\], quicker than its loop is.
const SHAKEN_HZ: f64 = 80.0;

/// Homed, with a limit of Y.
fn watched() -> Bench {
    let mut config = config();
    config.motors[Y].as_mut().unwrap().vibration_limit = LIMIT;
    Bench::homed_as(config)
}

/// Shakes Y for `ms` by a sine of `amplitude` \[mm\]: the drives are off, or the state is `until`.
fn shaken(bench: &mut Bench, amplitude: f64, ms: u32, until: State) -> Option<u32> {
    for tick in 0..4 * ms {
        let at = |tick: u32| amplitude * (TAU * SHAKEN_HZ * SERVO_PERIOD_S * f64::from(tick)).sin();
        bench.position[Y] += at(tick + 1) - at(tick);
        bench.servo_tick();
        if tick % 400 == 0 {
            bench.status();
        }
        if bench.controller.state() == until {
            return Some(tick / 4);
        }
    }
    None
}

/// The fault of Y, with what was seen \[µm\].
fn seen(bench: &mut Bench) -> f64 {
    match bench.fault() {
        Some(Fault::Vibration {
            motor: 2,
            seen_um,
            limit_um: 20.0,
        }) => seen_um.into(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_axis_at_rest_that_vibrates_trips() {
    let mut bench = watched();
    // 0.014 mm rms.
    assert_eq!(shaken(&mut bench, 0.02, 3000, State::Fault), None);
    let level = f64::from(bench.status().vibration[Y]);
    assert!((0.012..0.016).contains(&level), "{level}");
    // 0.035 mm rms.
    let ms = shaken(&mut bench, 0.05, 1000, State::Fault).expect("a trip");
    assert!((200..600).contains(&ms), "{ms} ms");
    bench.run_ms(1);
    assert_eq!(bench.command, MotionCommand::SAFE);
    let seen = seen(&mut bench);
    assert!((20.0..25.0).contains(&seen), "{seen}");
    // What was is no cause to trip again.
    bench.done(&Request::Reset);
    bench.done(&Request::Home);
    bench.until(State::Idle, 5000);
    bench.run_ms(500);
    assert_eq!(bench.status().state, State::Idle);
}

#[test]
fn on_a_path_the_beam_goes_off_at_once_and_the_machine_stops_on_it() {
    let mut bench = watched();
    bench.load_line(300.0);
    bench.run();
    bench.run_ms(400);
    assert!(bench.command.beam_gate[0]);
    shaken(&mut bench, 0.05, 1000, State::Stopping).expect("a stop");
    bench.run_ms(2);
    assert!(!bench.command.beam_gate[0] && bench.command.enable);
    bench.until(State::Fault, 2000);
    seen(&mut bench);
}

#[test]
fn a_motion_as_hard_as_the_axis_bears_is_no_vibration() {
    let mut bench = watched();
    bench.load_line(300.0);
    bench.run();
    bench.run_ms(1);
    bench.until(State::Idle, 10_000);
    let level = f64::from(bench.status().vibration[Y]);
    assert!(level < LIMIT / 2.0, "{level}");
}

#[test]
fn a_motor_that_is_not_watched_is_told_only() {
    let mut bench = Bench::homed();
    assert_eq!(shaken(&mut bench, 0.2, 2000, State::Fault), None);
    // Twice the usual limit at most.
    let level = f64::from(bench.status().vibration[Y]);
    assert!((0.03..0.0401).contains(&level), "{level}");
}

#[test]
fn a_motor_that_is_excited_is_meant_to_shake() {
    let mut bench = watched();
    let excitation = Excitation {
        motor: Y as u8,
        excited: Excited::Command,
        amplitude: 100.0,
        from_hz: 40.0,
        to_hz: 120.0,
        settle_periods: 2,
        way: 0.0,
        max_travel: 2.0,
        max_speed: 300.0,
    };
    bench.done(&Request::Excite(excitation));
    for _ in 0..20 {
        bench.status();
        bench.run_ms(100);
    }
    match bench.controller.handle(&Request::ReadCapture { from: 0 }, 0) {
        Response::Captured(part) => assert!(matches!(part.state, CaptureState::Complete), "{:?}", part.state),
        other => panic!("{other:?}"),
    }
    assert_eq!(bench.status().state, State::Idle);
}
