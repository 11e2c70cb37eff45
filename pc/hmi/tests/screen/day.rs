//! A day at the screen, on simulated boards, without a window: tapped as an operator taps.

use crate::bench::{Bench, PROGRAM};
use eframe::egui::ViewportId;
use egui_kittest::kittest::Queryable;
use hmi::station::{Action, Station};
use shared::state::State;
use std::time::Duration;

fn along_mm(station: &Station) -> f64 {
    station.live.along_mm().unwrap_or(0.0)
}

#[test]
fn load_weld_hold_back_override_resume_finish_and_look_at_the_record() {
    let mut bench = Bench::new();
    bench.tap("Load…");
    bench.tap("t-seam-400.ngc");
    bench.until("the program is loaded", |station| station.loaded().is_some());

    // Nothing moves by one touch.
    bench.tap("Start…");
    assert!(!bench.station().is_running());
    bench.tap("Cancel");
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("half is welded", |station| along_mm(station) > 200.0);
    assert!(bench.harness.query_by_label("BEAM ON").is_some());

    bench.tap("Hold");
    bench.until("the machine is held", |station| {
        station.live.state() == Some(State::Holding)
    });
    bench.until("it stands", |station| {
        station.live.newest.is_some_and(|newest| newest.speed_mm_s == 0.0)
    });
    let held_at = along_mm(bench.station());
    bench.tap("Back");
    bench.until("it is back", |station| along_mm(station) < held_at - 1.0);
    bench.tap("50");
    bench.tap("Resume");
    bench.until("it welds on", |station| station.live.beam_is_on());
    bench.until("it is past the hold", |station| {
        along_mm(station) > held_at + 20.0
    });
    let speed = bench.station().live.newest.expect("a tick").speed_mm_s;
    assert!(
        (speed - 5.0e3 / 60.0 / 2.0).abs() < 1.0,
        "half of 5 m/min, not {speed} mm/s"
    );

    bench.until("the job is over", |station| !station.is_running());
    let last = bench.station().last().expect("an outcome");
    assert_eq!(last.error, None);
    // Half of the feed is less than the part allows: said, and not called good.
    let report = last.report.as_ref().expect("a report");
    let outside: Vec<&str> = report.exceeded().map(|figure| figure.text).collect();
    assert_eq!(outside, ["speed below the feed, beam on"]);
    assert!(
        bench
            .harness
            .query_by_label("Finished, OUTSIDE its limits")
            .is_some()
    );

    bench.tap("Welds");
    assert!(
        bench
            .harness
            .query_by_label_contains("side 1, of it not welded")
            .is_some()
    );
}

#[test]
fn a_stop_by_key_ends_the_job_with_beams_off_and_is_told_until_it_is_acknowledged() {
    let mut bench = Bench::new();
    bench.weld(PROGRAM);
    bench.until("a beam is on", |station| station.live.beam_is_on());
    bench.key(eframe::egui::Key::F1);
    bench.until("the job is over", |station| !station.is_running());
    assert!(!bench.station().live.beam_is_on());
    let told = "stopped by the operator; beams are off and the machine is at rest";
    assert!(bench.harness.query_all_by_label(told).next().is_some());
    bench.tap("Alarms (1)");
    bench.tap("Acknowledge");
    assert!(bench.harness.query_by_label("No alarms.").is_some());
}

#[test]
fn a_job_begins_at_the_line_that_was_tapped_or_says_at_once_why_not() {
    let mut bench = Bench::new();
    bench.load(PROGRAM);
    bench.station().load(PROGRAM.into(), Some(60));
    bench.until("it is refused", |station| !station.is_loading());
    let refused = bench.station().refused().expect("a reason");
    assert!(
        refused.contains("line 60") && refused.contains("start from line 17"),
        "{refused}"
    );

    bench.tap_containing("  14 N");
    bench.until("it is loaded", |station| !station.is_loading());
    assert_eq!(bench.station().refused(), None);
    assert_eq!(
        bench.station().loaded().and_then(|loaded| loaded.drawn.from_line),
        Some(14)
    );
    bench.tap("Start…");
    assert!(
        bench
            .harness
            .query_by_label("t-seam-400.ngc, from line 14")
            .is_some()
    );
    bench.tap("Weld now");
    bench.until("the job is over", |station| !station.is_running());
    assert_eq!(bench.station().last().expect("an outcome").error, None);
    let welded_mm = bench
        .station()
        .live
        .deviations
        .bins()
        .last()
        .map(|(along_mm, _)| along_mm);
    assert!(welded_mm.is_some_and(|mm| mm > 399.0), "{welded_mm:?}");
}

#[test]
fn in_single_block_it_waits_and_says_for_what() {
    let mut bench = Bench::new();
    bench.load(PROGRAM);
    bench.tap("Single block");
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("it waits", |station| station.live.question.is_some());
    assert!(bench.harness.query_by_label_contains("Waiting before").is_some());
    bench.tap("Resume");
    bench.until("it goes on", |station| station.live.question.is_none());
    bench.until("it waits again", |station| station.live.question.is_some());
    bench.tap("STOP");
    bench.until("the job is over", |station| !station.is_running());
}

/// Where nothing moves on the screen, it is drawn 20 times a second and not as often as it can be: also at the end of a
/// program, where the list of its lines cannot be scrolled on.
#[test]
fn at_the_last_lines_of_a_program_the_screen_is_not_drawn_without_a_pause() {
    let mut bench = Bench::new();
    let program = bench.folder.path().join("long.ngc");
    let comments = "(nothing)\n".repeat(100);
    std::fs::write(
        &program,
        format!("G21 G90\n{comments}G0 X400 Y300 Z250\nM0\nM2\n"),
    )
    .expect("written");
    bench.load(program.to_str().expect("text"));
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("it waits", |station| station.live.question.is_some());
    bench.harness.run_steps(20);
    let output = bench.harness.output();
    let again = output.viewport_output[&ViewportId::ROOT].repaint_delay;
    assert!(again > Duration::ZERO);
    bench.tap("STOP");
    bench.until("the job is over", |station| !station.is_running());
}

#[test]
fn a_program_that_cannot_be_run_is_refused_with_its_place_and_the_one_before_stays() {
    let mut bench = Bench::new();
    bench.load(PROGRAM);
    let wrong = bench.folder.path().join("wrong.ngc");
    std::fs::write(&wrong, "G21 G90\nG1 X1 F\n").expect("written");
    bench.station().load(wrong, None);
    bench.until("it is refused", |station| station.refused().is_some());
    let refused = bench.station().refused().expect("a reason").to_owned();
    assert!(
        refused.contains("wrong.ngc") && refused.contains("line 2"),
        "{refused}"
    );
    let said = format!("Not loaded: {refused}");
    assert!(bench.harness.query_by_label(&said).is_some());
    assert!(bench.station().loaded().is_some());
}

#[test]
fn without_a_job_there_is_nothing_to_ask_but_to_load() {
    let mut bench = Bench::new();
    let now = std::time::Duration::ZERO;
    for action in [
        Action::Start,
        Action::Stop,
        Action::Hold,
        Action::Resume,
        Action::Back,
        Action::Override,
    ] {
        assert!(!bench.station().may(action, now), "{action:?}");
    }
    assert!(bench.station().may(Action::Load, now));
}

#[test]
fn another_machine_has_no_cameras_on_its_page_and_welds_as_well() {
    let mut bench = Bench::of("stir-gantry");
    bench.weld("../../programs/stir-contour.ngc");
    bench.until("the spindle is on", |station| station.live.beam_is_on());
    assert!(bench.harness.query_by_label("Camera 1").is_none());
    bench.until("the job is over", |station| !station.is_running());
    assert_eq!(bench.station().last().expect("an outcome").error, None);
}
