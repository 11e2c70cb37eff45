//! The shipped job of every machine without a tracker, on simulated boards: from its marks to its park position,
//! within the limits of its part.

use system_tests::{JOBS, assert_within_limits, weld_job};
use world::simulated::SimulatedBoards;

#[test]
fn every_shipped_job_keeps_the_limits_of_its_part() {
    for (machine, job) in JOBS {
        let mut boards = SimulatedBoards::new(machine).unwrap_or_else(|error| panic!("{error}"));
        assert_within_limits(&weld_job(&mut boards, machine, job));
    }
}
