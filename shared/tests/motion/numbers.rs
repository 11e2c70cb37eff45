//! Numbers that come in and that no arithmetic should meet: refused, or taken as what they mean.

use super::bench::{BLEND, Bench, LIMITS, load};
use shared::io::MotionCommand;
use shared::protocol::{PathAction, PathEvent, PathJoin, PathLimits, Refusal, Request};
use shared::state::State;
use shared::trajectory::PathSpace;

/// With it a plan of a long path wanted more nodes than numbers count.
#[test]
fn an_override_of_next_to_nothing_is_a_stop() {
    let mut bench = Bench::homed();
    // No beam: one that is on makes a hold of an override that is too low for it.
    bench.begin(PathSpace::Tool);
    let mut from = 0.0;
    for (to, feed) in [(100.0, 150.0), (200.0, 120.0), (300.0, 150.0), (400.0, 100.0)] {
        let last = to == 400.0;
        let join = if last { PathJoin::Stop } else { BLEND };
        let element = bench.along_y(from, to, feed, join);
        bench.loaded(&load(element, last));
        from = to;
    }
    bench.run();
    bench.run_ms(200);
    for factor in [1e-9, 1e-300, 5e-324] {
        bench.done(&Request::Override { factor: 1.0 });
        bench.run_ms(300);
        assert!(bench.speed() > 50.0, "{} mm/s", bench.speed());
        bench.done(&Request::Override { factor });
        bench.run_ms(480);
        assert_eq!((bench.speed(), bench.status().state), (0.0, State::Running));
    }
    // Slow, and no stop.
    bench.done(&Request::Override { factor: 0.02 });
    let before = bench.status().s_mm;
    for _ in 0..10 {
        bench.run_ms(100);
        bench.status();
    }
    let way = bench.status().s_mm - before;
    assert!(way > 1.5 && way < 3.2, "{way} mm");
}

#[test]
fn limits_of_a_path_are_those_of_machines() {
    let mut bench = Bench::homed();
    let request = |limits: PathLimits, start_s_mm: f64| Request::BeginPath {
        id: 1,
        space: PathSpace::Tool,
        start_s_mm,
        limits,
    };
    let change = |change: fn(&mut PathLimits, f64), value: f64| {
        let mut limits = LIMITS;
        change(&mut limits, value);
        limits
    };
    for value in [f64::NAN, -1.0, 0.0, 1e-300, 1e300, f64::INFINITY] {
        for limits in [
            change(|limits, value| limits.acceleration_mm_s2 = value, value),
            change(|limits, value| limits.jerk_mm_s3 = value, value),
            change(|limits, value| limits.tolerance_mm = value, value),
        ] {
            assert_eq!(
                bench.refused(&request(limits, 0.0)),
                Refusal::BadLimits,
                "{limits:?}"
            );
        }
    }
    for start in [f64::NAN, 1e300, -1e10] {
        assert_eq!(
            bench.refused(&request(LIMITS, start)),
            Refusal::BadLimits,
            "{start}"
        );
    }
}

#[test]
fn an_element_out_of_all_proportion_is_refused() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let good = bench.along_y(0.0, 10.0, 50.0, BLEND);
    for feed in [0.0, 1e-300, 1e300, f64::INFINITY, f64::NAN] {
        let mut bad = good.clone();
        bad.feed_mm_s = feed;
        assert_eq!(bench.refused(&load(bad, false)), Refusal::BadElement { line: 1 });
    }
    for length in [1e12, 1e300] {
        let bad = bench.along_y(0.0, length, 50.0, PathJoin::Stop);
        assert_eq!(bench.refused(&load(bad, true)), Refusal::BadElement { line: 1 });
    }
    bench.loaded(&load(good, false));
}

#[test]
fn no_event_asks_for_more_power_than_there_is() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let power = |watt| PathEvent {
        s_mm: 0.0,
        action: PathAction::Power { side: 0, watt },
    };
    let events = |watt| Request::LoadEvents([power(watt)].into_iter().collect());
    for watt in [4000.1, 1e300, f64::INFINITY, f64::NAN, -1.0] {
        assert_eq!(
            bench.refused(&events(watt)),
            Refusal::BadEvent { index: 0 },
            "{watt}"
        );
    }
    bench.loaded(&events(4000.0));
}

/// Both come between two path ticks: the servo ticks must not continue with what they were told.
#[test]
fn drives_and_beams_that_are_switched_off_go_off_though_homing_is_asked_for_at_once() {
    let mut bench = Bench::welding();
    bench.done(&Request::Disable);
    bench.done(&Request::Home);
    let mut off = 0;
    for _ in 0..16 {
        bench.servo_tick();
        off += u32::from(bench.command == MotionCommand::SAFE);
    }
    assert!(off >= 4, "{off} servo ticks with drives off");
    assert_eq!(bench.command.beam_gate, [false; 2]);
}
