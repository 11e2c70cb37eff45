//! Steps of the speed along a path, and what hold, resume and stop make of them.

use super::bench::Bench;
use shared::protocol::Request;
use shared::state::State;

const STEPS: [(f64, f64); 3] = [(100.0, 30.0), (140.0, 60.0), (220.0, 20.0)];

/// On a line of 300 mm, at 150 mm/s to begin with.
fn running() -> Bench {
    let mut bench = Bench::homed();
    bench.load_steps(&[(100.0, 150.0), (140.0, 30.0), (220.0, 60.0), (300.0, 20.0)]);
    bench.run();
    bench
}

fn limit_at(s: f64) -> f64 {
    let before = STEPS.iter().rev().find(|step| step.0 <= s);
    before.map_or(150.0, |step| step.1)
}

/// Runs on until `done`, and sees that the speed in no millisecond is above what the path allows there; returns the
/// highest speed as a part of that limit, for each step.
fn watch(bench: &mut Bench, mut done: impl FnMut(&mut Bench) -> bool) -> [f64; 3] {
    let mut used = [0.0f64; 3];
    let mut before = bench.status().s_mm;
    while !done(bench) {
        bench.run_ms(1);
        let now = bench.status().s_mm;
        let speed = (now - before) / 1e-3;
        // The output filter sees a step for some milliseconds.
        let allowed = limit_at(before - 1.0).max(limit_at(now + 0.5));
        assert!(speed <= allowed + 0.1, "{speed} mm/s at {now}");
        for (used, step) in used.iter_mut().zip(STEPS) {
            if limit_at(before) == step.1 {
                *used = used.max(speed / allowed);
            }
        }
        before = now;
    }
    used
}

fn at_end(bench: &mut Bench) -> bool {
    bench.controller.state() == State::Idle
}

#[test]
fn every_step_is_kept_and_reached() {
    let mut bench = running();
    let used = watch(&mut bench, at_end);
    assert!(used.iter().all(|part| *part > 1.0 - 1e-3), "{used:?}");
    assert_eq!(bench.status().s_mm, 300.0);
}

#[test]
fn after_a_hold_the_rest_of_the_steps_is_kept() {
    for hold_at in [40.0, 95.0, 120.0, 139.0, 200.0] {
        let mut bench = running();
        watch(&mut bench, |bench| bench.status().s_mm >= hold_at);
        bench.done(&Request::Hold);
        watch(&mut bench, |bench| bench.speed().abs() < 0.5);
        bench.run_ms(100);
        assert_eq!(bench.status().state, State::Holding);
        bench.done(&Request::Resume);
        let used = watch(&mut bench, at_end);
        assert!(used[2] > 1.0 - 1e-3, "{used:?}");
        assert_eq!(bench.status().s_mm, 300.0);
    }
}

#[test]
fn a_resume_asked_for_while_slowing_keeps_the_steps_too() {
    let mut bench = running();
    watch(&mut bench, |bench| bench.status().s_mm >= 60.0);
    bench.done(&Request::Hold);
    bench.done(&Request::Resume);
    let used = watch(&mut bench, at_end);
    assert!(used.iter().all(|part| *part > 1.0 - 1e-3), "{used:?}");
}

#[test]
fn a_stop_between_steps_stands_before_the_end() {
    let mut bench = running();
    watch(&mut bench, |bench| bench.status().s_mm >= 150.0);
    bench.done(&Request::Stop);
    watch(&mut bench, at_end);
    assert!(bench.status().s_mm < 160.0);
}
