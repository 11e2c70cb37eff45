//! Slides that the PC moves.

use crate::bench::{Bench, PATH_ID, Shape, config};
use shared::protocol::{HOLD_TO_RUN_MS, Refusal, Request, Response};
use shared::state::TrackerState;
use shared::trajectory::PathSpace;

const PLACE: [f64; 4] = [3.0, -1.5, -11.9, 0.25];

fn ready() -> Bench {
    let mut bench = Bench::new(Shape::Straight, |_, _| (0.2, 0.1));
    bench.path_id = 0;
    bench.prepare();
    bench
}

fn move_to(target_mm: [f64; 4]) -> Request {
    Request::MoveSlides {
        target_mm,
        hold_to_run: None,
    }
}

#[track_caller]
fn at(bench: &Bench, place: [f64; 4]) {
    for (truth, place) in bench.plant.truth().iter().zip(place) {
        assert!((truth - place).abs() < 0.002, "{truth} instead of {place} mm");
    }
}

#[test]
fn slides_go_where_they_are_asked_to_within_their_limits_and_stay() {
    let mut bench = ready();
    bench.accept(move_to(PLACE));
    let limits = config().slides[0].clone();
    let mut before = bench.plant.truth();
    let mut speed = [0.0f64; 4];
    for _ in 0..800 {
        bench.tick();
        let truth = bench.plant.truth();
        for i in 0..4 {
            let now = (truth[i] - before[i]) * 1e3;
            assert!(now.abs() <= limits.max_velocity_mm_s + 0.01);
            assert!((now - speed[i]).abs() <= limits.max_acceleration_mm_s2 * 1.1e-3);
            speed[i] = now;
        }
        before = truth;
    }
    at(&bench, PLACE);
    bench.run_ms(2000);
    at(&bench, PLACE);
    assert_eq!(
        bench.status().slides_mm.map(|s| s.signum()),
        PLACE.map(f64::signum)
    );
    bench.accept(move_to([0.0; 4]));
    bench.run_ms(1000);
    at(&bench, [0.0; 4]);
}

#[test]
fn another_path_or_tracking_takes_the_slides_back() {
    let plan = |s: f64| [0.0, 0.3 * (s / 80.0).sin(), 0.0, 0.3 * (s / 80.0).sin()];
    // The loaded path begins.
    let mut bench = ready();
    bench.s = 40.0;
    bench.accept(move_to(PLACE));
    bench.run_ms(1000);
    at(&bench, PLACE);
    bench.path_id = PATH_ID;
    bench.run_ms(1000);
    at(&bench, plan(40.0));
    // On it, without tracking, they may be moved again; tracking ends that.
    bench.accept(move_to(PLACE));
    bench.run_ms(1000);
    at(&bench, PLACE);
    bench.tracking = true;
    bench.speed = 20.0;
    bench.run_ms(1500);
    assert!(bench.spot_errors().iter().all(|e| e.abs() < 0.01));
    // Another path is loaded: they stay where they are, and its plan is theirs.
    let mut bench = ready();
    bench.accept(move_to(PLACE));
    bench.run_ms(1000);
    bench.accept(Request::ClearPath {
        id: 1,
        space: PathSpace::Tool,
    });
    bench.run_ms(500);
    at(&bench, PLACE);
    bench.accept(move_to([0.0; 4]));
    bench.run_ms(1000);
    at(&bench, [0.0; 4]);
}

#[test]
fn what_is_beyond_the_travel_or_not_a_number_is_refused_and_moves_nothing() {
    let mut bench = ready();
    let mut target = PLACE;
    target[2] = 12.01;
    let refusal = Refusal::BeyondTravel {
        slide: 2,
        target_mm: 12.01,
        min_mm: -12.0,
        max_mm: 12.0,
    };
    assert_eq!(bench.ask(move_to(target)), Response::Refused(refusal));
    assert_eq!(
        refusal.to_string(),
        "slide U2 cannot go to 12.010 mm: its travel is -12.000 to 12.000 mm"
    );
    target[2] = f64::NAN;
    assert!(matches!(
        bench.ask(move_to(target)),
        Response::Refused(Refusal::BeyondTravel { slide: 2, .. })
    ));
    let before = bench.plant.truth();
    bench.run_ms(300);
    at(&bench, before);
}

#[test]
fn only_a_ready_tracker_moves_its_slides() {
    let mut off = Bench::new(Shape::Straight, |_, _| (0.0, 0.0));
    let wrong = |state| Response::Refused(Refusal::WrongTrackerState { state });
    assert_eq!(off.ask(move_to(PLACE)), wrong(TrackerState::Off));
    let mut bench = ready();
    bench.accept(Request::Home);
    assert_eq!(bench.ask(move_to(PLACE)), wrong(TrackerState::Homing));
    let mut bench = ready();
    bench.path_id = PATH_ID;
    bench.tracking = true;
    bench.run_ms(5);
    assert_eq!(bench.ask(move_to(PLACE)), wrong(TrackerState::Tracking));
    // Switched off, they are not driven, and where they were asked to be is forgotten.
    let mut bench = ready();
    bench.accept(move_to(PLACE));
    bench.run_ms(1000);
    bench.accept(Request::Disable);
    bench.run_ms(5);
    assert_eq!(bench.ask(move_to(PLACE)), wrong(TrackerState::Off));
    bench.accept(Request::Home);
    bench.run_ms(3000);
    assert!(
        bench.plant.truth().iter().all(|slide| slide.abs() < 0.05),
        "they stay near their marks"
    );
}

/// A command from before the drive went off is not a speed to slow down from.
#[test]
fn slides_that_were_switched_off_on_the_way_start_from_rest() {
    let mut bench = ready();
    bench.accept(move_to(PLACE));
    bench.run_ms(60);
    let full = config().slides[2].velocity_at_10v_mm_s;
    let told = |bench: &Bench| bench.last.command.dac.map(|dac| dac.ratio().abs() * full);
    assert!(told(&bench)[2] > 20.0, "{:?}", told(&bench));
    bench.accept(Request::Disable);
    bench.run_ms(5);
    bench.accept(Request::Home);
    while bench.status().state == TrackerState::Homing {
        bench.tick();
    }
    assert_eq!(bench.status().state, TrackerState::Ready);
    bench.tick();
    let most = config().slides[2].max_acceleration_mm_s2 * 1e-3;
    assert!(
        told(&bench).iter().all(|told| *told <= most),
        "{:?}",
        told(&bench)
    );
}

/// By hold-to-run, at 4 mm/s.
fn held_to(target_mm: [f64; 4]) -> Request {
    Request::MoveSlides {
        target_mm,
        hold_to_run: Some(4.0),
    }
}

#[test]
fn slides_that_are_held_to_run_go_no_faster_and_stop_where_they_are_let_go_of() {
    let mut bench = ready();
    let travel = [11.0, 0.0, 0.0, -11.0];
    let mut before = bench.plant.truth();
    for _ in 0..20 {
        bench.accept(held_to(travel));
        for _ in 0..50 {
            bench.tick();
            let truth = bench.plant.truth();
            assert!(
                truth
                    .iter()
                    .zip(before)
                    .all(|(now, before)| (now - before).abs() < 4.05e-3)
            );
            before = truth;
        }
    }
    assert!(
        (before[0] - 4.0).abs() < 0.2 && (before[3] + 4.0).abs() < 0.2,
        "{before:?}"
    );
    // 100 ms are left of the last time, then they brake.
    bench.run_ms(HOLD_TO_RUN_MS - 50 + 60);
    let rest = bench.plant.truth();
    assert!((rest[0] - before[0] - 0.4).abs() < 0.08, "{rest:?}");
    bench.run_ms(500);
    at(&bench, rest);
    // They go on when they are held again.
    bench.accept(held_to(travel));
    bench.run_ms(100);
    assert!(bench.plant.truth()[0] > rest[0] + 0.2);
}

#[test]
fn a_speed_must_be_positive() {
    let mut bench = ready();
    for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let request = Request::MoveSlides {
            target_mm: PLACE,
            hold_to_run: Some(speed),
        };
        assert_eq!(
            bench.ask(request),
            Response::Refused(Refusal::BadSpeed),
            "{speed}"
        );
    }
}
