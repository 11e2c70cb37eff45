//! Panels taught and cut.

use super::*;
use toml::{Table, Value};

/// The shipped panel with every so many of its guide points, changed by `change`.
fn part(every: usize, change: impl Fn(&mut Table)) -> PartFile {
    let mut file: Table = text("programs/panel.toml").parse().unwrap();
    let panel = file["panel"].as_table_mut().unwrap();
    let guide: Vec<Value> = guides(panel).iter().step_by(every).cloned().collect();
    *guides(panel) = guide;
    change(panel);
    PartFile::parse(&shipped("programs/panel.toml"), &file.to_string()).unwrap()
}

fn guides(panel: &mut Table) -> &mut Vec<Value> {
    panel["guide"].as_array_mut().unwrap()
}

fn taught(part: &PartFile, work: Work, operator: &mut dyn Operator) -> Ended {
    made(&machine("ac-head"), work, part, operator)
}

fn teach(part: &PartFile) -> Ended {
    taught(part, Work::Teach, &mut NoOperator)
}

#[test]
fn a_panel_is_taught_and_cut_within_its_limits() {
    let part = part(3, |_| {});
    let ended = taught(&part, Work::TeachAndMake, &mut NoOperator);
    let report = &ended.report;
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_eq!(report.outcome, Outcome::Finished, "{report}");
    assert_eq!(exceeded(report), [""; 0], "{report}");
    let value = |key: &str| value(report, key);
    assert_eq!(ended.taught.points.len(), 6);
    assert!(value("max_focus_error_cut_mm") < 0.01, "{report}");
    assert!(value("max_focus_error_turn_mm") < 0.008, "{report}");
    assert!(value("max_normal_error_deg") < 0.3, "{report}");
    assert!(value("max_inclination_deg") > 35.0, "{report}");
    assert!(value("taught_points_per_min") > 3.0, "{report}");
    assert!(ended.taught.program.is_some_and(|text| text.contains("M62 P0")));
}

/// What is said of guide points on the third of which is something wrong; the first two are kept.
fn told(axis: usize, value: f64) -> String {
    let ended = teach(&part(6, |panel| guides(panel)[2][axis] = value.into()));
    assert_eq!(ended.taught.points.len(), 2);
    assert_eq!(ended.report.outcome, Outcome::Failed);
    ended.error.unwrap().to_string()
}

#[test]
fn what_ends_teaching_names_its_point() {
    let text = told(1, 860.0);
    assert!(text.starts_with("teaching ended: point 3 (X"), "{text}");
    assert!(text.contains("too far"), "{text}");
    let text = told(0, 2990.0);
    assert!(
        text.starts_with("teaching ended: point 3") && text.contains('X'),
        "{text}"
    );
}

#[test]
fn what_cannot_be_taught_at_all_is_said_before_the_machine_moves() {
    let error = |part: &PartFile| teach(part).error.unwrap().to_string();
    let text = error(&part(1, |panel| guides(panel).clear()));
    assert!(text.contains("no guide points"), "{text}");
    let text = error(&part(1, |panel| {
        drop(panel.insert("taught".into(), "taught.csv".into()))
    }));
    assert!(text.contains("nothing to teach"), "{text}");
    let text = error(&part(1, |panel| panel["teaching"]["readings"] = 3.into()));
    assert!(text.contains("readings is 3"), "{text}");
    let ended = teach(&part(1, |panel| drop(panel.remove("simulated_surface"))));
    assert!(ended.error.unwrap().to_string().contains("simulated_surface"));
    assert!(!ended.began);
}

/// Presses Ctrl-C on the second point.
struct Stopper;

impl Operator for Stopper {
    fn event(&mut self, event: &Event, remote: &Remote) {
        if let Event::Phase(Phase::TeachingPoint { number: 2, .. }) = event {
            remote.send(Command::Stop).unwrap();
        }
    }
}

#[test]
fn the_operator_ends_teaching_and_keeps_what_was_taught() {
    let ended = taught(&part(6, |_| {}), Work::Teach, &mut Stopper);
    assert!(matches!(ended.error, Some(JobError::Interrupted)));
    assert_eq!(ended.taught.points.len(), 1);
    assert!(ended.taught.part.is_none());
}
