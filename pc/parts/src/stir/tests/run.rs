//! Welds on simulated boards: drives, gratings and servo loops included.

use super::*;
use crate::PartFile;
use job::{Job, Names, Silent, Work, run};
use report::{Outcome, Report};
use std::sync::atomic::AtomicBool;
use world::simulated::SimulatedBoards;

/// Runs `program` from the search for the marks to the park position, judged by `part`, and keeps every limit.
fn welded(program: &str, part: &PartFile) -> Report {
    let machine = machine();
    let program = interpret(program, Options::default()).unwrap();
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        part: Some(part),
        speed_m_per_min: None,
        from_line: None,
        surroundings: Default::default(),
        names: Names {
            program: "stir.ngc".into(),
            machine: "stir-gantry.toml".into(),
            seam: None,
            boards: "simulated".into(),
        },
    };
    let mut boards = SimulatedBoards::new("stir-gantry").unwrap();
    let ended = run(&mut boards, &job, &AtomicBool::new(false), &mut Silent).unwrap();
    let report = ended.report;
    assert_eq!(report.outcome, Outcome::Finished, "{report}");
    let exceeded: Vec<_> = report.exceeded().map(|figure| figure.key).collect();
    assert!(exceeded.is_empty(), "{exceeded:?}: {report}");
    report
}

fn value(report: &Report, key: &str) -> f64 {
    let figure = report.figures.iter().find(|figure| figure.key == key);
    figure.unwrap_or_else(|| panic!("no {key}")).value
}

#[test]
fn the_shipped_weld_keeps_its_limits_on_simulated_boards() {
    let text = std::fs::read_to_string(shipped("programs/stir-contour.ngc")).unwrap();
    let part = PartFile::read(&shipped("programs/stir-contour.toml")).unwrap();
    let report = welded(&text, &part);
    // Far below what is published, as gratings close the loops.
    assert!(value(&report, "max_heading_error_deg") < 0.006, "{report}");
    // Most of it is what the output filter of the planner takes where the pin turns.
    assert!(value(&report, "max_contour_distance_mm") < 0.006, "{report}");
    for key in ["mae_x_mm", "mae_y_mm"] {
        assert!(value(&report, key) < 0.002, "{report}");
    }
    assert!((2.5..2.7).contains(&value(&report, "preheat_s")), "{report}");
}

/// A full circle that C cannot turn through at once: the pin is lifted and plunged again at the same place.
#[test]
fn a_weld_in_two_passes_keeps_its_limits_on_simulated_boards() {
    let mut part = circle(0.0, "ccw");
    part.rewind = true;
    let program = plan(&part, &machine()).unwrap().program;
    let file = PartFile {
        part: Part::Stir(Box::new(part)),
        path: PathBuf::from("circle.toml"),
    };
    let report = welded(&program, &file);
    // Both passes start on the arc: the slides stick for the first 5 µm, and C is that much ahead of the tip.
    assert!(value(&report, "max_contour_distance_mm") < 0.005, "{report}");
    assert!(value(&report, "preheat_s") > 2.5, "{report}");
}
