//! Paths that an input of the process ends.

use super::bench::{Bench, SCALE, Y, config, load};
use shared::config::OutputConfig;
use shared::io::Bits;
use shared::protocol::{PathAction, PathEvent, PathJoin, Refusal, Request};
use shared::state::State;
use shared::trajectory::PathSpace;

/// The second input: something is touched.
const TOUCH: Request = Request::RunUntil { input: 1, on: true };

/// On a line of 30 mm along Y at `feed` \[mm/s\], with nothing switched on.
fn on_a_line(feed: f64) -> Bench {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let element = bench.along_y(0.0, 30.0, feed, PathJoin::Stop);
    bench.loaded(&load(element, true));
    bench
}

/// Runs to rest, asking for the status like a PC; the second input is on while Y is beyond `touched`.
fn to_rest(bench: &mut Bench, touched: impl Fn(f64) -> bool) -> State {
    for tick in 0..4 * 20_000 {
        bench.servo_tick();
        bench.inputs.process = Bits(u8::from(touched(bench.position[Y])) << 1);
        if tick % 400 == 0 {
            bench.status();
        }
        if !bench.controller.state().on_path() {
            return bench.controller.state();
        }
    }
    panic!("it does not come to rest: {:?}", bench.status());
}

#[test]
fn what_is_touched_ends_the_path_and_its_place_is_known_to_a_servo_tick() {
    for (feed, at) in [(0.5, 1.3), (3.0, 7.77), (20.0, 18.1), (100.0, 15.0)] {
        let mut bench = on_a_line(feed);
        let from = bench.position[Y];
        let frame = bench.status().axes[1] - from;
        bench.done(&TOUCH);
        let end = to_rest(&mut bench, |y| y > from + at);
        assert_eq!(end, State::Idle);
        let status = bench.status();
        let met = status.met.expect("it was touched")[1] - frame - from;
        // What is touched is read at the next tick, by the count below.
        let step = feed * 250e-6;
        assert!(
            (at - 1.0 / SCALE..at + 2.0 * step + 1.0 / SCALE).contains(&met),
            "touched at {at} mm with {feed} mm/s, told at {met} mm"
        );
        let stopped = status.reference[1] - frame - from;
        println!("{feed} mm/s: stopped {:.4} mm behind", stopped - at);
        assert!(stopped < 30.0);
        // The next path begins where it stands.
        bench.begin(PathSpace::Tool);
        let back = bench.along_y(0.0, 5.0, feed, PathJoin::Stop);
        bench.loaded(&load(back, true));
        bench.run();
        assert_eq!(to_rest(&mut bench, |_| false), State::Idle);
        assert!(
            bench.status().met.is_some(),
            "of the last path that was run until something"
        );
    }
}

#[test]
fn a_path_that_meets_nothing_runs_to_its_end() {
    let mut bench = on_a_line(20.0);
    let from = bench.position[Y];
    bench.done(&TOUCH);
    assert_eq!(to_rest(&mut bench, |_| false), State::Idle);
    assert_eq!(bench.status().met, None);
    assert!((bench.position[Y] - from - 30.0).abs() < 0.01);
    // It is of no matter for the next one.
    bench.begin(PathSpace::Tool);
    let element = bench.along_y(0.0, 10.0, 20.0, PathJoin::Stop);
    bench.loaded(&load(element, true));
    bench.run();
    assert_eq!(to_rest(&mut bench, |y| y > from + 33.0), State::Idle);
    assert!((bench.position[Y] - from - 40.0).abs() < 0.01);
    assert_eq!(bench.status().met, None);
}

#[test]
fn an_input_that_goes_off_ends_a_path_too() {
    let mut bench = on_a_line(3.0);
    let from = bench.position[Y];
    bench.inputs.process = Bits(0b10);
    bench.run_ms(2);
    bench.done(&Request::RunUntil { input: 1, on: false });
    assert_eq!(to_rest(&mut bench, |y| y < from + 4.0), State::Idle);
    let met = bench.status().met.expect("it went off");
    assert!((met[1] - bench.status().axes[1]).abs() < 1.0);
    assert!(bench.position[Y] - from < 5.0);
}

#[test]
fn a_hold_on_the_way_still_sees_what_is_touched() {
    let mut bench = on_a_line(20.0);
    bench.done(&TOUCH);
    bench.run_ms(400);
    bench.done(&Request::Hold);
    bench.until(State::Holding, 10);
    bench.run_ms(400);
    bench.status();
    bench.run_ms(200);
    assert_eq!(bench.controller.state(), State::Holding);
    bench.inputs.process = Bits(0b10);
    bench.until(State::Idle, 20);
    assert!(bench.status().met.is_some());
}

#[test]
fn a_path_that_would_end_at_once_is_not_begun() {
    let mut bench = on_a_line(20.0);
    bench.inputs.process = Bits(0b10);
    bench.run_ms(2);
    let refusal = bench.refused(&TOUCH);
    assert_eq!(refusal, Refusal::InputAlready { input: 1, on: true });
    assert_eq!(
        refusal.to_string(),
        "input 2 is on already, before the path begins that it is to end"
    );
    let no_input = Request::RunUntil { input: 4, on: true };
    assert_eq!(bench.refused(&no_input), Refusal::Malformed);
    assert_eq!(bench.controller.state(), State::Idle);
    // Not one that runs already, and not without a path.
    bench.run();
    assert_eq!(
        bench.refused(&Request::RunUntil { input: 2, on: true }),
        Refusal::WrongState {
            state: State::Running
        }
    );
}

#[test]
fn what_is_switched_on_stays_on_where_a_path_has_met_its_input() {
    let gas = |bench: &Bench| bench.samples.last().expect("samples").outputs & 1;
    let path = |until: bool| {
        let mut config = config();
        config.process.outputs[0] = Some(OutputConfig { follows_beam: None });
        let mut bench = Bench::new();
        bench.done(&Request::ConfigureMotion(config));
        bench.run_ms(3);
        bench.done(&Request::Home);
        bench.until(State::Idle, 5000);
        bench.begin(PathSpace::Tool);
        let element = bench.along_y(0.0, 30.0, 20.0, PathJoin::Stop);
        bench.loaded(&load(element, true));
        let action = PathAction::Output { output: 0, on: true };
        let events = [PathEvent { s_mm: 0.0, action }].into_iter().collect();
        bench.loaded(&Request::LoadEvents(events));
        match until {
            true => bench.done(&TOUCH),
            false => bench.run(),
        }
        bench.run_ms(400);
        assert_eq!(gas(&bench), 1);
        bench
    };
    let mut bench = path(true);
    bench.inputs.process = Bits(0b10);
    bench.until(State::Idle, 1000);
    for _ in 0..100 {
        bench.run_ms(1);
        assert_eq!(gas(&bench), 1);
    }
    // Not where somebody stops it, with or without a touch on the way.
    for touches in [false, true] {
        let mut bench = path(true);
        bench.done(&Request::Stop);
        bench.inputs.process = Bits(u8::from(touches) << 1);
        bench.until(State::Idle, 1000);
        bench.run_ms(5);
        assert_eq!((gas(&bench), bench.status().met), (0, None));
    }
    let mut bench = path(false);
    bench.done(&Request::Stop);
    bench.until(State::Idle, 1000);
    bench.run_ms(5);
    assert_eq!(gas(&bench), 0);
}
