//! One day at one screen, from power on to a start at a line, on simulated boards.

use crate::bench::{Bench, waits};
use eframe::egui::Key;
use hmi::screen::Page;
use hmi::station::Station;
use host_link::events::Question;
use shared::state::State;
use std::path::Path;

const PROGRAM: &str = "lap-joint.ngc";
const PART: &str = "lap-joint.toml";
/// Where the first pass is welded.
const WELDON: &str = "  14 N80 WELDON=root";
const JERK: &str = "axes.X.max_jerk =";
/// Pace of simulated boards at which a screen that is drawn twice a second still sees a weld every few millimetres.
const SEEN: f64 = 20.0;

fn x_mm(station: &Station) -> Option<f64> {
    station.live.motion.as_ref().map(|motion| motion.reference[0])
}

fn along_mm(station: &Station) -> f64 {
    station.live.along_mm().unwrap_or(0.0)
}

/// Taps a step, and waits until it is done.
fn step(bench: &mut Bench, direction: &str) {
    let before = x_mm(bench.station());
    bench.tap(direction);
    bench.until("it has moved", |station| {
        waits(station) && x_mm(station) != before
    });
}

fn home(bench: &mut Bench) {
    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    bench.tap("Arm the panel");
    bench.tap("10");
}

/// Starts what is loaded, and draws until its torch is on.
fn start(bench: &mut Bench) {
    bench.open(Page::Run);
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("it welds", |station| station.live.beam_is_on());
}

fn finish(bench: &mut Bench) {
    bench.until("the job is over", |station| !station.is_running());
    assert_eq!(bench.station().last().expect("an outcome").error, None);
    assert!(bench.station().live.journal.open_alarms().next().is_none());
}

/// The text of a file.
fn text(file: &Path) -> String {
    std::fs::read_to_string(file).expect("readable")
}

#[test]
fn from_power_on_to_a_start_at_a_line() {
    let (mut bench, machine) = Bench::with_own_file_of("wire-arc");
    let programs = bench.folder.path().join("programs");
    std::fs::create_dir(&programs).expect("a folder");
    for file in [PROGRAM, PART, "lap-joint-taught.csv", "welddata.toml"] {
        std::fs::copy(format!("../../programs/{file}"), programs.join(file)).expect("copied");
    }
    bench.station().programs.clone_from(&programs);

    // Power on, home, jog.
    home(&mut bench);
    step(&mut bench, "X +");

    // Load, which checks and predicts; weld, hold, back, override, resume, finish.
    bench.open(Page::Run);
    bench.tap("Load…");
    bench.tap(PROGRAM);
    bench.until("it is loaded", |station| station.loaded().is_some());
    assert!(bench.says("Predicted"));
    start(&mut bench);
    bench.until("a third is welded", |station| along_mm(station) > 40.0);
    bench.tap("Hold");
    bench.until("it is held", |station| {
        station.live.state() == Some(State::Holding)
    });
    bench.until("it stands", |station| {
        station.live.newest.is_some_and(|newest| newest.speed_mm_s == 0.0)
    });
    let held_mm = along_mm(bench.station());
    bench.tap("Back");
    bench.until("it is back", |station| along_mm(station) < held_mm - 1.0);
    bench.tap("75");
    bench.tap("Resume");
    bench.until("it waits, since that is too slow for the weld", |station| {
        station.live.question == Some(Question::FeedTooLow)
    });
    bench.tap("100");
    bench.tap("Resume");
    finish(&mut bench);
    bench.open(Page::Welds);
    assert!(bench.says("0001-lap-joint"));

    // Change a parameter.
    bench.open(Page::Parameters);
    bench.type_in("Search", "X.max_jerk");
    bench.tap_containing(JERK);
    bench.type_in("Value", "12345");
    bench.key(Key::Enter);
    bench.tap("Write…");
    bench.tap("Write now");
    assert!(text(&machine).contains("max_jerk = 12345.0"));
    bench.until("it is planned anew", |station| !station.is_loading());

    // Alarm and recovery.
    start(&mut bench);
    bench.key(Key::F1);
    bench.until("the job is over", |station| !station.is_running());
    bench.tap("Alarms (1)");
    bench.tap("Acknowledge");
    assert!(bench.says("No alarms."));

    // Teach a seam, and plan it.
    home(&mut bench);
    bench.block("G0 X-60 Y-20 Z10");
    bench.open(Page::Teach);
    bench.tap("Part…");
    bench.tap(PART);
    bench.tap("Begin anew…");
    bench.tap("Take out");
    bench.tap("Arm the panel");
    bench.tap("Work");
    bench.tap("10");
    bench.tap("Take");
    for _ in 0..8 {
        step(&mut bench, "X +");
    }
    bench.tap("Take");
    bench.tap("Plan program");
    bench.until("it is planned", |station| !station.is_loading());
    assert_eq!(bench.station().refused(), None);
    assert!(bench.says("is planned"));
    assert_ne!(
        text(&programs.join(PROGRAM)),
        text(&programs.join("lap-joint.ngc.0001"))
    );

    // Weld it from its first weld on, slowly enough to be seen in every pass.
    bench.station().place.pace = SEEN;
    bench.open(Page::Run);
    bench.tap_containing(WELDON);
    bench.until("it is loaded", |station| !station.is_loading());
    assert_eq!(bench.station().refused(), None);
    start(&mut bench);
    let mut farthest_mm = 0.0;
    bench.until("the job is over", |station| {
        farthest_mm = along_mm(station).max(farthest_mm);
        !station.is_running()
    });
    finish(&mut bench);
    assert!(farthest_mm > 80.0, "the second pass, not {farthest_mm} mm");

    // All of it is on record.
    let record = text(&bench.folder.path().join("record.tsv"));
    assert!(
        record.contains("axes.X.max_jerk") && record.contains("stopped by the operator"),
        "{record}"
    );
}
