//! The shipped job through pictures, on simulated boards: accuracy, disturbances, a light that fails, the same bytes.

use host_link::boards::simulated::SimulatedBoards;
use host_link::report::CameraFigures;
use host_link::weld::{Ended, JobError};
use host_link::world::{Dark, SceneFile};
use shared::tracking::TrackerFault;
use system_tests::{assert_on_seam, shipped, shipped_seam, weld_in_scene};

fn weld(scene: SceneFile, speed_m_per_min: f64) -> Ended {
    weld_in_scene(
        &mut SimulatedBoards::default(),
        shipped_seam(),
        scene,
        speed_m_per_min,
    )
}

fn pictures(ended: &Ended) -> [CameraFigures; 2] {
    let seam = ended.report.seam.as_ref().expect("a tracker");
    seam.pictures.expect("pictures")
}

#[test]
fn the_shipped_job_stays_on_both_seams_at_5_m_per_min() {
    assert_on_seam(&weld(SceneFile::default(), 5.0), 0.03);
}

#[test]
fn the_shipped_job_stays_on_both_seams_at_9_m_per_min_and_leaves_the_same_bytes_again() {
    let first = weld(SceneFile::default(), 9.0);
    assert_on_seam(&first, 0.03);
    let second = weld(SceneFile::default(), 9.0);
    assert_eq!(first.report, second.report);
    assert!(first.evaluation == second.evaluation);
}

#[test]
fn spatter_scratches_roll_lost_and_late_pictures_and_a_dark_spell_disturb_little() {
    let file = shipped("programs/t-seam-400-disturbed.toml");
    let scene = SceneFile::read(&file).unwrap_or_else(|error| panic!("{error}"));
    let ended = weld(scene, 9.0);
    assert_on_seam(&ended, 0.05);
    for figures in pictures(&ended) {
        assert!(figures.lost > 0 && figures.late > 0, "{figures:?}");
    }
}

#[test]
fn a_light_that_fails_for_good_ends_the_weld_with_its_side_named_and_the_machine_at_rest() {
    let dark = Dark {
        side: 2,
        from_s_mm: 200.0,
        for_ms: None,
    };
    let scene = SceneFile {
        dark: vec![dark],
        ..SceneFile::default()
    };
    let ended = weld(scene, 9.0);
    let Some(error @ JobError::Tracker(TrackerFault::LostSeam { side: 1, .. })) = &ended.error else {
        panic!("{:?}", ended.error);
    };
    assert!(error.to_string().contains("side 2"), "{error}");
    // The map reaches a few millimetres beyond what was seen last.
    let beam = ended
        .evaluation
        .ticks
        .iter()
        .rev()
        .find(|tick| tick.beams[1])
        .expect("a weld");
    assert!(
        (200.0..208.0).contains(&beam.along_mm),
        "beam 2 on to {} mm",
        beam.along_mm
    );
    let last = ended.evaluation.ticks.last().expect("ticks");
    assert_eq!(last.beams, [false; 2]);
    assert!(last.speed_mm_s < 1.0, "{}", last.speed_mm_s);
    let welded = ended.evaluation.ticks.iter().filter(|tick| tick.beams[1]);
    let off = welded
        .filter_map(|tick| tick.deviation_mm[2])
        .fold(0.0, |max: f64, d| max.max(d.abs()));
    assert!(off < 0.1, "spot 2 was {off} mm off with its beam on");
}
