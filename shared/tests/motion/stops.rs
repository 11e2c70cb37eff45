//! Hold, resume, stop and disable, in every order.

use super::bench::{Bench, Y, config};
use shared::io::MotionCommand;
use shared::motion::State;
use shared::protocol::{Knot, PathAction, PathEvent, Refusal, Request};
use shared::trajectory::CHANNELS;
use shared::trajectory::PathSpace;

#[test]
fn resume_while_still_slowing_goes_on_from_rest() {
    let mut bench = Bench::welding();
    bench.done(&Request::Hold);
    bench.run_ms(20);
    assert!(bench.speed() > 50.0);
    bench.done(&Request::Resume);
    let mut slowest = f64::MAX;
    while bench.controller.state() == State::Holding {
        bench.run_ms(1);
        slowest = slowest.min(bench.speed().abs());
        assert!(!bench.command.beam_gate[0]);
    }
    assert!(slowest < 0.5, "{slowest}");
    bench.until(State::Idle, 5000);
    assert_eq!(bench.status().s_mm, 300.0);
}

#[test]
fn a_second_hold_takes_back_the_resume() {
    let mut bench = Bench::welding();
    bench.done(&Request::Hold);
    bench.run_ms(20);
    bench.done(&Request::Resume);
    bench.done(&Request::Hold);
    bench.run_ms(400);
    let held = bench.position[Y];
    bench.run_ms(50);
    assert_eq!(bench.status().state, State::Holding);
    assert!((bench.position[Y] - held).abs() < 1e-3);
    bench.done(&Request::Resume);
    bench.until(State::Idle, 5000);
}

#[test]
fn stop_gives_up_the_path_from_running_and_from_holding() {
    for hold_ms in [None, Some(20), Some(400)] {
        let mut bench = Bench::welding();
        if let Some(ms) = hold_ms {
            bench.done(&Request::Hold);
            bench.run_ms(ms);
        }
        bench.done(&Request::Stop);
        bench.done(&Request::Stop);
        bench.until(State::Idle, 500);
        assert!(bench.command.enable && bench.speed().abs() < 0.5);
        assert!(matches!(
            bench.refused(&Request::Resume),
            Refusal::WrongState { state: State::Idle }
        ));
        // Halfway along the path is not where it begins.
        assert!(matches!(
            bench.refused(&Bench::run_request()),
            Refusal::NotAtStart { axis: 1, distance } if distance < -20.0
        ));
        assert_eq!(bench.status().state, State::Idle);
    }
}

#[test]
fn stop_during_homing_switches_the_drives_off() {
    let mut bench = Bench::configured();
    bench.done(&Request::Home);
    bench.run_ms(50);
    assert!(bench.command.enable);
    bench.done(&Request::Stop);
    bench.run_ms(1);
    bench.servo_tick();
    assert_eq!(bench.command, MotionCommand::SAFE);
    let status = bench.status();
    assert_eq!((status.state, status.homed), (State::Off, false));
    bench.done(&Request::Home);
    bench.until(State::Idle, 5000);
}

#[test]
fn disable_on_the_path_switches_everything_off_and_publishes_no_speed() {
    let mut bench = Bench::welding();
    bench.done(&Request::Disable);
    bench.run_ms(1);
    bench.servo_tick();
    assert_eq!(bench.command, MotionCommand::SAFE);
    bench.run_ms(5);
    let state = bench.path_state.unwrap();
    assert_eq!((state.path_id, state.speed_mm_s, state.tracking), (0, 0.0, false));
    // Without drives no path runs, and there is no way on but homing.
    assert!(matches!(
        bench.refused(&Bench::run_request()),
        Refusal::WrongState { state: State::Off }
    ));
}

#[test]
fn a_refused_request_leaves_the_path_as_it_was() {
    let mut bench = Bench::homed();
    bench.load_line(100.0);
    let knot = |s_mm| Knot {
        s_mm,
        value: [0.0; CHANNELS],
        slope: [0.0; CHANNELS],
    };
    let knots = [knot(110.0), knot(120.0), knot(120.0)].into_iter().collect();
    assert_eq!(
        bench.refused(&Request::LoadKnots(knots)),
        Refusal::BadKnot { index: 4 }
    );
    assert_eq!(bench.status().knots, 2);
    for (s_mm, action) in [
        (-1.0, PathAction::Beam { side: 0, on: true }),
        (f64::NAN, PathAction::Beam { side: 0, on: true }),
        (1.0, PathAction::Beam { side: 2, on: true }),
        (1.0, PathAction::Power { side: 0, watt: -1.0 }),
    ] {
        assert_eq!(
            bench.refused(&Request::LoadEvent(PathEvent { s_mm, action })),
            Refusal::BadEvent { index: 2 }
        );
    }
    bench.run();
    bench.run_ms(100);
    for request in [
        Bench::run_request(),
        Request::ClearPath {
            id: 8,
            space: PathSpace::Tool,
        },
        Request::LoadKnots([knot(110.0)].into_iter().collect()),
        Request::LoadEvent(PathEvent {
            s_mm: 1.0,
            action: PathAction::Tracking { on: true },
        }),
        Request::Home,
        Request::ConfigureMotion(config()),
        Request::Reset,
    ] {
        assert_eq!(
            bench.refused(&request),
            Refusal::WrongState {
                state: State::Running
            },
            "{request:?}"
        );
    }
    bench.until(State::Idle, 2000);
    assert_eq!(bench.status().s_mm, 100.0);
}

#[test]
fn limits_that_make_no_sense_do_not_start_a_path() {
    let mut bench = Bench::homed();
    bench.load_line(100.0);
    for (speed_mm_s, acceleration_mm_s2, jerk_mm_s3) in [
        (0.0, 1000.0, 20_000.0),
        (100.0, -1.0, 20_000.0),
        (100.0, 1000.0, f64::NAN),
        (f64::INFINITY, 1000.0, 20_000.0),
        (1e308, 1e308, 1e-308),
    ] {
        let run = Request::Run {
            speed_mm_s,
            acceleration_mm_s2,
            jerk_mm_s3,
        };
        assert_eq!(bench.refused(&run), Refusal::NoPath, "{run:?}");
    }
    assert_eq!(bench.status().state, State::Idle);
}

#[test]
fn parameters_of_another_machine_forget_the_path() {
    let mut bench = Bench::homed();
    bench.load_line(100.0);
    bench.done(&Request::Disable);
    bench.done(&Request::ConfigureMotion(config()));
    let status = bench.status();
    assert_eq!((status.knots, status.path_id, status.homed), (0, 0, false));
    bench.done(&Request::Home);
    bench.until(State::Idle, 5000);
    assert_eq!(bench.refused(&Bench::run_request()), Refusal::NoPath);
}
