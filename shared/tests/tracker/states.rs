//! Every transition of the state machine, every refusal, every fault.

use crate::bench::{Bench, PATH_ID, Shape, config};
use plant_file::{DEFAULT_MACHINE, PlantFile};
use shared::config::TrackerConfig;
use shared::io::SlideCommand;
use shared::parameter::ParameterError;
use shared::protocol::{Datagram, Measurement, Refusal, Request, Response};
use shared::state::{TrackerFault, TrackerState};
use shared::tracking::{TickInput, TrackerController};
use shared::trajectory::PathSpace;

pub fn bench() -> Bench {
    Bench::new(Shape::Straight, |_, _| (0.2, 0.1))
}

/// A bench in state ready, the path loaded.
pub fn ready() -> Bench {
    let mut bench = bench();
    bench.prepare();
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    bench
}

/// A bench that tracks at 100 mm/s and sees the seam.
fn tracking() -> Bench {
    let mut bench = ready();
    bench.tracking = true;
    bench.speed = 100.0;
    bench.run_ms(400);
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    assert_eq!(bench.last.sample.fault, None);
    bench
}

fn wrong_state(state: TrackerState) -> Response {
    Response::Refused(Refusal::WrongTrackerState { state })
}

/// Slides whose drives have an offset of 30 mV, this way or that, and follow 250 ms after their enable.
fn late_and_offset(drive_enable_ms: u32) -> Bench {
    let mut plant = PlantFile::shipped(DEFAULT_MACHINE).unwrap_or_else(|error| panic!("{error}"));
    for (slide, offset) in plant
        .plant
        .slides
        .iter_mut()
        .flatten()
        .zip([0.3, -0.3, -0.3, 0.3])
    {
        slide.offset = offset;
        slide.enable_s = 0.25;
    }
    let mut bench = bench();
    bench.plant = plant.slides();
    bench.path_id = 99;
    bench.prepare_with(TrackerConfig {
        drive_enable_ms,
        ..config()
    });
    bench
}

#[test]
fn slides_learn_what_holds_them_against_the_offsets_of_their_drives() {
    let mut bench = late_and_offset(260);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    for _ in 0..200 {
        bench.run_ms(100);
        bench.status();
        let sample = &bench.last.sample;
        assert_eq!((sample.state, sample.fault), (TrackerState::Ready, None));
        for slide in 0..4 {
            let off = sample.slides_mm[slide] - sample.target_mm[slide];
            // Two counts; 7.5 um where it is not known.
            assert!(off.abs() < 0.001, "slide {slide}: {off}");
        }
    }
}

#[test]
fn slides_that_are_told_to_move_before_their_brakes_open_are_found_dead() {
    let bench = late_and_offset(0);
    assert_eq!(bench.controller.state(), TrackerState::Fault);
    assert!(matches!(
        bench.last.sample.fault,
        Some(TrackerFault::NoMovement { .. })
    ));
}

#[test]
fn without_parameters_it_is_off_and_cannot_home() {
    let mut bench = bench();
    bench.run_ms(10);
    assert_eq!(bench.controller.state(), TrackerState::Off);
    assert_eq!(bench.last.command, SlideCommand::SAFE);
    assert_eq!(
        bench.ask(Request::Home),
        Response::Refused(Refusal::NotConfigured)
    );
}

#[test]
fn without_parameters_it_tells_what_it_reads() {
    let mut bench = bench();
    bench.change_inputs = |feedback| {
        feedback.counts[2] = -70;
        feedback.mark[2] = Some(-65);
        feedback.limit_plus.set(0, true);
        feedback.limit_minus.set(3, true);
        feedback.drive_fault.set(1, true);
        feedback.estop = [true, false];
    };
    bench.run_ms(10);
    let Response::Inputs(told) = bench.ask(Request::Inputs) else {
        panic!("no inputs")
    };
    assert_eq!((told.counts[2], told.marks[2]), (-70, Some(-65)));
    assert_eq!(
        (told.limit_plus, told.limit_minus, told.drive_fault),
        (1, 1 << 3, 1 << 1)
    );
    assert_eq!(told.estop, [true, false]);
    assert_eq!(bench.last.command, SlideCommand::SAFE);
}

#[test]
fn bad_parameters_are_named_and_change_nothing() {
    let mut bench = bench();
    let mut bad = config();
    bad.slides[2].counts_per_mm = 0.0;
    let refusal = Refusal::Parameter(ParameterError::new("U2", "counts_per_mm", 0.0));
    assert_eq!(
        bench.ask(Request::ConfigureTracker(bad)),
        Response::Refused(refusal)
    );
    // More gain than a loop with that much dead time could stand: π/2 / 10 ms = 157/s.
    let mut bad = config();
    bad.tracking.kp = 160.0;
    let refusal = Refusal::Parameter(ParameterError::new("tracking", "kp", 160.0));
    assert_eq!(
        bench.ask(Request::ConfigureTracker(bad)),
        Response::Refused(refusal)
    );
    assert_eq!(
        bench.ask(Request::Home),
        Response::Refused(Refusal::NotConfigured)
    );
}

#[test]
fn homing_finds_all_marks_within_a_count_and_takes_the_plan() {
    let mut bench = bench();
    bench.path_id = 99;
    bench.accept(Request::ConfigureTracker(config()));
    bench.accept(Request::Home);
    assert_eq!(bench.controller.state(), TrackerState::Homing);
    bench.run_ms(1);
    assert!(bench.last.command.enable);
    assert!(!bench.status().homed);
    bench.run_ms(3000);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    let status = bench.status();
    assert!(status.homed && status.fault.is_none());
    for (seen, truth) in status.slides_mm.iter().zip(bench.plant.truth()) {
        assert!((seen - truth).abs() <= 0.0005, "{seen} {truth}");
    }
    // No path: the slides stand still.
    let before = bench.plant.truth();
    bench.run_ms(500);
    for (before, after) in before.iter().zip(bench.plant.truth()) {
        assert!((before - after).abs() < 0.001);
    }
}

#[test]
fn parameters_and_homing_within_one_tick_are_no_jump_of_an_encoder() {
    let mut bench = ready();
    bench.accept(Request::Disable);
    bench.run_ms(100);
    bench.accept(Request::ConfigureTracker(config()));
    bench.accept(Request::Home);
    bench.run_ms(3000);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    assert_eq!(bench.status().fault, None);
}

#[test]
fn on_the_loaded_path_without_tracking_the_slides_take_the_plan() {
    let mut bench = ready();
    bench.s = 80.0;
    bench.run_ms(1000);
    let v = 0.3 * 1.0f64.sin();
    for (slide, plan) in bench.plant.truth().iter().zip([0.0, v, 0.0, v]) {
        assert!((slide - plan).abs() < 0.001, "{slide} {plan}");
    }
    // On another path they stay where they are.
    bench.path_id = 99;
    bench.s = 0.0;
    bench.run_ms(500);
    assert!((bench.plant.truth()[1] - v).abs() < 0.001);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
}

#[test]
fn tracking_begins_and_ends_with_the_flag_of_the_path() {
    let mut bench = tracking();
    bench.tracking = false;
    bench.run_ms(2);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    bench.tracking = true;
    bench.run_ms(2);
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    // Another path than the loaded one is not tracked.
    bench.path_id = 99;
    bench.run_ms(2);
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    assert_eq!(bench.last.sample.fault, None);
}

#[test]
fn a_moving_plan_is_followed_without_lag() {
    let mut bench = ready();
    bench.speed = 100.0;
    while bench.s < 60.0 {
        bench.tick();
    }
    // The plan moves at 0.3 mm/s here: without its slope fed forward the slide would lag by 6 µm.
    let plan = 0.3 * (bench.s_now() / 80.0).sin();
    let lag = plan - bench.plant.truth()[1];
    assert!(lag.abs() < 0.001, "{lag} mm");
}

#[test]
fn a_seam_seen_before_a_pause_of_tracking_is_not_lost_after_it() {
    let mut bench = tracking();
    bench.visible = |_, s| s < 60.0;
    while bench.s < 61.0 {
        bench.tick();
    }
    bench.tracking = false;
    while bench.s < 100.0 {
        bench.tick();
    }
    bench.tracking = true;
    bench.run_ms(100);
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    assert_eq!(bench.last.sample.fault, None);
    assert!(
        bench.plant.truth()[0].abs() < 0.002,
        "the slides stay at the plan"
    );
}

#[test]
fn a_seam_not_yet_seen_leaves_the_slides_at_the_plan_quietly() {
    let mut bench = bench();
    bench.visible = |_, s| s > 100.0;
    bench.prepare();
    bench.tracking = true;
    bench.speed = 100.0;
    while bench.s < 90.0 {
        bench.tick();
    }
    assert!(bench.plant.truth()[0].abs() < 0.005);
    assert_eq!(bench.last.sample.fault, None);
    while bench.s < 120.0 {
        bench.tick();
    }
    assert!((bench.plant.truth()[0] - 0.2).abs() < 0.005);
    assert_eq!(bench.last.sample.fault, None);
}

#[test]
fn a_beam_that_burns_where_no_seam_was_seen_is_reported_with_its_side() {
    let mut bench = bench();
    bench.visible = |side, _| side == 0;
    bench.prepare();
    bench.tracking = true;
    bench.speed = 100.0;
    while bench.s < 50.0 {
        bench.tick();
    }
    bench.beams = [true, false];
    bench.run_ms(20);
    assert_eq!(bench.last.sample.fault, None);
    bench.beams = [true, true];
    bench.run_ms(20);
    let fault = bench.last.sample.fault;
    assert!(
        matches!(fault, Some(TrackerFault::SeamNotSeen { side: 1, .. })),
        "{fault:?}"
    );
}

#[test]
fn a_lost_seam_is_reported_where_it_was_seen_last_and_only_that_side_stops() {
    let mut bench = ready();
    bench.visible = |side, s| side == 0 || s < 100.0;
    bench.tracking = true;
    bench.speed = 100.0;
    while bench.s < 50.0 {
        bench.tick();
    }
    bench.beams = [true; 2];
    while bench.s < 98.5 {
        bench.tick();
        assert_eq!(bench.last.sample.fault, None, "s = {}", bench.s);
    }
    while bench.s < 110.0 {
        bench.tick();
    }
    let Some(TrackerFault::LostSeam { side: 1, s_mm }) = bench.last.sample.fault else {
        panic!("{:?}", bench.last.sample.fault);
    };
    // The last sample lies before 100 mm, and a beam burns on for 6 ms.
    assert!((98.5..=100.0).contains(&s_mm), "{s_mm}");
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    assert_eq!(bench.last.sample.dac[2..], [0, 0]);
    assert!((bench.plant.truth()[0] - 0.2).abs() < 0.005);
    // The fault is kept until it is reset.
    bench.visible = |_, _| true;
    bench.run_ms(300);
    assert!(bench.last.sample.fault.is_some());
    bench.accept(Request::Reset);
    bench.run_ms(10);
    assert_eq!(bench.last.sample.fault, None);
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
}

#[test]
fn a_silent_motion_board_ends_tracking_and_the_slides_stop() {
    let mut bench = tracking();
    bench.linked = false;
    bench.run_ms(19);
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    bench.run_ms(3);
    assert!(matches!(
        bench.last.sample.fault,
        Some(TrackerFault::PathStale { silent_ms: 20..=22 })
    ));
    assert_eq!(bench.controller.state(), TrackerState::Ready);
    bench.run_ms(100);
    let before = bench.plant.truth();
    let captures = bench.captures;
    bench.run_ms(200);
    for (before, after) in before.iter().zip(bench.plant.truth()) {
        assert!((before - after).abs() < 0.001);
    }
    assert_eq!(bench.captures, captures, "no captures without a path position");
}

#[test]
fn a_seam_too_steep_for_the_slides_is_reported_as_saturation() {
    let mut bench = Bench::new(Shape::Straight, |_, s| (0.7 * (s - 100.0).max(0.0), 0.0));
    bench.prepare();
    bench.tracking = true;
    bench.speed = 100.0;
    while bench.s < 112.0 {
        bench.tick();
    }
    assert!(matches!(
        bench.last.sample.fault,
        Some(TrackerFault::Saturated { slide: 0, ms: 51 })
    ));
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
}

#[test]
fn a_slide_may_be_at_its_speed_limit_on_its_first_way_to_the_seam() {
    // 10 mm at 50 mm/s: four times the time after which saturation is a fault on the seam.
    let mut bench = Bench::new(Shape::Straight, |side, _| {
        (if side == 0 { 10.0 } else { -10.0 }, 0.0)
    });
    bench.prepare();
    bench.tracking = true;
    bench.speed = 100.0;
    while bench.s < 80.0 {
        bench.tick();
    }
    assert_eq!(bench.last.sample.fault, None);
    assert!(bench.spot_errors().iter().all(|error| error.abs() < 0.02));
}

#[test]
fn a_seam_beyond_the_soft_limit_is_reported_and_the_slide_stops_there() {
    let mut bench = Bench::new(Shape::Straight, |_, s| (0.1 * (s - 40.0).max(0.0), 0.0));
    bench.prepare();
    bench.tracking = true;
    bench.speed = 100.0;
    while bench.s < 190.0 {
        bench.tick();
    }
    assert!(matches!(
        bench.last.sample.fault,
        Some(TrackerFault::SoftLimit { .. })
    ));
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    assert!((bench.plant.truth()[0] - 12.0).abs() < 0.2);
}

#[test]
fn disable_switches_off_from_every_state() {
    let mut homing = bench();
    homing.accept(Request::ConfigureTracker(config()));
    homing.accept(Request::Home);
    for mut bench in [homing, ready(), tracking()] {
        bench.accept(Request::Disable);
        bench.run_ms(1);
        assert_eq!(bench.controller.state(), TrackerState::Off);
        assert_eq!(bench.last.command, SlideCommand::SAFE);
    }
}

#[test]
fn estop_drive_and_limit_switch_lead_to_fault_and_reset_leads_out() {
    type ChangeInputs = fn(&mut shared::io::SlideFeedback);
    let causes: [(ChangeInputs, TrackerFault); 3] = [
        (|f| f.estop = [false, true], TrackerFault::EmergencyStop),
        (|f| f.drive_fault.set(3, true), TrackerFault::Drive { slide: 3 }),
        (
            |f| f.limit_minus.set(1, true),
            TrackerFault::LimitSwitch {
                slide: 1,
                positive: false,
            },
        ),
    ];
    for (cause, fault) in causes {
        for mut bench in [ready(), tracking()] {
            bench.change_inputs = cause;
            bench.run_ms(1);
            assert_eq!(bench.controller.state(), TrackerState::Fault);
            assert_eq!(bench.last.sample.fault, Some(fault));
            assert_eq!(bench.last.command, SlideCommand::SAFE);
            assert_eq!(bench.ask(Request::Home), wrong_state(TrackerState::Fault));
            bench.accept(Request::Disable);
            assert_eq!(bench.controller.state(), TrackerState::Fault);
            if !matches!(fault, TrackerFault::LimitSwitch { .. }) {
                assert_eq!(
                    bench.ask(Request::Reset),
                    Response::Refused(Refusal::CauseRemains)
                );
            }
            bench.change_inputs = |_| {};
            bench.run_ms(1);
            bench.accept(Request::Reset);
            assert_eq!(bench.controller.state(), TrackerState::Off);
            assert_eq!(bench.status().fault, None);
        }
    }
}

#[test]
fn homing_ends_in_fault_by_estop_or_without_a_mark() {
    let mut stopped = bench();
    stopped.accept(Request::ConfigureTracker(config()));
    stopped.accept(Request::Home);
    stopped.run_ms(10);
    stopped.change_inputs = |f| f.estop = [false, true];
    stopped.run_ms(1);
    assert_eq!(stopped.last.sample.fault, Some(TrackerFault::EmergencyStop));
    assert_eq!(stopped.controller.state(), TrackerState::Fault);

    let mut blind = bench();
    blind.change_inputs = |f| f.mark[2] = None;
    blind.accept(Request::ConfigureTracker(config()));
    blind.accept(Request::Home);
    blind.run_ms(20_000);
    assert_eq!(
        blind.last.sample.fault,
        Some(TrackerFault::MarkNotFound { slide: 2 })
    );
    assert_eq!(blind.controller.state(), TrackerState::Fault);
    assert!(!blind.status().homed);
}

#[test]
fn what_would_disturb_the_weld_is_refused_while_tracking() {
    let mut bench = tracking();
    for request in [
        Request::ConfigureTracker(config()),
        Request::Home,
        Request::ClearPath {
            id: 1,
            space: PathSpace::Tool,
        },
        Request::LoadKnots([Shape::Straight.knot(1000.0)].into_iter().collect()),
    ] {
        assert_eq!(bench.ask(request), wrong_state(TrackerState::Tracking));
    }
    assert_eq!(bench.ask(Request::Hold), Response::Refused(Refusal::NotMine));
    let mut ready = ready();
    assert_eq!(
        ready.ask(Request::ConfigureTracker(config())),
        wrong_state(TrackerState::Ready)
    );
    ready.accept(Request::Home);
    assert_eq!(ready.controller.state(), TrackerState::Homing);
}

#[test]
fn knots_out_of_order_or_one_too_many_are_refused() {
    let mut controller = TrackerController::<2>::new();
    let mut load = |s: f64| {
        let knots = [Shape::Straight.knot(s)].into_iter().collect();
        controller.handle(&Request::LoadKnots(knots), 0)
    };
    assert_eq!(load(0.0), Response::Done);
    assert_eq!(load(0.0), Response::Refused(Refusal::BadKnot { index: 1 }));
    assert_eq!(load(1.0), Response::Done);
    assert_eq!(load(2.0), Response::Refused(Refusal::PathFull { capacity: 2 }));
}

#[test]
fn a_second_run_of_the_same_path_sees_the_seam_anew() {
    let mut bench = tracking();
    bench.tracking = false;
    bench.speed = 0.0;
    bench.s = 0.0;
    bench.seam = |_, _| (-0.3, 0.0);
    bench.run_ms(500);
    bench.tracking = true;
    bench.speed = 100.0;
    bench.run_ms(400);
    assert!((bench.plant.truth()[0] + 0.3).abs() < 0.005);
    assert_eq!(bench.last.sample.fault, None);
}

#[test]
fn measurements_of_forgotten_captures_are_refused_and_counted() {
    let mut bench = tracking();
    let answer = |capture| {
        Datagram::Measurement(Measurement {
            capture,
            sides: [None; 2],
        })
    };
    bench.run_ms(1500);
    let newest = bench.captures - 1;
    bench.controller.datagram(&answer(newest - 255), 0);
    assert_eq!(bench.status().too_old, 0);
    bench.controller.datagram(&answer(newest - 256), 0);
    bench.controller.datagram(&answer(newest + 1), 0);
    assert_eq!(bench.status().too_old, 2);
}

#[test]
fn lost_ticks_are_counted_and_status_answers_for_the_session() {
    let mut bench = ready();
    let before = bench.status();
    bench.controller.tick(&TickInput {
        now_us: 0,
        periods: 3,
        strobed_us: None,
        feedback: Default::default(),
        truth: None,
    });
    let status = bench.status();
    assert_eq!((status.ticks - before.ticks, status.lost - before.lost), (3, 2));
    assert_eq!((status.path_id, status.knots), (PATH_ID, 498));
    assert!(status.clock_settled && status.path_states == 3000 && status.path_states_missing == 0);
}

#[test]
fn every_fifth_tick_is_a_capture_of_that_moment() {
    let mut bench = tracking();
    let before = bench.captures;
    bench.run_ms(500);
    assert_eq!(bench.captures - before, 100);
    while bench.last.capture.is_none() {
        bench.tick();
    }
    let capture = bench.last.capture.unwrap();
    // 30 µs of clock error at 100 mm/s are 3 µm.
    assert!((capture.s_mm - bench.s_now()).abs() < 0.003, "{}", capture.s_mm);
    assert_eq!(capture.truth_mm, Some(bench.plant.truth()));
}

#[test]
fn a_saturation_trip_that_never_comes_is_refused_and_the_longest_is_no_overflow() {
    let mut config = config();
    config.tracking.saturation_trip_ms = u32::MAX;
    let mut bench = bench();
    let refusal = Refusal::Parameter(ParameterError::new(
        "tracking",
        "saturation_trip_ms",
        f64::from(u32::MAX),
    ));
    assert_eq!(
        bench.ask(Request::ConfigureTracker(config.clone())),
        Response::Refused(refusal)
    );
    config.tracking.saturation_trip_ms = 5000;
    bench.prepare_with(config);
    bench.tracking = true;
    bench.speed = 100.0;
    bench.run_ms(50);
    assert_eq!(bench.controller.state(), TrackerState::Tracking);
    assert_eq!(bench.last.sample.fault, None);
}

#[test]
fn a_strobe_is_asked_for_before_the_law_and_what_it_was_late_is_told() {
    let mut bench = tracking();
    assert_eq!(bench.status().strobe_late_us, [0, 0]);
    for late in [7, 3, 30] {
        bench.strobe_late = late;
        bench.run_ms(1);
        while bench.last.capture.is_none() {
            bench.run_ms(1);
        }
        let capture = bench.last.capture.unwrap();
        assert_eq!(capture.time_us, bench.now_us() + late);
        // 100 mm/s, and a clock error of 30 µs.
        let s = bench.s_now() + late as f64 * 1e-4;
        assert!((capture.s_mm - s).abs() < 0.003, "{} {s}", capture.s_mm);
    }
    assert_eq!(bench.status().strobe_late_us, [0, 30]);
    // Due two ticks before the one that was served.
    bench.strobe_late = 5;
    bench.run_ms(2);
    assert!(bench.last.capture.is_none());
    assert!(bench.controller.strobe(5));
    let feedback = bench.plant.advance(&bench.last.command);
    let now_us = bench.now_us() + 5000;
    let output = bench.controller.tick(&TickInput {
        now_us,
        periods: 5,
        strobed_us: Some(now_us + 5),
        feedback,
        truth: None,
    });
    assert_eq!(output.capture.unwrap().time_us, now_us + 5);
    assert_eq!(bench.status().strobe_late_us, [0, 2005]);
}

#[test]
fn what_is_believed_has_bounds() {
    type Change = fn(&mut shared::config::TrackingConfig, f64);
    let path_speed: Change = |tracking, value| tracking.max_path_speed_mm_s = value;
    let deviation: Change = |tracking, value| tracking.max_seam_deviation_mm = value;
    let slope: Change = |tracking, value| tracking.max_seam_slope = value;
    for (field, change, good, bad) in [
        // A picture every 5 ms within 5 mm.
        ("max_path_speed_mm_s", path_speed, [1.0, 1000.0], [0.0, 1001.0]),
        ("max_seam_deviation_mm", deviation, [1.0, 24.0], [0.9, 24.1]),
        ("max_seam_slope", slope, [0.01, 1.0], [0.0, 1.01]),
    ] {
        for (value, good) in good.map(|v| (v, true)).into_iter().chain(bad.map(|v| (v, false))) {
            let mut config = config();
            change(&mut config.tracking, value);
            let expected = if good {
                Response::Done
            } else {
                Response::Refused(Refusal::Parameter(ParameterError::new("tracking", field, value)))
            };
            assert_eq!(
                bench().ask(Request::ConfigureTracker(config)),
                expected,
                "{field} {value}"
            );
        }
    }
}

#[test]
fn cameras_that_answer_each_by_itself_are_believed_once_each() {
    let mut bench = tracking();
    let before = bench.status().accepted;
    for _ in 0..100 {
        let captures = bench.captures;
        bench.tick();
        if bench.captures == captures {
            continue;
        }
        let (at, both) = bench.measurements.pop_back().unwrap();
        let (mut first, mut second) = (both, both);
        (first.sides[1], second.sides[0]) = (None, None);
        bench
            .measurements
            .extend([(at, first), (at, second), (at, first)]);
    }
    let status = bench.status();
    assert!(
        (0..2).all(|side| status.accepted[side] - before[side] >= 10),
        "{status:?}"
    );
    assert_eq!(status.implausible_measurements[1], 0);
    assert!(status.implausible_measurements[0] >= 10, "{status:?}");
}
