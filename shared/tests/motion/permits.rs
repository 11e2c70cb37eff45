//! Beams where the path tracks: on by the tracker's permit only, and off in time without it.

use super::bench::{Bench, Y};
use shared::io::MotionCommand;
use shared::protocol::{BeamPermit, Datagram, PERMIT_US, PathAction, PathEvent, PathJoin, Permit, Request};
use shared::state::{Fault, NoPermit, State};
use shared::trajectory::PathSpace;

/// Where the beam goes on \[mm\].
const ON: f64 = 40.0;
/// A datagram is under way for so long \[servo ticks\].
const TRANSIT: usize = 2;

/// A line of 300 mm along Y that tracks all the way, with beam 1 from [`ON`] on.
fn tracked() -> Bench {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let element = bench.along_y(0.0, 300.0, 150.0, PathJoin::Stop);
    bench.loaded(&super::bench::load(element, true));
    let events = [
        (0.0, PathAction::Tracking { on: true }),
        (
            0.0,
            PathAction::Power {
                side: 0,
                watt: 2000.0,
            },
        ),
        (ON, PathAction::Beam { side: 0, on: true }),
    ];
    let events = events.map(|(s_mm, action)| PathEvent { s_mm, action });
    bench.loaded(&Request::LoadEvents(events.into_iter().collect()));
    bench.run();
    bench
}

/// A quarter of a millisecond; where a path state was published the tracker answers it with `side` half a millisecond
/// later.
fn answered(bench: &mut Bench, under_way: &mut Vec<(usize, Permit)>, side: Option<BeamPermit>) {
    let before = bench.path_state.map(|state| state.tick);
    bench.servo_tick();
    let state = bench.path_state.expect("a path tick");
    for (left, _) in under_way.iter_mut() {
        *left -= 1;
    }
    if let Some((0, permit)) = under_way.first().copied() {
        under_way.remove(0);
        let lease = bench.controller.datagram(&Datagram::Permit(permit), bench.now_us);
        bench.servo.renew(lease.expect("a lease"));
    }
    if let (true, Some(side)) = (before != Some(state.tick), side) {
        let permit = Permit {
            tick: state.tick,
            path_id: state.path_id,
            sides: [side, BeamPermit::No],
        };
        under_way.push((TRANSIT, permit));
    }
}

/// Runs until the gate opens, with a lock.
fn burning() -> (Bench, Vec<(usize, Permit)>) {
    let (mut bench, mut under_way) = (tracked(), Vec::new());
    for _ in 0..4000 {
        answered(&mut bench, &mut under_way, Some(BeamPermit::Open));
        if bench.command.beam_gate[0] {
            return (bench, under_way);
        }
    }
    panic!("no beam: {:?}", bench.status());
}

/// Goes on with `side` until the gate is shut; after how many servo ticks that was.
fn until_shut(bench: &mut Bench, under_way: &mut Vec<(usize, Permit)>, side: Option<BeamPermit>) -> u32 {
    for ticks in 0..200 {
        answered(bench, under_way, side);
        if !bench.command.beam_gate[0] {
            return ticks + 1;
        }
    }
    panic!("the beam stays on: {:?}", bench.status());
}

#[test]
fn with_a_permit_the_beam_is_on_from_its_place_to_the_end() {
    let (mut bench, mut under_way) = burning();
    let s = bench.status().s_mm;
    assert!((s - ON).abs() < 0.4, "{s}");
    // It keeps burning where the tracker only lets it stay on, as behind a jump of the seam.
    while bench.controller.state() == State::Running {
        assert!(
            bench.command.beam_gate[0] || bench.speed() < 5.5,
            "at {:?}",
            bench.status()
        );
        answered(&mut bench, &mut under_way, Some(BeamPermit::Keep));
        bench.status();
    }
    assert_eq!((bench.controller.state(), bench.fault()), (State::Idle, None));
}

#[test]
fn without_a_lock_the_beam_never_opens_and_the_machine_stops() {
    for (side, why) in [
        (None, NoPermit::Silent),
        (Some(BeamPermit::No), NoPermit::Refused),
        (Some(BeamPermit::Keep), NoPermit::NotOnSeam),
    ] {
        let (mut bench, mut under_way) = (tracked(), Vec::new());
        while bench.controller.state() != State::Fault {
            answered(&mut bench, &mut under_way, side);
            assert!(!bench.command.beam_gate[0], "{side:?}");
            bench.status();
        }
        let Some(Fault::NotLocked {
            side: 0,
            s_mm,
            why: seen,
        }) = bench.fault()
        else {
            panic!("{:?}", bench.fault());
        };
        assert!(
            (f64::from(s_mm) - ON).abs() < 0.4 && seen == why,
            "{s_mm} {seen:?}"
        );
    }
}

#[test]
fn a_tracker_that_falls_silent_shuts_the_beam_5_ms_after_the_last_path_state_it_answered() {
    let (mut bench, mut under_way) = burning();
    for _ in 0..40 {
        answered(&mut bench, &mut under_way, Some(BeamPermit::Open));
    }
    under_way.truncate(0);
    // The last that arrived answers a tick half a millisecond ago at least.
    let ticks = until_shut(&mut bench, &mut under_way, None);
    let us = ticks * 250 + 500;
    assert!((PERMIT_US - 1500..=PERMIT_US).contains(&us), "{us} µs");
    bench.stops_on_the_path_then_faults();
    assert!(
        matches!(
            bench.fault(),
            Some(Fault::PermitLost {
                side: 0,
                why: NoPermit::Silent,
                ..
            })
        ),
        "{:?}",
        bench.fault()
    );
}

#[test]
fn a_tracker_that_answers_only_where_the_machine_was_before_is_told_from_one_that_is_silent() {
    let (mut bench, mut under_way) = burning();
    for _ in 0..40 {
        answered(&mut bench, &mut under_way, Some(BeamPermit::Open));
    }
    let before = bench.path_state.expect("a path");
    let permit = Permit {
        tick: before.tick,
        path_id: before.path_id,
        sides: [BeamPermit::Open; 2],
    };
    for ms in 0..=PERMIT_US / 1000 + 1 {
        if let Some(lease) = bench.controller.datagram(&Datagram::Permit(permit), bench.now_us) {
            bench.servo.renew(lease);
        }
        bench.run_ms(1);
        assert!(ms >= PERMIT_US / 1000 - 1 || bench.command.beam_gate[0], "{ms}");
    }
    assert!(!bench.command.beam_gate[0] && bench.speed() > 50.0);
    bench.stops_on_the_path_then_faults();
    assert!(
        matches!(
            bench.fault(),
            Some(Fault::PermitLost {
                side: 0,
                why: NoPermit::Outdated,
                ..
            })
        ),
        "{:?}",
        bench.fault()
    );
}

#[test]
fn a_permit_that_is_taken_back_shuts_the_beam_at_the_next_servo_tick() {
    for given_again in [false, true] {
        let (mut bench, mut under_way) = burning();
        for _ in 0..40 {
            answered(&mut bench, &mut under_way, Some(BeamPermit::Open));
        }
        let mut told = |side| {
            let answered = bench.path_state.expect("a path");
            let permit = Permit {
                tick: answered.tick,
                path_id: answered.path_id,
                sides: [side, BeamPermit::No],
            };
            let lease = bench.controller.datagram(&Datagram::Permit(permit), bench.now_us);
            bench.servo.renew(lease.expect("a lease"));
            bench.servo_tick();
        };
        told(BeamPermit::No);
        if given_again {
            told(BeamPermit::Open);
        }
        assert!(!bench.command.beam_gate[0] && bench.speed() > 100.0);
        bench.stops_on_the_path_then_faults();
        assert!(
            matches!(
                bench.fault(),
                Some(Fault::PermitLost {
                    side: 0,
                    why: NoPermit::Refused,
                    ..
                })
            ),
            "given again: {given_again}, {:?}",
            bench.fault()
        );
    }
}

#[test]
fn a_lost_permit_or_two_do_not_shut_the_beam() {
    let (mut bench, mut under_way) = burning();
    for tick in 0..800 {
        // Two of four are lost.
        if tick % 16 < 8 {
            under_way.clear();
        }
        answered(&mut bench, &mut under_way, Some(BeamPermit::Open));
        bench.status();
        assert!(bench.command.beam_gate[0], "{tick} {:?}", bench.fault());
    }
}

#[test]
fn the_end_of_the_session_stops_the_path_at_once_with_the_beam_off_at_the_next_servo_tick() {
    for wait in 0..4 {
        let mut bench = Bench::welding();
        for _ in 0..wait {
            bench.servo_tick();
        }
        bench.controller.session_ended();
        // Another PC that only looks does not take the path over.
        bench.status();
        // The path tick tells the servo loops.
        while bench.command.beam_gate[0] {
            bench.servo_tick();
            assert!(bench.controller.state() == State::Stopping);
        }
        bench.stops_on_the_path_then_faults();
        assert_eq!(bench.fault(), Some(Fault::SessionEnded));
    }
}

#[test]
fn with_nobody_in_charge_the_drives_go_off_also_at_rest() {
    let mut bench = Bench::homed();
    bench.status();
    bench.run_ms(5000);
    assert!(bench.command.enable, "a PC that is there may be silent at rest");
    bench.controller.session_ended();
    bench.run_ms(1900);
    assert!(bench.command.enable);
    bench.run_ms(200);
    assert_eq!(bench.command, MotionCommand::SAFE);
    assert_eq!(bench.fault(), Some(Fault::Unattended { seconds: 2 }));
    // Who comes back in time continues.
    let mut bench = Bench::homed();
    bench.controller.session_ended();
    bench.run_ms(1000);
    bench.status();
    bench.run_ms(3000);
    assert!(bench.command.enable && bench.position[Y].is_finite());
}

#[test]
fn a_search_for_the_marks_ends_with_its_session() {
    let mut bench = Bench::configured();
    bench.done(&Request::Home);
    bench.run_ms(50);
    assert!(bench.command.enable);
    bench.controller.session_ended();
    bench.run_ms(2);
    assert_eq!(bench.command, MotionCommand::SAFE);
    assert_eq!(bench.fault(), Some(Fault::SessionEnded));
}
