//! Welds with weld data on simulated boards; those on emulated ones are judged in the same way.

use system_tests::weld_data::{
    WeldDataRun, assert_butt_joint, assert_switched, assert_two_pass_saddle, two_pass_saddle,
};
use world::simulated::SimulatedBoards;

#[test]
fn the_butt_joint_is_welded_as_its_sets_say() {
    let run = WeldDataRun::butt_joint(&mut SimulatedBoards::new("wire-arc").expect("a machine"));
    assert_butt_joint(&run);
    assert_switched(&run, 2);
}

/// The published saddle in two passes along one seam: a subroutine, and two sets.
#[test]
fn the_saddle_is_welded_in_two_passes_from_one_seam() {
    let run = two_pass_saddle(&mut SimulatedBoards::new("pipe-welder").expect("a machine"));
    assert_two_pass_saddle(&run);
}
