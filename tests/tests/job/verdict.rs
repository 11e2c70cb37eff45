//! What a weld along a seam is judged by, where no part file says it: deviation, and what stayed unwelded.

use super::*;
use report::{JudgedBy, sentence};

/// Simulated boards whose gate of side 2 is reported shut on a stretch of the path \[mm\].
struct Shut {
    boards: SimulatedBoards,
    from_s_mm: f64,
    to_s_mm: f64,
}

impl Boards for Shut {
    pass_on!(boards: request, send, now, identity, path_states_target);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let mut received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &mut received {
            for sample in &mut telemetry.samples {
                sample.beams[1] &= !(self.from_s_mm..self.to_s_mm).contains(&sample.s_mm);
            }
        }
        Ok(received)
    }
}

fn exceeded(report: &Report) -> Vec<&'static str> {
    report.exceeded().map(|figure| figure.key).collect()
}

fn figure<'a>(report: &'a Report, key: &str) -> &'a parts::Figure {
    let found = report.figures.iter().find(|figure| figure.key == key);
    found.unwrap_or_else(|| panic!("no {key}\n{report}"))
}

#[test]
fn an_undisturbed_weld_is_within_the_shipped_limits() {
    let ended = undisturbed(&mut SimulatedBoards::default());
    let report = &ended.report;
    assert_eq!(report.judged_by, Some(JudgedBy::ShippedSeamLimits));
    assert_eq!(exceeded(report), [""; 0], "{report}");
    for key in ["unwelded_1_mm", "unwelded_2_mm"] {
        // Some tick's way at either end.
        assert!(figure(report, key).value < 0.2, "{report}");
    }
    assert!((figure(report, "programmed_1_mm").value - 200.0).abs() < 1e-3);
    let text = report.to_string();
    assert!(
        text.contains("none: judged by the limits that are shipped"),
        "{text}"
    );
    let speed = report.speed.expect("beams");
    assert!(
        speed.lowest_percent > 95.0 && speed.highest_percent < 105.0,
        "{speed:?}"
    );
}

#[test]
fn a_spot_beside_its_seam_is_beyond_its_limit_and_is_named_with_its_place() {
    let ended = undisturbed(&mut Troubled::new(Trouble::Bias(0.091), 20.0));
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_eq!(exceeded(&ended.report), ["deviation_u1_mm"], "{}", ended.report);
    let figure = figure(&ended.report, "deviation_u1_mm");
    assert!((figure.value - 0.091).abs() < 0.02, "{figure:?}");
    assert!(
        figure.at_mm.is_some_and(|at| (0.0..200.0).contains(&at)),
        "{figure:?}"
    );
    let told = sentence(figure);
    assert!(
        told.contains("side 1") && told.contains("at s = ") && told.contains("(may be 0.0500 mm)"),
        "{told}"
    );
}

/// The beams go on at 40 mm of the path.
#[test]
fn what_stays_unwelded_is_beyond_its_limit_and_is_named_with_side_and_place() {
    let mut boards = Shut {
        boards: SimulatedBoards::default(),
        from_s_mm: 140.0,
        to_s_mm: 160.0,
    };
    let ended = undisturbed(&mut boards);
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_eq!(
        exceeded(&ended.report),
        ["unwelded_2_mm", "gap_2_mm"],
        "{}",
        ended.report
    );
    let gap = figure(&ended.report, "gap_2_mm");
    assert!((gap.value - 20.0).abs() < 0.3, "{gap:?}");
    assert!(gap.at_mm.is_some_and(|at| (at - 100.0).abs() < 0.2), "{gap:?}");
    assert!(figure(&ended.report, "gap_1_mm").value < 0.2);
}

/// What ends early has its own reason, and the verdict on what was begun beside it; its place is the plots'.
#[test]
fn a_weld_that_ends_early_is_judged_as_far_as_it_came() {
    let ended = undisturbed(&mut Troubled::new(Trouble::Blind, 100.0));
    let Some(JobError::Tracker(TrackerFault::LostSeam { s_mm, .. })) = ended.error else {
        panic!("{:?}", ended.error);
    };
    assert_eq!(ended.report.outcome, Outcome::Failed);
    let keys = exceeded(&ended.report);
    assert!(
        keys.contains(&"unwelded_1_mm") && keys.contains(&"gap_2_mm"),
        "{keys:?}"
    );
    let burnt = ended.evaluation.ticks.iter().filter(|tick| tick.beams[0]);
    let off_mm = burnt.map(|tick| tick.along_mm).fold(0.0, f64::max);
    assert!(
        (f64::from(s_mm) - off_mm).abs() < 1.0,
        "{s_mm} mm, beam off at {off_mm} mm"
    );
    let gap = figure(&ended.report, "gap_1_mm");
    assert!(gap.at_mm.is_some_and(|at| (at - off_mm).abs() < 0.5), "{gap:?}");
}
