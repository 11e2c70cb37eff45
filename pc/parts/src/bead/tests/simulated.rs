//! The shipped leaf on simulated boards: drives, gratings and servo loops included.

use super::*;
use crate::PartFile;
use job::{Job, Names, Silent, Work, run};
use report::{Outcome, Report};
use std::sync::atomic::AtomicBool;
use world::simulated::SimulatedBoards;

/// Welds a program of the leaf.
fn welded(text: &str, machine: &MachineFile) -> Report {
    let program = interpret(text, Options::default()).unwrap();
    let part = PartFile::read(&shipped("programs/leaf.toml")).unwrap();
    let job = Job {
        machine,
        work: Work::Program(&program),
        part: Some(&part),
        speed_m_per_min: None,
        from_line: None,
        surroundings: Default::default(),
        names: Names {
            program: "leaf.ngc".into(),
            machine: "wire-arc.toml".into(),
            seam: None,
            boards: "simulated".into(),
        },
    };
    let mut boards = SimulatedBoards::new("wire-arc").unwrap();
    run(&mut boards, &job, &AtomicBool::new(false), &mut Silent)
        .unwrap()
        .report
}

fn value(report: &Report, key: &str) -> f64 {
    let figure = report.figures.iter().find(|figure| figure.key == key);
    figure.unwrap_or_else(|| panic!("no {key}")).value
}

#[test]
fn the_shipped_leaf_stays_inside_the_window_and_on_the_nurbs() {
    let text = std::fs::read_to_string(shipped("programs/leaf.ngc")).unwrap();
    let report = welded(&text, &machine());
    assert_eq!(report.outcome, Outcome::Finished, "{report}");
    let exceeded: Vec<_> = report.exceeded().map(|figure| figure.key).collect();
    assert!(exceeded.is_empty(), "{exceeded:?}: {report}");
    assert_eq!(value(&report, "length_outside_window_percent"), 0.0, "{report}");
    assert!(value(&report, "speed_fluctuation_rms_percent") < 0.3, "{report}");
    assert!(value(&report, "speed_fluctuation_max_percent") < 4.0, "{report}");
    // The output filter of the planner takes most of it, in the sharpest corners.
    assert!(value(&report, "contour_error_max_mm") < 0.015, "{report}");
    assert!(
        (value(&report, "bead_length_mm") - 353.95).abs() < 0.1,
        "{report}"
    );
}

/// Where the window cannot be kept, the report says so, with the slowest place.
#[test]
fn corners_below_the_window_are_found_in_the_report() {
    let mut slow = machine();
    slow.planning.path_jerk_mm_s3 = 300.0;
    let program = plan(&leaf(), &slow).unwrap().program;
    let report = welded(&program, &machine());
    assert_eq!(report.outcome, Outcome::Finished, "{report}");
    let exceeded: Vec<_> = report.exceeded().map(|figure| figure.key).collect();
    assert_eq!(exceeded, ["length_outside_window_percent"], "{report}");
    assert!(
        (3.1..3.3).contains(&value(&report, "slowest_in_corners_mm_s")),
        "{report}"
    );
    // Friction turns with an axis: the slower the tip, the more it is felt.
    assert!(value(&report, "speed_fluctuation_rms_percent") < 0.6, "{report}");
    assert!(value(&report, "contour_error_max_mm") < 0.01, "{report}");
}
