//! The shipped leaf on simulated boards: drives, gratings and servo loops included.

use super::*;
use crate::boards::simulated::SimulatedBoards;
use crate::part::PartFile;
use crate::report::{Outcome, Report};
use crate::weld::{Job, Names, Silent, Work, run};
use std::sync::atomic::AtomicBool;

fn welded() -> Report {
    let machine = machine();
    let text = std::fs::read_to_string(shipped("programs/leaf.ngc")).unwrap();
    let program = interpret(&text, Options::default()).unwrap();
    let part = PartFile::read(&shipped("programs/leaf.toml")).unwrap();
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        part: Some(&part),
        speed_m_per_min: None,
        seed: 1,
        seam: None,
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
    let report = welded();
    assert_eq!(report.outcome, Outcome::Finished, "{report}");
    let exceeded: Vec<_> = report.exceeded().map(|figure| figure.key).collect();
    assert!(exceeded.is_empty(), "{exceeded:?}: {report}");
    assert_eq!(value(&report, "length_outside_window_percent"), 0.0, "{report}");
    assert!(value(&report, "speed_fluctuation_rms_percent") < 0.3, "{report}");
    assert!(value(&report, "speed_fluctuation_max_percent") < 4.0, "{report}");
    assert!(value(&report, "contour_error_max_mm") < 0.01, "{report}");
    assert!(
        (value(&report, "bead_length_mm") - 353.95).abs() < 0.1,
        "{report}"
    );
}
