//! Hold, resume, stop and disable, in every order.

use super::bench::{BLEND, Bench, LIMITS, Y, config, load};
use shared::io::MotionCommand;
use shared::protocol::{PathAction, PathEvent, PathJoin, PathLimits, Refusal, Request};
use shared::state::State;
use shared::trajectory::PathSpace;

fn events(events: &[(f64, PathAction)]) -> Request {
    let events = events.iter().map(|(s_mm, action)| PathEvent {
        s_mm: *s_mm,
        action: *action,
    });
    Request::LoadEvents(events.collect())
}

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
        bench.status();
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
    for _ in 0..4 {
        bench.run_ms(200);
        bench.status();
    }
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
        // The path is given up.
        assert_eq!(bench.refused(&Request::Run), Refusal::NoPath);
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
        bench.refused(&Request::Run),
        Refusal::WrongState { state: State::Off }
    ));
}

/// On paths in axis space no beam opens and nothing is tracked.
#[test]
fn a_path_in_axis_space_takes_no_beam_and_no_tracking() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Axes);
    let beam = |on| PathAction::Beam { side: 0, on };
    let tracking = |on| PathAction::Tracking { on };
    for action in [beam(true), tracking(true)] {
        assert_eq!(
            bench.refused(&events(&[(0.0, action)])),
            Refusal::BadEvent { index: 0 },
            "{action:?}"
        );
    }
    bench.loaded(&events(&[(0.0, beam(false)), (0.0, tracking(false))]));
}

#[test]
fn a_refused_request_leaves_the_path_as_it_was() {
    let mut bench = Bench::homed();
    bench.load_line(100.0);
    let beyond = bench.along_y(100.0, 110.0, 50.0, PathJoin::Stop);
    let (line, room) = (beyond.line, bench.status().room);
    assert_eq!(
        bench.refused(&load(beyond.clone(), true)),
        Refusal::NoEnd { line }
    );
    let on = PathAction::Beam { side: 0, on: true };
    for (s_mm, action) in [
        (-1.0, on),
        (f64::NAN, on),
        (1.0, PathAction::Beam { side: 2, on: true }),
        (1.0, PathAction::Power { side: 0, watt: -1.0 }),
    ] {
        assert_eq!(
            bench.refused(&events(&[(0.5, on), (s_mm, action)])),
            Refusal::BadEvent { index: 3 }
        );
    }
    assert_eq!(bench.status().room, room);
    bench.run();
    bench.run_ms(200);
    // What was passed cannot be switched any more.
    assert_eq!(
        bench.refused(&events(&[(1.0, on)])),
        Refusal::BadEvent { index: 2 }
    );
    for request in [
        Request::Run,
        Bench::begin_request(PathSpace::Tool),
        Request::Home,
        Request::ConfigureMotion(config()),
        Request::Reset,
        Request::Back,
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
fn limits_that_make_no_sense_do_not_begin_a_path() {
    let mut bench = Bench::homed();
    for change in [
        |limits: &mut PathLimits| limits.acceleration_mm_s2 = -1.0,
        |limits: &mut PathLimits| limits.jerk_mm_s3 = f64::NAN,
        |limits: &mut PathLimits| limits.tolerance_mm = 0.0,
        |limits: &mut PathLimits| limits.acceleration_mm_s2 = f64::INFINITY,
    ] {
        let mut limits = LIMITS;
        change(&mut limits);
        let begin = Request::BeginPath {
            id: 1,
            space: PathSpace::Tool,
            start_s_mm: 0.0,
            limits,
        };
        assert_eq!(bench.refused(&begin), Refusal::BadLimits, "{begin:?}");
    }
    assert_eq!(bench.refused(&Request::Run), Refusal::NoPath);
    for factor in [-0.1, 2.1, f64::NAN] {
        assert_eq!(bench.refused(&Request::Override { factor }), Refusal::BadOverride);
    }
}

#[test]
fn elements_that_are_no_path_are_refused_with_their_line() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let away = bench.along_y(5.0, 10.0, 50.0, BLEND);
    assert!(matches!(
        bench.refused(&load(away, false)),
        Refusal::NotAtStart { axis: 1, distance } if (distance - 5.0).abs() < 1e-3
    ));
    let first = bench.along_y(0.0, 10.0, 50.0, BLEND);
    let no_end = Refusal::NoEnd { line: first.line };
    assert_eq!(bench.refused(&load(first.clone(), true)), no_end);
    bench.loaded(&load(first, false));
    let gap = bench.along_y(11.0, 20.0, 50.0, PathJoin::Stop);
    assert!(matches!(
        bench.refused(&load(gap, true)),
        Refusal::Gap { line: 12, distance } if (distance - 1.0).abs() < 1e-3
    ));
    let slow = bench.along_y(10.0, 20.0, 0.0, PathJoin::Stop);
    assert_eq!(bench.refused(&load(slow, true)), Refusal::BadElement { line: 11 });
    let good = bench.along_y(10.0, 20.0, 50.0, PathJoin::Stop);
    bench.loaded(&load(good, true));
    bench.run();
    bench.until(State::Idle, 5000);
    assert_eq!(bench.status().s_mm, 20.0);
}

#[test]
fn parameters_of_another_machine_forget_the_path() {
    let mut bench = Bench::homed();
    bench.load_line(100.0);
    bench.done(&Request::Disable);
    bench.done(&Request::ConfigureMotion(config()));
    let status = bench.status();
    assert_eq!((status.elements, status.path_id, status.homed), (0, 0, false));
    bench.done(&Request::Home);
    bench.until(State::Idle, 5000);
    assert_eq!(bench.refused(&Request::Run), Refusal::NoPath);
}
