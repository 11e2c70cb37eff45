//! Paths that run as long as somebody holds them to.

use super::bench::{Bench, Y};
use shared::protocol::{HOLD_TO_RUN_MS, Refusal, Request};
use shared::state::State;

/// On a line of 300 mm at 150 mm/s, by hold-to-run; asked for again every 50 ms for `held_ms`.
fn held(held_ms: u32) -> Bench {
    let mut bench = Bench::homed();
    bench.load_line(300.0);
    bench.done(&Request::HoldToRun);
    for _ in 0..held_ms / 50 {
        bench.run_ms(50);
        bench.done(&Request::HoldToRun);
    }
    bench
}

/// Milliseconds until the machine is in `state`.
fn ms_until(bench: &mut Bench, state: State) -> u32 {
    (0..2000)
        .find(|_| {
            bench.run_ms(1);
            bench.controller.state() == state
        })
        .expect("it comes to that")
}

#[test]
fn a_path_that_is_held_to_run_runs_to_its_end() {
    let mut bench = held(2000);
    for _ in 0..40 {
        if bench.status().state != State::Running {
            break;
        }
        bench.done(&Request::HoldToRun);
        bench.run_ms(50);
    }
    let status = bench.status();
    assert_eq!((status.state, status.fault), (State::Idle, None));
    assert!((status.s_mm - 300.0).abs() < 1e-9);
    // There is nothing to hold any more, and nothing moves.
    assert_eq!(bench.refused(&Request::HoldToRun), Refusal::NoPath);
}

#[test]
fn a_machine_that_is_let_go_of_stops_and_gives_the_path_up() {
    let mut bench = held(500);
    let from = bench.position[Y];
    let ms = ms_until(&mut bench, State::Stopping);
    assert!(
        (HOLD_TO_RUN_MS - 1..=HOLD_TO_RUN_MS + 1).contains(&ms),
        "let go of for {ms} ms"
    );
    // References are two milliseconds ahead.
    bench.run_ms(1);
    assert_eq!(bench.command.beam_gate, [false; 2], "no beam while it stops");
    // The bound of any hold, at 150 mm/s and 1000 mm/s²: 0.4 s and four times what the deceleration alone takes.
    let braking = ms_until(&mut bench, State::Idle);
    assert!(braking < 1000, "{braking} ms");
    let status = bench.status();
    assert_eq!(status.fault, None);
    let gone = bench.position[Y] - from;
    assert!((20.0..45.0).contains(&gone), "{gone} mm");
    assert_eq!(bench.refused(&Request::HoldToRun), Refusal::NoPath);
    // Another path can be begun, and runs by itself.
    bench.load_line(20.0);
    bench.run();
    bench.until(State::Idle, 2000);
}

#[test]
fn it_can_be_held_to_run_again_only_until_it_stops() {
    let mut bench = held(500);
    bench.run_ms(HOLD_TO_RUN_MS - 5);
    bench.done(&Request::HoldToRun);
    bench.run_ms(100);
    assert_eq!(bench.status().state, State::Running);
    ms_until(&mut bench, State::Stopping);
    assert_eq!(
        bench.refused(&Request::HoldToRun),
        Refusal::WrongState {
            state: State::Stopping
        }
    );
}

#[test]
fn a_hold_does_not_take_the_place_of_a_hand() {
    let mut bench = held(500);
    bench.done(&Request::Hold);
    bench.run_ms(100);
    bench.done(&Request::HoldToRun);
    assert_eq!(
        bench.status().state,
        State::Holding,
        "held to run, it stays on hold"
    );
    ms_until(&mut bench, State::Idle);
    assert_eq!(
        bench.refused(&Request::Resume),
        Refusal::WrongState { state: State::Idle }
    );
}

#[test]
fn a_path_that_runs_by_itself_is_not_held() {
    let mut bench = Bench::welding();
    assert_eq!(
        bench.refused(&Request::HoldToRun),
        Refusal::WrongState {
            state: State::Running
        }
    );
    for _ in 0..10 {
        bench.run_ms(50);
        assert_eq!(bench.status().state, State::Running);
    }
}
