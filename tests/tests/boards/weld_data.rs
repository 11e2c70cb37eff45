//! Welds with weld data: subroutine and work offset, ramps, crater fill, tacks, weave, two passes.

use crate::pair::{Pair, assert_served};
use system_tests::weld_data::{
    WeldDataRun, assert_butt_joint, assert_switched, assert_two_pass_saddle, two_pass_saddle,
};

#[test]
fn a_butt_joint_is_welded_as_its_set_says_and_switched_within_a_tenth_of_a_millisecond() {
    let mut pair = Pair::for_jobs("weld-data-joint", "wire-arc");
    let run = WeldDataRun::butt_joint(&mut pair.connect_without_tracker());
    assert_butt_joint(&run);
    assert_switched(&run, 2);
    assert_served(&run.ended.report);
    pair.assert_off();
}

#[test]
fn a_saddle_is_welded_in_two_passes_as_its_sets_say() {
    let mut pair = Pair::for_jobs("weld-data-saddle", "pipe-welder");
    let run = two_pass_saddle(&mut pair.connect_without_tracker());
    assert_two_pass_saddle(&run);
    assert_served(&run.ended.report);
    pair.assert_off();
}
