//! The job that begins with a lesson of a ranging probe, which the real board has no input for yet.

use crate::machines::assert_welds;

#[test]
fn the_ac_head_keeps_the_limits_of_its_panel() {
    assert_welds("ac-head");
}
