//! Slides that do not follow their commands are switched off, and how far they go until then.

use crate::bench::{Bench, Shape, config, slides};
use plant::{GratingFault, SlideFault};
use shared::io::{SLIDES, SlideCommand};
use shared::parameter::ParameterError;
use shared::protocol::{Refusal, Request, Response};
use shared::state::{TrackerFault, TrackerState};

const DEAD: SlideFault = SlideFault::Encoder(GratingFault::Dead);

/// Runs until the drives are off, at most `ms`; how far each slide went meanwhile and while it braked \[mm\].
fn until_off(bench: &mut Bench, ms: u32) -> Option<[f64; SLIDES]> {
    let from = bench.plant.truth();
    let mut furthest = [0.0f64; SLIDES];
    let mut braking = 20;
    for _ in 0..ms {
        bench.tick();
        for (i, (now, from)) in bench.plant.truth().iter().zip(from).enumerate() {
            furthest[i] = furthest[i].max((now - from).abs());
        }
        if bench.controller.state() == TrackerState::Fault {
            assert_eq!(bench.last.command, SlideCommand::SAFE);
            braking -= 1;
            if braking == 0 {
                return Some(furthest);
            }
        }
    }
    None
}

/// A bench on a wave of 5 mm, in the middle of it, where slides go at up to 30 mm/s.
fn welding() -> Bench {
    let mut bench = Bench::new(Shape::Straight, |_, s| {
        let wave = 5.0 * (core::f64::consts::TAU * s / 100.0).sin();
        (wave, -wave)
    });
    bench.noise = 0.02 / 3.0;
    bench.prepare();
    bench.tracking = true;
    while bench.s < 200.0 {
        bench.speed = (bench.speed + 1.0).min(100.0);
        bench.tick();
        assert_eq!(bench.last.sample.fault, None);
    }
    bench
}

#[test]
fn a_dead_encoder_on_a_weld_switches_off_within_a_millimetre() {
    // Where the slide is fast, and where it turns round.
    for from in [200.0, 212.0, 225.0, 237.0] {
        for slide in 0..SLIDES {
            let mut bench = welding();
            while bench.s < from {
                bench.tick();
            }
            bench.plant.fail(slide, DEAD);
            let gone = until_off(&mut bench, 400).expect("no trip")[slide];
            let fault = bench.last.sample.fault;
            println!("dead encoder of slide {slide} at {from} mm: {gone:.2} mm, {fault:?}");
            let told = matches!(fault, Some(
                TrackerFault::NoMovement { slide: at, .. } | TrackerFault::FollowingError { slide: at, .. })
                if usize::from(at) == slide);
            assert!(told, "{fault:?}");
            assert!(gone <= 1.0, "{gone} mm");
            assert!(!bench.status().homed);
        }
    }
}

#[test]
fn a_slipping_encoder_switches_off_and_one_off_by_five_percent_does_not() {
    for (part, trips) in [
        (0.5, true),
        (0.7, true),
        (-1.0, true),
        (0.95, false),
        (1.05, false),
    ] {
        let mut bench = welding();
        bench
            .plant
            .fail(0, SlideFault::Encoder(GratingFault::Slipping(part)));
        let gone = until_off(&mut bench, 2000);
        println!(
            "counts {part} of the way: {gone:?}, {:?}",
            bench.last.sample.fault
        );
        assert_eq!(gone.is_some(), trips, "{part}: {:?}", bench.last.sample.fault);
        if let Some(gone) = gone {
            let fault = bench.last.sample.fault;
            assert!(
                matches!(fault, Some(TrackerFault::FollowingError { slide: 0, seen_um, limit_um: 500.0 }) if seen_um > 500.0),
                "{fault:?}"
            );
            assert!(part == 0.7 || gone[0] <= 2.0, "{part}: {gone:?}");
        }
    }
}

#[test]
fn a_drive_that_runs_away_is_switched_off_within_a_millimetre() {
    for (velocity, most) in [(100.0, 1.0), (-100.0, 1.0), (30.0, 1.0), (-8.0, 1.2)] {
        let mut bench = Bench::new(Shape::Straight, |_, _| (0.2, 0.1));
        bench.prepare();
        bench.plant.fail(2, SlideFault::Runaway(velocity));
        let gone = until_off(&mut bench, 2000).expect("no trip")[2];
        let fault = bench.last.sample.fault;
        println!("runs away at {velocity} mm/s: {gone:.2} mm, {fault:?}");
        assert!(
            matches!(
                fault,
                Some(
                    TrackerFault::Overspeed { slide: 2, .. } | TrackerFault::FollowingError { slide: 2, .. }
                )
            ),
            "{fault:?}"
        );
        assert!(gone <= most, "{gone} mm");
    }
}

#[test]
fn while_homing_too() {
    for (fault, most) in [(DEAD, 1.0), (SlideFault::Runaway(60.0), 1.0)] {
        let mut bench = Bench::new(Shape::Straight, |_, _| (0.2, 0.1));
        bench.accept(Request::ConfigureTracker(config()));
        bench.accept(Request::Home);
        bench.run_ms(140);
        assert_eq!(bench.controller.state(), TrackerState::Homing);
        bench.plant.fail(1, fault);
        let gone = until_off(&mut bench, 1000).expect("no trip")[1];
        println!(
            "{fault:?} while homing: {gone:.2} mm, {:?}",
            bench.last.sample.fault
        );
        assert!(gone <= most, "{gone} mm");
    }
}

#[test]
fn an_encoder_that_dies_at_rest_trips_when_the_loop_has_sent_the_slide_on_for_half_a_millimetre() {
    for away in [0.02, -0.2, 2.0] {
        let mut bench = Bench::new(Shape::Straight, |_, _| (0.2, 0.1));
        bench.prepare();
        bench.path_id = 99;
        bench.run_ms(200);
        bench.plant.fail(0, DEAD);
        let at = bench.status().slides_mm;
        bench.accept(Request::MoveSlides {
            target_mm: [at[0] + away, at[1], at[2], at[3]],
            hold_to_run: None,
        });
        let gone = until_off(&mut bench, 2000).expect("no trip")[0];
        println!("sent {away} mm on: {gone:.2} mm");
        assert!(matches!(
            bench.last.sample.fault,
            Some(TrackerFault::NoMovement { slide: 0, .. } | TrackerFault::FollowingError { slide: 0, .. })
        ));
        assert!(gone <= 1.0, "{gone} mm");
    }
}

#[test]
fn an_encoder_that_jumps_is_told_but_not_over_a_lost_tick() {
    let mut bench = welding();
    let mut feedback = bench.plant.advance(&bench.last.command);
    feedback.counts[3] += 300;
    let mut input = bench.input(feedback);
    input.periods = 2;
    assert!(bench.controller.clone().tick(&input).command.enable);
    input.periods = 1;
    bench.controller.tick(&input);
    // 50 mm/s × 2000 /mm × 1 ms × 1.5.
    let fault = bench.status().fault;
    assert!(
        matches!(
            fault,
            Some(TrackerFault::EncoderStep {
                slide: 3,
                seen: 200..=400,
                limit: 150
            })
        ),
        "{fault:?}"
    );
}

#[test]
fn after_a_trip_it_is_reset_and_homed_and_works() {
    let mut bench = welding();
    bench.plant.fail(0, SlideFault::Runaway(100.0));
    until_off(&mut bench, 400).expect("no trip");
    bench.plant = slides();
    (bench.tracking, bench.speed) = (false, 0.0);
    bench.run_ms(1);
    bench.accept(Request::Reset);
    bench.accept(Request::Home);
    bench.run_ms(3000);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    assert!(bench.status().homed && bench.status().fault.is_none());
}

#[test]
fn a_trip_too_narrow_for_the_drive_or_too_wide_to_protect_is_refused() {
    // 2/e × 50 mm/s × 10 ms = 0.368 mm, and a tenth of 24 mm.
    for (limit, good) in [
        (0.36, false),
        (0.37, true),
        (2.4, true),
        (2.41, false),
        (1e9, false),
    ] {
        let mut bench = Bench::new(Shape::Straight, |_, _| (0.2, 0.1));
        let mut config = config();
        config.slides[1].following_error_mm = limit;
        let expected = if good {
            Response::Done
        } else {
            Response::Refused(Refusal::Parameter(ParameterError::new(
                "V1",
                "following_error_mm",
                limit,
            )))
        };
        assert_eq!(bench.ask(Request::ConfigureTracker(config)), expected, "{limit}");
    }
}
