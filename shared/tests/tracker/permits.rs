//! What the tracker lets the beams do.

use crate::bench::{Bench, Shape, config};
use shared::config::TrackerConfig;
use shared::protocol::BeamPermit::{Keep, No, Open};
use shared::protocol::{BeamPermit, Request, Response};
use shared::state::{TrackerFault, TrackerState};

fn straight(_side: usize, _s: f64) -> (f64, f64) {
    (0.3, -0.2)
}

fn sides(bench: &Bench) -> [BeamPermit; 2] {
    bench.last.permit.expect("the motion board is heard").sides
}

/// On the seam with both sides, at 83 mm/s.
fn locked() -> Bench {
    let mut bench = Bench::new(Shape::Straight, straight);
    bench.prepare();
    bench.tracking = true;
    bench.speed = 5000.0 / 60.0;
    bench.run_ms(400);
    assert_eq!(sides(&bench), [Open; 2]);
    bench
}

#[test]
fn a_lock_needs_a_seam_that_was_seen_and_slides_on_it() {
    let mut bench = Bench::new(Shape::Straight, straight);
    // Side 2 sees nothing before 30 mm.
    bench.visible = |side, s| side == 0 || s > 30.0;
    bench.prepare();
    assert_eq!(sides(&bench), [No; 2], "not tracking");
    bench.tracking = true;
    bench.speed = 50.0;
    let mut locked_at = [f64::NAN; 2];
    while bench.s < 60.0 {
        bench.tick();
        for side in 0..2 {
            let off = bench.spot_errors()[2 * side..2 * side + 2]
                .iter()
                .fold(0.0f64, |most, e| most.max(e.abs()));
            match sides(&bench)[side] {
                Open => {
                    assert!(off <= config().tracking.lock_mm + 0.05, "{off} mm");
                    if locked_at[side].is_nan() {
                        locked_at[side] = bench.s;
                    }
                }
                Keep => {}
                // What two path states in a row have to say.
                No => assert_ne!(bench.last.sample.state, TrackerState::Tracking),
            }
        }
    }
    // The map reaches window and hold, 5 mm, back from what was seen first, 10 mm ahead.
    assert!(locked_at[0] < 20.0, "{locked_at:?}");
    assert!((24.0..40.0).contains(&locked_at[1]), "{locked_at:?}");
    // The permit answers the newest path state.
    assert_eq!(bench.last.permit.map(|p| p.path_id), Some(bench.path_id));
}

#[test]
fn every_fault_ends_the_permit_of_both_sides_at_the_next_tick() {
    type Fails = fn(&mut Bench);
    let faults: [(Fails, u32); 4] = [
        (
            |bench| bench.change_inputs = |feedback| feedback.drive_fault.set(1, true),
            1,
        ),
        (
            |bench| bench.change_inputs = |feedback| feedback.estop = [true; 2],
            1,
        ),
        // Nothing is received from the motion board: `stale_path_ms` later.
        (|bench| bench.linked = false, 23),
        (|bench| bench.controller.session_ended(), 1),
    ];
    for (fails, ms) in faults {
        let mut bench = locked();
        fails(&mut bench);
        bench.run_ms(ms);
        assert_eq!(sides(&bench), [No; 2]);
        assert!(bench.status().fault.is_some());
    }
}

#[test]
fn a_seam_that_is_lost_under_the_beam_ends_the_permit() {
    let mut bench = Bench::new(Shape::Straight, straight);
    bench.visible = |side, s| side == 1 || s < 60.0;
    bench.prepare();
    bench.tracking = true;
    bench.speed = 50.0;
    bench.run_ms(400);
    bench.beams = [true; 2];
    while sides(&bench) != [No; 2] {
        assert!(bench.s < 66.0, "{:?}", sides(&bench));
        bench.tick();
    }
    // Seen to 60 mm, and no beam goes on where nothing was seen.
    assert!((59.0..60.2).contains(&bench.s), "{}", bench.s);
    assert!(matches!(
        bench.status().fault,
        Some(TrackerFault::LostSeam { side: 0, .. })
    ));
}

#[test]
fn a_lock_must_be_closer_than_the_gate() {
    let mut wide: TrackerConfig = config();
    wide.tracking.lock_mm = wide.tracking.gate_mm * 1.01;
    let mut bench = Bench::new(Shape::Straight, straight);
    let answer = bench.ask(Request::ConfigureTracker(wide));
    assert!(matches!(answer, Response::Refused(_)), "{answer:?}");
}

#[test]
fn with_nobody_in_charge_the_slides_go_off_also_at_rest() {
    let mut bench = Bench::new(Shape::Straight, straight);
    bench.prepare();
    bench.run_ms(5000);
    assert!(bench.last.command.enable);
    bench.controller.session_ended();
    bench.run_ms(1990);
    assert!(bench.last.command.enable);
    bench.run_ms(20);
    assert!(!bench.last.command.enable);
    assert_eq!(bench.last.sample.state, TrackerState::Fault);
    assert_eq!(
        bench.status().fault,
        Some(TrackerFault::Unattended { seconds: 2 })
    );
}

#[test]
fn a_search_for_the_marks_ends_with_its_session() {
    let mut bench = Bench::new(Shape::Straight, straight);
    bench.accept(Request::ConfigureTracker(config()));
    bench.accept(Request::Home);
    bench.run_ms(20);
    assert!(bench.last.command.enable);
    bench.controller.session_ended();
    bench.run_ms(1);
    assert!(!bench.last.command.enable);
    assert_eq!(bench.status().fault, Some(TrackerFault::SessionEnded));
}
