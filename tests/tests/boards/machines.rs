//! Boards wired to another machine than the dual-beam gantry.

use crate::pair::{Pair, assert_served, scratch};
use plant_file::PlantChoice;
use std::fs;
use system_tests::plate::{self, MEASURE, OverPlate};
use system_tests::{JOBS, assert_within_limits, weld_job};

/// The shipped job of a machine keeps the limits of its part.
#[track_caller]
pub fn assert_welds(machine: &str) {
    let (_, job) = JOBS
        .into_iter()
        .find(|(name, _)| *name == machine)
        .expect("a shipped job");
    let mut pair = Pair::for_jobs(&format!("job-{machine}"), machine);
    let ended = weld_job(&mut pair.connect_without_tracker(), machine, job);
    assert_within_limits(&ended);
    assert_served(&ended.report);
    pair.assert_off();
}

#[test]
fn the_pipe_welder_keeps_the_limits_of_its_saddle() {
    assert_welds("pipe-welder");
}

#[test]
fn the_wire_arc_machine_keeps_the_limits_of_its_leaf() {
    assert_welds("wire-arc");
}

#[test]
fn the_stir_gantry_keeps_the_limits_of_its_contour() {
    assert_welds("stir-gantry");
}

#[test]
fn the_laser_cutter_finds_a_plate_by_touching_it() {
    let plant = scratch("plate.plant.toml");
    fs::write(&plant, plate::plant()).expect("a plant file");
    let mut pair = Pair::for_jobs_on(&PlantChoice::File(plant), "plate", "ac-head");
    let found = OverPlate::run(&mut pair.connect_without_tracker(), MEASURE, None);
    found.assert_found();
    assert_served(&found.ended.report);
    pair.assert_off();
}
