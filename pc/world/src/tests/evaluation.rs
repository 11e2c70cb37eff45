//! Records of which the figures are known.

use super::{axes_at, machine, motion_sample, tracker_sample};
use crate::TrueSeams;
use crate::seams::tests::{bent_path, heads, wavy_seam};
use cam::path::{PlannedPath, TooFast};
use evaluate::{Evaluation, Followed, RecordedRun, RunSample, RunSamples, WorkTick, evaluate};
use host_link::record::{MachinePosition, Record, Recorded};
use nc::Motion;
use shared::io::{SIDES, SLIDES};
use shared::protocol::{MotionSample, PathAction, PathEvent};
use shared::trajectory::{PathSpace, SpeedLimits};
use std::collections::BTreeMap;

/// A seam tick's machine: axes that hold the pose of the path at s, and slides that sit on the seam.
fn follow(record: &mut Record, tick: u32, s: f64, off: [f64; SLIDES], tracker_ahead_us: u64) {
    let (machine, seam) = (machine(), wavy_seam());
    let (pose, _) = seam.planned(s).unwrap();
    let axes = axes_at(&pose);
    let mut sample = motion_sample(tick);
    sample.path_id = 7;
    sample.s_mm = s;
    sample.truth = Some([axes[0], axes[0], axes[1], axes[2], axes[3], axes[4], axes[5]]);
    sample.following_error[2] = 0.001 * tick as f32;
    sample.skew_mm = 0.01;
    record.add_motion(&[sample]);

    let mut slides = off;
    for side in 0..SIDES {
        let pose = machine.pose(&MachinePosition::Axes(axes));
        let crossing = seam.crossing(side, &heads().spot(&pose, side), 0.0).unwrap();
        slides[2 * side] += crossing.u;
        slides[2 * side + 1] += crossing.v;
    }
    let mut sample = tracker_sample(tick);
    sample.time_us += tracker_ahead_us;
    sample.truth_mm = Some(slides);
    sample.slides_mm = [99.0; SLIDES];
    record.add_tracker(&[sample]);
}

fn job(off: [f64; SLIDES], tracker_ahead_us: u64) -> Recorded {
    let mut record = Record::default();
    for tick in 1..=50 {
        follow(
            &mut record,
            tick,
            150.0 + 0.1 * f64::from(tick),
            off,
            tracker_ahead_us,
        );
    }
    record.finish()
}

/// The samples of `job`, each of the motion board's changed.
fn changed(job: &Recorded, change: impl Fn(&mut MotionSample)) -> Recorded {
    let mut record = Record::default();
    for mut sample in job.motion() {
        change(&mut sample);
        record.add_motion(&[sample]);
    }
    job.tracker()
        .iter()
        .for_each(|sample| record.add_tracker(&[sample]));
    record.finish()
}

fn ticks(result: &Evaluation) -> Vec<WorkTick> {
    result.ticks.iter().collect()
}

fn evaluated(record: &Recorded, tracker_ahead_us: i64) -> Evaluation {
    let seams = TrueSeams::of([wavy_seam()]);
    let followed = Followed {
        seams: &seams,
        tracker_ahead_us,
    };
    evaluate(
        record,
        &machine(),
        &BTreeMap::from([(7, planned())]),
        Some(followed),
    )
}

/// The bent path, with a beam from 100 mm on.
fn planned() -> PlannedPath {
    let knots = (0..=100).map(|k| {
        let s_mm = 5.0 * f64::from(k);
        let point = bent_path().at(s_mm).unwrap();
        shared::trajectory::Knot {
            s_mm,
            value: point.value,
            slope: point.first,
        }
    });
    PlannedPath {
        motion: Motion::Feed,
        space: PathSpace::Tool,
        waits_before: Vec::new(),
        dwell_before_s: 0.0,
        probe: None,
        fixed_feed: false,
        corner_deg: None,
        knots: knots.collect(),
        lines: vec![],
        events: vec![PathEvent {
            s_mm: 100.0,
            action: PathAction::Beam { side: 0, on: true },
        }],
        steps: Vec::new(),
        limits: SpeedLimits {
            velocity: 100.0,
            acceleration: 500.0,
            jerk: 10_000.0,
        },
        bound: None,
        too_fast: TooFast::default(),
        speed_error: 0.0,
        start_s: 0.0,
        start_actions: Vec::new(),
        blocks: None,
    }
}

#[test]
fn spots_on_the_seam_have_no_deviation_and_a_tip_on_the_path_no_contour_error() {
    let result = evaluated(&job([0.0; 4], 0), 0);
    assert_eq!((result.weld_ticks, result.unknown_ticks), (50, 0));
    assert!((result.weld_length_mm - 4.9).abs() < 1e-9);
    for max in result.max_deviation_mm {
        assert!(max.unwrap() < 1e-8, "{max:?}");
    }
    assert!(result.max_contour_error_mm.unwrap() < 1e-8);
    assert!((result.max_following_error[2] - 0.05).abs() < 1e-6);
    assert!((result.max_skew_mm - 0.01).abs() < 1e-6);
}

#[test]
fn deviation_is_spot_minus_seam_of_each_slide() {
    let off = [0.03, -0.02, 0.01, 0.04];
    let result = evaluated(&job(off, 0), 0);
    for (i, off) in off.into_iter().enumerate() {
        assert!((ticks(&result)[20].deviation_mm[i].unwrap() - off).abs() < 1e-8);
        assert!((result.max_deviation_mm[i].unwrap() - off.abs()).abs() < 1e-8);
        assert!((result.rms_deviation_mm[i].unwrap() - off.abs()).abs() < 1e-8);
    }
}

#[test]
fn the_clocks_of_the_boards_may_differ() {
    let result = evaluated(&job([0.0; 4], 5_000_000), 5_000_000);
    assert!(result.max_deviation_mm[0].unwrap() < 1e-8);
    let wrong = evaluated(&job([0.0; 4], 5_000_000), 0);
    assert_eq!((wrong.unknown_ticks, wrong.max_deviation_mm), (50, [None; 4]));
}

#[test]
fn a_side_counts_only_with_its_beam_on() {
    let record = changed(&job([0.03; 4], 0), |sample| sample.beams = [true, false]);
    let result = evaluated(&record, 0);
    assert!(result.max_deviation_mm[0].is_some() && result.max_deviation_mm[1].is_some());
    assert_eq!(result.max_deviation_mm[2..], [None, None]);
    assert!(
        ticks(&result)[0].deviation_mm[2].is_some(),
        "but it is in the log"
    );
}

#[test]
fn without_a_tracker_there_is_still_the_path() {
    let record = job([0.0; 4], 0);
    let paths = BTreeMap::from([(7, planned())]);
    let result = evaluate(&record, &machine(), &paths, None);
    assert_eq!((result.weld_ticks, result.unknown_ticks), (50, 0));
    assert_eq!(result.max_deviation_mm, [None; SLIDES]);
    assert!(result.max_contour_error_mm.unwrap() < 1e-8);
    assert!(
        (ticks(&result)[0].along_mm - 50.1).abs() < 1e-9,
        "{}",
        ticks(&result)[0].along_mm
    );
    assert!((result.motion_s - 0.050).abs() < 1e-9);
    let machine = machine();
    let samples = |paths| -> Vec<RunSample> {
        let run = RecordedRun {
            record: &record,
            machine: &machine,
            paths,
        };
        run.iter().collect()
    };
    let nothing = BTreeMap::new();
    let none = samples(&nothing);
    let samples = samples(&paths);
    assert_eq!((samples.len(), samples[9].path_id), (50, 7));
    let (pose, _) = wavy_seam().planned(samples[9].s_mm).unwrap();
    assert!((samples[9].pose.position - pose.position).norm() < 1e-8);
    assert!(none.is_empty());
}

#[test]
fn without_beams_every_tick_of_a_feed_counts() {
    let record = changed(&job([0.0; 4], 0), |sample| sample.beams = [false; SIDES]);
    let mut path = planned();
    path.events.clear();
    let result = evaluate(&record, &machine(), &BTreeMap::from([(7, path)]), None);
    assert_eq!(result.weld_ticks, 50);
    assert!(result.max_contour_error_mm.unwrap() < 1e-8);
    assert!((ticks(&result)[0].along_mm - 150.1).abs() < 1e-9);
}
