//! The shipped job on closed corners, seen in pictures, on simulated boards.

use config::machine::JointForm;
use report::Ended;
use system_tests::{assert_on_seam, assert_stops_in_the_dark, weld_disturbed, weld_through_pictures};
use world::SceneFile;
use world::simulated::SimulatedBoards;

fn weld(scene: SceneFile, speed_m_per_min: f64) -> Ended {
    weld_through_pictures(
        &mut SimulatedBoards::default(),
        JointForm::Corner,
        scene,
        speed_m_per_min,
    )
}

#[test]
fn the_shipped_job_stays_on_both_closed_corners_at_5_m_per_min() {
    assert_on_seam(&weld(SceneFile::default(), 5.0), 0.03);
}

#[test]
fn it_does_so_at_9_m_per_min_on_rolled_and_blasted_walls() {
    let finishes = SceneFile::parse("scene.toml", "texture = [\"rolled\", \"blasted\"]");
    assert_on_seam(
        &weld(finishes.unwrap_or_else(|error| panic!("{error}")), 9.0),
        0.03,
    );
}

#[test]
fn spatter_scratches_roll_lost_and_late_pictures_and_a_dark_spell_disturb_little() {
    let ended = weld_disturbed(&mut SimulatedBoards::default(), JointForm::Corner, 9.0);
    assert_on_seam(&ended, 0.05);
}

#[test]
fn where_the_light_of_a_side_fails_for_good_the_weld_ends_with_the_side_named() {
    assert_stops_in_the_dark(&mut SimulatedBoards::default(), JointForm::Corner, 9.0);
}
