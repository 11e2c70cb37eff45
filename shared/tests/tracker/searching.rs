//! A seam beside what the cameras see is found by the slides, and reached before the beam is on.

use crate::bench::{Bench, SeamFn, Shape, config};
use shared::config::TrackerConfig;
use shared::state::{TrackerFault, TrackerState};

/// Where the beams go on \[mm\].
const WELD: f64 = 80.0;
/// How long before that there is a seam to see \[mm\].
const VISIBLE: f64 = 45.0;
const FIVE_M_MIN: f64 = 5000.0 / 60.0;
const NINE_M_MIN: f64 = 150.0;

fn search(amplitude: f64) -> TrackerConfig {
    let mut config = config();
    config.tracking.search_mm = amplitude;
    config
}

/// Cameras that see 0.6 mm to either side, and speak after four pictures.
fn narrow(seam: SeamFn, config: TrackerConfig) -> Bench {
    let mut bench = Bench::new(Shape::Straight, seam);
    bench.field = 0.6;
    bench.pictures_to_acquire = 4;
    bench.noise = 0.02 / 3.0;
    bench.visible = |_, s| s >= WELD - VISIBLE;
    bench.prepare_with(config);
    bench
}

/// Runs in and welds; tracking is asked for from `asked` \[mm\] on.
#[track_caller]
fn finds(seam: SeamFn, speed: f64, asked: f64) {
    let mut bench = narrow(seam, search(3.0));
    let mut worst = [0.0f64; 4];
    while bench.s < WELD + 100.0 {
        bench.speed = (bench.speed + 0.5).min(speed);
        bench.tracking = bench.s >= asked;
        let on = bench.s_now() >= WELD;
        bench.beams = [on; 2];
        bench.tick();
        assert_eq!(
            bench.last.sample.fault, None,
            "asked at {asked} mm, now at {} mm",
            bench.s
        );
        if on {
            for (worst, error) in worst.iter_mut().zip(bench.spot_errors()) {
                *worst = worst.max(error.abs());
            }
        }
    }
    assert!(
        worst.iter().all(|w| *w <= 0.03),
        "asked at {asked} mm: {worst:?} mm beside the seam"
    );
}

/// From wherever the sweep is when the seam comes into sight.
#[track_caller]
fn finds_from_anywhere(seam: SeamFn, speed: f64) {
    for asked in 0..16 {
        finds(seam, speed, f64::from(asked));
    }
}

#[test]
fn seams_2_5_mm_beside_the_plan_are_reached_within_the_run_in_at_5_m_min() {
    finds_from_anywhere(|side, _| (if side == 0 { 2.5 } else { -2.5 }, 0.1), FIVE_M_MIN);
}

#[test]
fn and_at_9_m_min() {
    finds_from_anywhere(|side, _| (if side == 0 { -2.5 } else { 2.5 }, -0.1), NINE_M_MIN);
}

#[test]
fn and_if_they_lead_away_from_the_plan() {
    finds_from_anywhere(|_, s| (0.02 * (s - WELD) + 1.9, -0.1), NINE_M_MIN);
}

#[test]
fn slides_rest_while_nothing_is_asked_or_the_seam_is_seen_at_once() {
    let mut bench = narrow(|_, _| (0.0, 0.0), search(3.0));
    bench.noise = 0.0;
    bench.speed = 50.0;
    while bench.s < WELD - VISIBLE {
        bench.tick();
        assert!(bench.plant.truth()[0].abs() < 0.002 && bench.plant.truth()[2].abs() < 0.002);
    }
    bench.tracking = true;
    while bench.s < WELD + 50.0 {
        bench.tick();
        assert!(bench.plant.truth()[0].abs() < 0.002 && bench.plant.truth()[2].abs() < 0.002);
    }
    assert_eq!(bench.last.sample.state, TrackerState::Tracking);
}

#[test]
fn the_search_ends_while_the_machine_stands_and_stops_with_the_beam_on() {
    let mut bench = narrow(|_, _| (9.0, 0.0), search(3.0));
    bench.tracking = true;
    bench.speed = 20.0;
    let mut range = [0.0f64; 2];
    for _ in 0..1000 {
        bench.tick();
        let u = bench.plant.truth()[2];
        range = [range[0].min(u), range[1].max(u)];
        let v = bench.plant.truth()[3];
        assert!(
            (v - 0.3 * (bench.s_now() / 80.0).sin()).abs() < 0.005,
            "V keeps to its plan"
        );
    }
    assert!(
        range[0] < -2.3 && range[0] > -2.6 && range[1] > 2.3 && range[1] < 2.6,
        "{range:?} mm"
    );
    assert_eq!(bench.last.sample.fault, None);
    // At rest it goes on for two rounds, then the slides wait in the middle.
    bench.speed = 0.0;
    bench.run_ms(200);
    let there = bench.plant.truth();
    bench.run_ms(60);
    assert!((bench.plant.truth()[0] - there[0]).abs() > 0.5);
    bench.run_ms(1000);
    let held = bench.plant.truth();
    bench.run_ms(500);
    assert!((bench.plant.truth()[0] - held[0]).abs() < 0.002 && held[0].abs() < 0.002);
    bench.speed = 20.0;
    bench.run_ms(100);
    let held = bench.plant.truth();
    bench.beams = [true, false];
    bench.run_ms(200);
    let burning = bench.plant.truth()[0];
    bench.run_ms(50);
    assert!((bench.plant.truth()[0] - burning).abs() < 0.002);
    assert!(
        (bench.plant.truth()[2] - held[2]).abs() > 0.5,
        "the other side goes on"
    );
    assert!(matches!(
        bench.last.sample.fault,
        Some(TrackerFault::SeamNotSeen { side: 0, .. })
    ));
}

#[test]
fn seams_beside_and_above_or_below_are_found_at_rest_from_every_corner() {
    let seams: [SeamFn; 6] = [
        |side, _| if side == 0 { (3.0, 2.0) } else { (-3.0, 2.0) },
        |side, _| if side == 0 { (3.0, -2.0) } else { (-3.0, -2.0) },
        |side, _| if side == 0 { (0.0, 2.0) } else { (0.0, -2.0) },
        |side, _| if side == 0 { (3.0, 0.0) } else { (-3.0, 0.0) },
        |side, _| if side == 0 { (-2.2, -1.1) } else { (1.1, 0.9) },
        |side, _| if side == 0 { (0.0, 0.0) } else { (3.0, 2.0) },
    ];
    for seam in seams {
        let mut config = search(3.0);
        config.tracking.search_height_mm = 2.0;
        let mut bench = narrow(seam, config);
        bench.field = 0.65;
        bench.tracking = true;
        bench.s = WELD - 20.0;
        let mut last = bench.plant.truth();
        // A round takes 1 s.
        for _ in 0..1400 {
            bench.tick();
            let now = bench.plant.truth();
            // As fast as slides go, and what a drive overshoots.
            assert!((0..4).all(|i| (now[i] - last[i]).abs() <= 0.055));
            last = now;
        }
        let off = bench.spot_errors();
        assert!(off.iter().all(|off| off.abs() <= 0.05), "{off:?} mm");
        assert_eq!(bench.last.sample.fault, None);
    }
}

#[test]
fn a_search_as_wide_as_the_travel_never_reaches_its_ends() {
    let mut config = search(14.0);
    for slide in &mut config.slides {
        slide.travel_min_mm = -2.0;
    }
    let mut bench = narrow(|_, _| (20.0, 0.0), config);
    bench.tracking = true;
    bench.speed = 20.0;
    for _ in 0..5000 {
        bench.tick();
        let u = bench.plant.truth()[0];
        assert!(u > -2.0 && u < 12.0, "{u} mm");
    }
    assert_eq!(bench.last.sample.fault, None);
}

#[test]
fn once_a_seam_is_seen_ahead_the_slide_goes_to_where_it_begins() {
    // Without a search: seen at the edge of the picture, and out of it again before the spot comes there.
    let seam: SeamFn = |_, s| (0.5 + 0.04 * (s - (WELD - VISIBLE)), 0.0);
    let mut bench = narrow(seam, search(0.0));
    bench.tracking = true;
    bench.speed = FIVE_M_MIN;
    while bench.s < WELD - VISIBLE - 5.0 {
        bench.tick();
    }
    let first = bench.plant.truth()[0];
    assert!(first > 0.35, "{first} mm");
    while bench.s < WELD + 40.0 {
        bench.tick();
    }
    assert!(bench.spot_errors().iter().all(|e| e.abs() < 0.03));
    assert_eq!(bench.last.sample.fault, None);
}

#[test]
fn a_seam_out_of_sight_before_the_weld_is_waited_for_and_not_lost() {
    let mut bench = narrow(|_, _| (0.4, 0.1), search(0.0));
    bench.visible = |_, s| !(50.0..65.0).contains(&s);
    bench.tracking = true;
    bench.speed = FIVE_M_MIN;
    while bench.s < 45.0 {
        bench.tick();
    }
    while bench.s < WELD + 40.0 {
        bench.beams = [bench.s >= WELD; 2];
        bench.tick();
        assert_eq!(bench.last.sample.fault, None, "{} mm", bench.s);
        assert!(
            bench.spot_errors()[0].abs() < 0.05,
            "the slide stays where it met the seam last"
        );
    }
}
