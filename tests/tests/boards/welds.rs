//! Jobs that come to their end.

use crate::pair::{Pair, assert_served};
use config::machine::JointForm;
use host_link::boards::Boards;
use plant_file::{COMMISSIONED, DEFAULT_MACHINE, PlantChoice};
use report::Ended;
use system_tests::{
    assert_held_weld_goes_on, assert_on_seam, assert_stops_in_the_dark, deviations, seam, short_lines, sines,
    weld, weld_before_a_sleeper, weld_commissioned, weld_disturbed, weld_through_pictures,
};
use world::SceneFile;
use world::simulated::SimulatedBoards;

/// Does `job` on a pair of boards and on simulated ones: no spot is ever further than `limit_mm` from its seam, and both agree. The
/// pair and how it ended there.
fn assert_welds(name: &str, limit_mm: f64, job: impl Fn(&mut dyn Boards) -> Ended) -> (Pair, Ended) {
    assert_welds_on(&PlantChoice::Shipped, name, limit_mm, job)
}

/// The same, where `plant` is true of the machine.
fn assert_welds_on(
    plant: &PlantChoice,
    name: &str,
    limit_mm: f64,
    job: impl Fn(&mut dyn Boards) -> Ended,
) -> (Pair, Ended) {
    let file = plant.of(DEFAULT_MACHINE).expect("a plant");
    let mut pair = Pair::for_jobs_on(plant, name, DEFAULT_MACHINE);
    assert_eq!(pair.session().plant, plant.to_string());
    let ended = job(&mut pair.connect());
    assert_on_seam(&ended, limit_mm);
    assert_served(&ended.report);
    let figures = ended.report.seam.as_ref().expect("a tracker");
    assert_eq!(figures.measurements.given_up, 0);
    let simulated = job(&mut SimulatedBoards::wired_to(&file));
    let both = deviations(&ended.report)
        .into_iter()
        .zip(deviations(&simulated.report));
    for (here, simulated) in both {
        assert!((here - simulated).abs() < 0.01, "{here} and {simulated} mm");
    }
    pair.assert_off();
    (pair, ended)
}

#[test]
fn the_shipped_job_at_5_m_per_min() {
    assert_welds("weld-5", 0.03, |boards| {
        weld_through_pictures(boards, JointForm::Gap, SceneFile::default(), 5.0)
    });
}

#[test]
fn the_shipped_job_at_9_m_per_min_and_again_before_a_subscriber_that_sleeps() {
    let (mut pair, alone) = assert_welds("weld-9", 0.03, |boards| {
        weld_through_pictures(boards, JointForm::Gap, SceneFile::default(), 9.0)
    });
    let (watched, lost) = weld_before_a_sleeper(&mut pair.connect(), 9.0);
    assert_served(&watched.report);
    assert!(lost > 1000, "{lost}");
    let both = deviations(&alone.report)
        .into_iter()
        .zip(deviations(&watched.report));
    for (alone, watched) in both {
        assert!((alone - watched).abs() < 0.003, "{alone} and {watched} mm");
    }
    pair.assert_off();
}

/// What `cargo xtask weld` does, at the highest speed.
#[test]
fn the_shipped_job_at_9_m_per_min_on_a_usual_machine_that_was_commissioned() {
    let plant = COMMISSIONED.of(DEFAULT_MACHINE).expect("a plant");
    assert_welds_on(&COMMISSIONED, "weld-commissioned", 0.04, |boards| {
        weld_commissioned(boards, &plant, 9.0)
    });
}

#[test]
fn the_disturbed_job_at_9_m_per_min() {
    assert_welds("weld-disturbed", 0.05, |boards| {
        weld_disturbed(boards, JointForm::Gap, 9.0)
    });
}

#[test]
fn a_light_that_fails_for_good_ends_the_weld() {
    let mut pair = Pair::for_jobs("dark", DEFAULT_MACHINE);
    assert_stops_in_the_dark(&mut pair.connect(), JointForm::Gap, 9.0);
    pair.check();
}

#[test]
fn a_held_weld_goes_on_over_the_place() {
    let mut pair = Pair::for_jobs("hold", DEFAULT_MACHINE);
    let ended = assert_held_weld_goes_on(&mut pair.connect(), 5.0);
    assert_served(&ended.report);
    pair.assert_off();
}

#[test]
fn sines_of_1_mm_at_9_m_per_min() {
    assert_welds("weld-sines", 0.05, |boards| weld(boards, seam(sines), 9.0));
}

#[test]
fn short_lines_at_6_m_per_min() {
    let mut pair = Pair::for_jobs("short-lines", DEFAULT_MACHINE);
    let ended = short_lines(&mut pair.connect());
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_served(&ended.report);
    let contour = ended.report.max_contour_error_mm.expect("no gap");
    assert!(contour < 0.05, "{contour} mm");
    pair.assert_off();
}
