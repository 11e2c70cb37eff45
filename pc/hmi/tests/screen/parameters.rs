//! Parameters of the machine file at the screen: looked for, changed, written, restored.

use crate::bench::{Bench, PROGRAM};
use eframe::egui::Key;
use egui_kittest::kittest::{NodeT, Queryable};
use hmi::live::What;
use hmi::screen::Page;
use std::path::Path;

const JERK: &str = "axes.X.max_jerk =";

fn text(file: &Path) -> String {
    std::fs::read_to_string(file).expect("readable")
}

fn version(file: &Path, number: &str) -> std::path::PathBuf {
    file.with_file_name(format!("dual-beam-gantry.toml.{number}"))
}

/// The page, with the jerk of X typed as `value`.
fn with_jerk(bench: &mut Bench, value: &str) {
    bench.open(Page::Parameters);
    bench.type_in("Search", "X.max_jerk");
    bench.tap_containing(JERK);
    bench.type_in("Value", value);
    bench.key(Key::Enter);
}

fn is_greyed(bench: &Bench, button: &str) -> bool {
    bench.harness.get_by_label(button).accesskit_node().is_disabled()
}

#[test]
fn a_parameter_is_found_refused_changed_written_and_on_record_and_the_next_job_has_it() {
    let (mut bench, file) = Bench::with_own_file();
    bench.load(PROGRAM);
    let before = text(&file);
    bench.open(Page::Parameters);
    assert!(bench.says(JERK) && bench.says("motors.X1.home.velocity ="));
    bench.type_in("Search", "X.MAX_jerk");
    assert!(bench.says(JERK) && !bench.says("axes.Y.max_jerk ="));
    bench.tap_containing(JERK);
    for told in ["150 … 6000000", "assumed", "mm/s³"] {
        assert!(bench.says(told), "{told}");
    }

    bench.type_in("Value", "fast");
    bench.key(Key::Enter);
    assert!(bench.says("Must be a number"));
    assert!(bench.says("None."));
    bench.type_in("Value", "1");
    bench.key(Key::Enter);
    assert!(bench.says("max_jerk of axis X is 1, but must be from 150 to 6000000"));
    assert!(bench.says("✖ axes.X.max_jerk = 1.0"));
    assert!(is_greyed(&bench, "Write…"));

    bench.type_in("Value", "40000");
    bench.key(Key::Enter);
    assert!(!bench.says("Refused"));
    assert!(bench.says("● axes.X.max_jerk = 40000.0 mm/s³"));
    assert!(bench.says("axes.X.max_jerk: 30000.0 → 40000.0"));
    // Nothing is written by one touch.
    bench.tap("Write…");
    assert_eq!(text(&file), before);
    bench.tap("Cancel");
    assert_eq!(text(&file), before);
    bench.tap("Write…");
    assert!(bench.says("dual-beam-gantry.toml.0001"));
    bench.tap("Write now");

    let after = before.replacen("max_jerk = 30000.0 # assumed", "max_jerk = 40000.0 # assumed", 1);
    assert_ne!(after, before);
    assert_eq!(text(&file), after);
    assert_eq!(text(&version(&file, "0001")), before);
    assert!(bench.says("None."));
    let entries = bench.station().live.journal.entries();
    let written: Vec<_> = entries
        .filter_map(|entry| match &entry.what {
            What::Parameter(change) => Some(change.clone()),
            _ => None,
        })
        .collect();
    let [change] = &*written else {
        panic!("{written:?}");
    };
    assert_eq!(change.key, "axes.X.max_jerk");
    assert_eq!(
        (change.old.as_deref(), change.new.as_deref()),
        (Some("30000.0"), Some("40000.0"))
    );

    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    let jerk = |bench: &mut Bench| {
        let loaded = bench.station().loaded().cloned().expect("loaded");
        loaded.machine.motion.axes[0].clone().expect("X").max_jerk
    };
    assert_eq!(jerk(&mut bench), 40_000.0);
    bench.open(Page::Alarms);
    assert!(bench.says("axes.X.max_jerk: 30000.0 → 40000.0"));

    // The version before is restored as any other change.
    bench.open(Page::Parameters);
    bench.tap("Backups…");
    bench.tap("dual-beam-gantry.toml.0001: 1 other values");
    assert!(bench.says("axes.X.max_jerk: 40000.0 → 30000.0"));
    assert_eq!(text(&file), after);
    bench.tap("Write…");
    bench.tap("Write now");
    assert_eq!(text(&file), before);
    assert_eq!(text(&version(&file, "0002")), after);
    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    assert_eq!(jerk(&mut bench), 30_000.0);
}

#[test]
fn nothing_is_written_while_a_job_runs() {
    let (mut bench, file) = Bench::with_own_file();
    let before = text(&file);
    bench.weld(PROGRAM);
    bench.until("a beam is on", |station| station.live.beam_is_on());
    bench.key(Key::F2);
    with_jerk(&mut bench, "40000");
    assert!(bench.says("axes.X.max_jerk: 30000.0 → 40000.0"));
    assert!(bench.says("A job runs"));
    assert!(is_greyed(&bench, "Write…") && is_greyed(&bench, "Backups…"));
    assert!(!is_greyed(&bench, "Discard"));
    bench.tap("Write…");
    assert!(!bench.says("Write now"));
    // Stop is in sight, and ends it.
    bench.tap("STOP");
    bench.until("the job is over", |station| !station.is_running());
    assert!(!is_greyed(&bench, "Write…"));
    bench.tap("Discard");
    assert!(bench.says("None.") && is_greyed(&bench, "Write…"));
    assert_eq!(text(&file), before);
}

#[test]
fn a_file_that_was_changed_on_the_disk_is_not_written_over() {
    let (mut bench, file) = Bench::with_own_file();
    bench.load(PROGRAM);
    with_jerk(&mut bench, "40000");
    let older = "The loaded program was planned before";
    assert!(!bench.says(older));
    bench.tap("Write…");
    let theirs = text(&file).replacen("link_timeout_ms = 500", "link_timeout_ms = 600", 1);
    std::fs::write(&file, &theirs).expect("written");
    bench.tap("Write now");
    assert_eq!(text(&file), theirs);
    assert!(!version(&file, "0001").exists());
    assert!(bench.says("The file on the disk has changed since it was loaded."));
    assert!(bench.harness.query_by_label("Write…").is_none());
    bench.tap("Discard and load anew");
    assert!(bench.says("None."));
    bench.type_in("Search", "link_timeout");
    assert!(bench.says("link_timeout_ms = 600 ms"));
    // What a job would run with is not what is shown.
    assert!(bench.says(older));
    bench.load(PROGRAM);
    bench.open(Page::Parameters);
    assert!(!bench.says(older));
}

#[test]
fn a_machine_that_cannot_run_the_program_any_more_leaves_none_loaded() {
    let (mut bench, _file) = Bench::with_own_file();
    bench.load(PROGRAM);
    bench.open(Page::Parameters);
    // For all that the reader knows the head may be so long, but Z goes nowhere with it.
    bench.type_in("Search", "o3_mm");
    bench.tap_containing("o3_mm =");
    bench.type_in("Value", "[0.0, 0.0, -4500.0]");
    bench.key(Key::Enter);
    assert!(!bench.says("Refused"));
    bench.tap("Write…");
    bench.tap("Write now");
    bench.until("it is refused", |station| station.refused().is_some());
    assert!(bench.station().loaded().is_none());
}

#[test]
fn all_of_it_is_done_by_keys() {
    let (mut bench, file) = Bench::with_own_file();
    bench.open(Page::Parameters);
    bench.type_in("Search", "X.max_jerk");
    // Past the three choices of what is listed.
    for _ in 0..4 {
        bench.key(Key::Tab);
    }
    assert!(bench.harness.get_by_label_contains(JERK).is_focused());
    bench.key(Key::Space);
    bench.type_in("Value", "40000");
    bench.key(Key::Enter);
    let mut tabs = 0..20;
    while !bench.harness.get_by_label("Write…").is_focused() {
        assert!(tabs.next().is_some(), "no way to Write…");
        bench.key(Key::Tab);
    }
    bench.key(Key::Enter);
    let mut tabs = 0..20;
    while !bench.harness.get_by_label("Write now").is_focused() {
        assert!(tabs.next().is_some(), "no way to Write now");
        bench.key(Key::Tab);
    }
    bench.key(Key::Enter);
    assert!(text(&file).contains("max_jerk = 40000.0"));
}
