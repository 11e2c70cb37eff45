//! What happens to a board during a weld: it freezes, dies or is reset, or its cable is out. Beams are off in time, the machine
//! stops on its path, and who is blamed is who it was.

use crate::pair::{Pair, status};
use emulator::BoardAction;
use host_link::boards::Boards;
use report::Ended;
use shared::protocol::{MotionSample, Request, Response, Role};
use shared::state::{Fault, State, TrackerFault};
use system_tests::{TappedBoards, shipped_seam, weld};

/// Speed of the welds \[m/min\].
const FAST: f64 = 9.0;
/// Way into the weld at which something happens \[mm\].
const AFTER_MM: f64 = 150.0;
/// A permit is valid for so long on emulated boards \[ms\].
const PERMIT_MS: u32 = 10;

/// Welds, and does `act` once the beams have been on for a while; the last sample of the motion board before.
fn weld_and(pair: &mut Pair, act: impl FnOnce(&mut Pair)) -> (Ended, MotionSample) {
    let mut boards = pair.connect();
    let (mut on_mm, mut last, mut act) = (None, None, Some(act));
    let mut overheard = TappedBoards {
        boards: &mut boards as &mut dyn Boards,
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| {
            if sample.beams == [true; 2] {
                on_mm.get_or_insert(sample.s_mm);
            }
            if on_mm.is_some_and(|on| sample.s_mm >= on + AFTER_MM)
                && let Some(act) = act.take()
            {
                last = Some(*sample);
                act(pair);
            }
        },
    };
    let ended = weld(&mut overheard, shipped_seam(), FAST);
    (ended, last.expect("a weld"))
}

/// A batch of telemetry, and how far emulated boards may be ahead of what the PC has handled: by so much later than the
/// sample that the test acts on, something happens on the boards \[ms\].
const LATE_MS: u32 = 25 + PERMIT_MS;

/// Checks that the machine was stopped by a beam's lost permit, in time after `last`, and stands with its drives off, and
/// that `whom` is blamed.
#[track_caller]
fn assert_shut_in_time(pair: &Pair, ended: &Ended, last: &MotionSample, whom: &str) {
    let error = ended.error.as_ref().expect("an error").to_string();
    let motion = match pair.connect_motion().request(Role::Motion, &Request::Status) {
        Ok(Response::MotionStatus(motion)) => motion,
        other => panic!("{other:?}"),
    };
    match motion.fault {
        Some(Fault::PermitLost { s_mm, .. }) => {
            let way = f64::from(s_mm) - last.s_mm;
            println!("beams off {way:.2} mm after the last telemetry: {error}");
            assert!(way <= last.speed_mm_s * 1e-3 * f64::from(LATE_MS), "{way} mm");
            assert_eq!(motion.state, State::Fault);
        }
        // The PC received it first, and stopped the path.
        fault => assert_eq!((motion.state, fault), (State::Off, None), "{error}"),
    }
    assert!(error.contains(whom), "{error}");
}

#[test]
fn a_tracker_that_freezes_is_reset_dies_or_is_cut_off_shuts_the_beams_in_time() {
    for action in [
        Some(BoardAction::Freeze),
        Some(BoardAction::Reset),
        Some(BoardAction::CableOut),
        None,
    ] {
        println!("{action:?}");
        let mut pair = Pair::boot("tracker-fails");
        let (ended, last) = weld_and(&mut pair, |pair| match action {
            Some(action) => pair.emulated().act(Role::Tracker, action).expect("a board"),
            None => pair.emulated().kill(Role::Tracker).expect("a board"),
        });
        assert_shut_in_time(&pair, &ended, &last, "tracker");
    }
}

#[test]
fn a_motion_board_that_freezes_is_reset_or_dies_is_blamed_and_the_slides_stop() {
    for action in [Some(BoardAction::Freeze), Some(BoardAction::Reset), None] {
        println!("{action:?}");
        let mut pair = Pair::boot("motion-fails");
        let (ended, last) = weld_and(&mut pair, |pair| match action {
            Some(action) => pair.emulated().act(Role::Motion, action).expect("a board"),
            None => pair.emulated().kill(Role::Motion).expect("a board"),
        });
        let error = ended.error.as_ref().expect("an error").to_string();
        println!("{error}");
        assert!(error.contains("motion"), "{error}");
        match action {
            Some(BoardAction::Freeze) => {
                pair.emulated()
                    .act(Role::Motion, BoardAction::GoOn)
                    .expect("a board");
            }
            Some(_) => {}
            None => continue,
        }
        let (motion, tracker) = status(&mut pair.connect());
        assert!(
            matches!(tracker.fault, Some(TrackerFault::PathStale { .. })),
            "{tracker:?}"
        );
        match action {
            // The time of its plant stood still with it, so its first tick afterwards is the one in which no permit comes.
            Some(BoardAction::Freeze) => {
                let Some(Fault::PermitLost { s_mm, .. }) = motion.fault else {
                    panic!("{:?}", motion.fault);
                };
                let way = f64::from(s_mm) - last.s_mm;
                assert!(way <= last.speed_mm_s * 1e-3 * f64::from(LATE_MS), "{way} mm");
            }
            _ => assert_eq!(
                (motion.state, motion.fault, motion.homed),
                (State::Off, None, false)
            ),
        }
    }
}

#[test]
fn a_motion_board_that_is_cut_off_stops_by_itself() {
    let mut pair = Pair::boot("motion-cut-off");
    let cut = |pair: &mut Pair| {
        pair.emulated()
            .act(Role::Motion, BoardAction::CableOut)
            .expect("a board");
    };
    let (ended, last) = weld_and(&mut pair, cut);
    pair.emulated()
        .act(Role::Motion, BoardAction::CableIn)
        .expect("a board");
    // The session that was cut off keeps its place until its lease has run out.
    assert_shut_in_time(&pair, &ended, &last, "motion");
}
