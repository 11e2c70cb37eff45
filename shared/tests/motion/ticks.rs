//! Counters and clocks over weeks.

use super::bench::{Bench, config};
use shared::motion::{MotionController, PathTickInput, ServoReport};
use shared::protocol::Request;
use shared::state::State;

/// Path ticks are counted in 32 bits for people, 49 days of them; their time continues.
#[test]
fn the_time_of_path_ticks_goes_on_when_their_counter_wraps() {
    let mut controller = Box::new(MotionController::new());
    let mut tick = |now_us: u64, elapsed: u32| {
        let output = controller.tick(&PathTickInput {
            now_us,
            elapsed,
            report: ServoReport::default(),
        });
        (output.path_state.tick, output.path_state.time_us)
    };
    assert_eq!(tick(5_000_123, 1), (1, 5_000_123));
    let days_us = u64::from(u32::MAX) * 1000;
    assert_eq!(tick(5_000_123 + days_us, u32::MAX), (0, 5_000_123 + days_us));
    assert_eq!(tick(5_001_130 + days_us, 1), (1, 5_001_123 + days_us));
    assert_eq!(tick(5_001_130 + 2 * days_us, u32::MAX).0, 0);
}

/// Servo ticks wrap every twelve days, and the millisecond stays where it is.
#[test]
fn a_path_runs_while_the_servo_ticks_wrap() {
    let mut bench = Bench::new();
    bench.servo_tick_after(u32::MAX - 3 - 4 * 400);
    bench.servo_tick_after(4);
    bench.done(&Request::ConfigureMotion(config()));
    bench.run_ms(2);
    bench.done(&Request::Home);
    let before = bench.status().servo_ticks;
    bench.until(State::Idle, 5000);
    let status = bench.status();
    assert!(status.servo_ticks < before, "{} {before}", status.servo_ticks);
    assert_eq!(status.path_lost, 0);
}

/// Parameters may come at any servo tick: the millisecond of the servo ticks is that of the path ticks.
#[test]
fn new_parameters_do_not_move_the_millisecond() {
    let mut bench = Bench::new();
    bench.run_ms(3);
    bench.done(&Request::ConfigureMotion(config()));
    // The path tick that brings them is late by two servo ticks.
    (0..6).for_each(|_| bench.servo_tick_after(1));
    bench.path_tick_after(1);
    // Reports are of the servo tick that fell together with the path tick, every fourth from boot on.
    for tick in 6..20 {
        bench.slipped[0] = i64::from(tick);
        bench.servo_tick_after(1);
        if tick >= 8 {
            let reported = bench.servo.take_report().counts[0];
            assert_eq!(reported, i64::from((tick + 1) / 4 * 4 - 1), "at tick {tick}");
        }
    }
    bench.servo_tick_after(3);
    assert_eq!(bench.servo.take_report().lost, 2);
}
