//! Jobs that come to their end, and a light that fails.

use crate::pair::{Pair, assert_served};
use config::machine::JointForm;
use host_link::boards::Boards;
use plant_file::DEFAULT_MACHINE;
use system_tests::{
    JOBS, assert_held_weld_goes_on, assert_on_seam, assert_stops_in_the_dark, assert_within_limits,
    deviations, weld_job, weld_through_pictures,
};
use world::SceneFile;
use world::simulated::SimulatedBoards;

/// Furthest that a spot may be from its seam \[mm\], and from where it is on simulated boards.
const LIMIT_MM: f64 = 0.03;
const AGREE_MM: f64 = 0.01;

/// Welds the shipped seam through pictures.
fn assert_welds(name: &str, speed_m_per_min: f64) {
    let pair = Pair::boot(name, DEFAULT_MACHINE);
    let weld = |boards: &mut dyn Boards| {
        weld_through_pictures(boards, JointForm::Gap, SceneFile::default(), speed_m_per_min)
    };
    let ended = weld(&mut pair.connect());
    assert_on_seam(&ended, LIMIT_MM);
    assert_served(&ended.report);
    let simulated = weld(&mut SimulatedBoards::default());
    let both = deviations(&ended.report)
        .into_iter()
        .zip(deviations(&simulated.report));
    for (here, simulated) in both {
        assert!((here - simulated).abs() < AGREE_MM, "{here} and {simulated} mm");
    }
    pair.assert_off();
}

#[test]
fn the_shipped_job_at_5_m_per_min() {
    assert_welds("weld-5", 5.0);
}

#[test]
fn the_shipped_job_at_9_m_per_min() {
    assert_welds("weld-9", 9.0);
}

#[test]
fn a_held_weld_goes_on_over_the_place() {
    let pair = Pair::boot("hold", DEFAULT_MACHINE);
    let ended = assert_held_weld_goes_on(&mut pair.connect(), 5.0);
    assert_served(&ended.report);
    pair.assert_off();
}

#[test]
fn a_light_that_fails_for_good_ends_the_weld() {
    let mut pair = Pair::boot("dark", DEFAULT_MACHINE);
    assert_stops_in_the_dark(&mut pair.connect(), JointForm::Gap, 9.0);
    pair.end();
}

/// The shipped job of a machine keeps the limits of its part.
#[track_caller]
fn assert_keeps_limits(machine: &str) {
    let (_, job) = JOBS
        .into_iter()
        .find(|(name, _)| *name == machine)
        .expect("a shipped job");
    let pair = Pair::boot(machine, machine);
    let ended = weld_job(&mut pair.connect_motion(), machine, job);
    assert_within_limits(&ended);
    assert_served(&ended.report);
    pair.assert_off();
}

#[test]
fn the_pipe_welder_keeps_the_limits_of_its_saddle() {
    assert_keeps_limits("pipe-welder");
}

#[test]
fn the_wire_arc_machine_keeps_the_limits_of_its_leaf() {
    assert_keeps_limits("wire-arc");
}
