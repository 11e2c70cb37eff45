//! Holds and overrides of a job.

use super::*;
use shared::protocol::MotionSample;
use shared::state::State;

/// Ten times the time of the path at its feed, and a hold of a minute.
#[test]
fn a_low_override_and_a_long_hold_take_what_they_take() {
    let program = "G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nF5000\nG1 X1180\nM2";
    let mut held = 0;
    let mut boards = TappedBoards {
        boards: &mut SimulatedBoards::default(),
        on_sample: |boards: &mut dyn Boards, sample: &MotionSample| {
            let feeds = sample.path_id == 2;
            held += i32::from(feeds && sample.state == State::Holding);
            let request = match (feeds, held, sample.s_mm) {
                (false, ..) => return,
                (true, 0, 0.0..1.0) => Request::Override { factor: 0.1 },
                (true, 0, 100.0..) => Request::Hold,
                (true, 60_000, _) => Request::Resume,
                _ => return,
            };
            command(boards, Role::Motion, &request).unwrap();
        },
    };
    let ended = run_on(&mut boards, &machine(), program, None, &mut NoOperator).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    // 280 mm at 5 m/min are 3.36 s.
    let motion_s = ended.report.motion_s;
    assert!(motion_s > 90.0, "{motion_s} s");
}
