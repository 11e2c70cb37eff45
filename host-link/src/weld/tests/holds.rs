//! A hold in the middle of a weld.

use super::*;
use crate::boards::overheard::Overheard;
use shared::motion::State;
use shared::protocol::MotionSample;

/// The beams go off before the motion is slower than they may be on, the machine stops on the path, and goes over
/// the place again at the speed of the weld; the seam is followed all the time.
#[test]
fn a_weld_goes_on_over_the_place_where_it_was_held() {
    for hold_at_mm in [60.0, 140.0] {
        // Told by the motion board since the operator held the weld; the operator goes on some time later.
        let mut since = Vec::<MotionSample>::new();
        let mut stood = 0;
        let mut boards = Overheard {
            boards: SimulatedBoards::default(),
            hear: |boards: &mut SimulatedBoards, sample: &MotionSample| {
                let holds = since.is_empty() && sample.beams[0] && sample.s_mm >= hold_at_mm;
                if holds || !since.is_empty() {
                    since.push(*sample);
                }
                if holds {
                    command(boards, Role::Motion, &Request::Hold).unwrap();
                }
                stood += i32::from(sample.state == State::Holding && sample.speed_mm_s == 0.0);
                if stood == 301 {
                    command(boards, Role::Motion, &Request::Resume).unwrap();
                }
            },
        };
        let ended = undisturbed(&mut boards);
        assert!(ended.error.is_none(), "{:?}", ended.error);
        for max in ended.evaluation.max_deviation_mm {
            assert!(max.unwrap() < 0.02, "{:?}", ended.evaluation.max_deviation_mm);
        }
        let machine = machine();
        let slowest = machine.motion.beams[0].as_ref().unwrap().min_speed_mm_s;
        let path = since[0].path_id;
        assert!(
            since
                .iter()
                .all(|s| s.beams == [false; 2] || s.speed_mm_s >= slowest)
        );
        let welded = |s: &&MotionSample| s.path_id == path && s.beams == [true; 2];
        // Running again after the hold.
        let again = since.iter().rposition(|s| s.state == State::Holding).unwrap() + 1;
        let off = since[..again].iter().rev().find(welded).unwrap();
        let on = since[again..].iter().find(welded).unwrap();
        let overlap = off.s_mm - on.s_mm;
        assert!((1.5..=2.2).contains(&overlap), "{overlap} mm");
        assert!(on.speed_mm_s > 0.94 * off.speed_mm_s, "{} mm/s", on.speed_mm_s);
        // 200 mm of seam, and the overlap.
        let length = ended.report.weld_length_mm;
        assert!((length - 202.0).abs() < 0.5, "{length} mm");
    }
}

/// Ten times the time of the path at its feed, and a hold of a minute.
#[test]
fn a_low_override_and_a_long_hold_take_what_they_take() {
    let program = "G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nF5000\nG1 X1180\nM2";
    let mut held = 0;
    let mut boards = Overheard {
        boards: SimulatedBoards::default(),
        hear: |boards: &mut SimulatedBoards, sample: &MotionSample| {
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
    let never = AtomicBool::new(false);
    let ended = run_on(&mut boards, &machine(), program, None, &never, &mut Silent).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    // 280 mm at 5 m/min are 3.36 s.
    let motion_s = ended.report.motion_s;
    assert!(motion_s > 90.0, "{motion_s} s");
}
