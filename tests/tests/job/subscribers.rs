//! Who watches a job does not change it.

use super::*;
use host_link::control;
use host_link::events::Interest;
use shared::protocol::MotionSample;
use std::sync::atomic::{AtomicBool, Ordering};

/// The weld, with a subscriber that sleeps for a second at each event, or without one; the telemetry of the
/// boards, and what the subscriber lost.
fn weld_before(sleeper: bool) -> (Vec<MotionSample>, u64) {
    let (machine, program) = (machine(), interpret(PROGRAM, Options::default()).unwrap());
    let job = job(&machine, &program, Some(seam()));
    let (remote, mut control) = control();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let subscription = sleeper.then(|| remote.subscribe(Interest::Pictures, 8));
        let slept = subscription.map(|subscription| {
            let over = &over;
            scope.spawn(move || {
                let mut lost = 0;
                for received in subscription {
                    lost += received.lost;
                    if over.load(Ordering::Relaxed) {
                        break;
                    }
                    std::thread::sleep(Duration::from_secs(1));
                }
                lost
            })
        });
        let run = job::run(&mut SimulatedBoards::default(), &job, &mut control).unwrap();
        assert!(run.error.is_none(), "{:?}", run.error);
        over.store(true, Ordering::Relaxed);
        let lost = slept.map_or(0, |slept| slept.join().unwrap());
        (run.record.motion().to_vec(), lost)
    })
}

#[test]
fn a_subscriber_that_sleeps_changes_nothing_and_is_told_what_it_lost() {
    let (alone, _) = weld_before(false);
    let (watched, lost) = weld_before(true);
    assert!(alone == watched, "the boards told something else");
    assert!(lost > 1000, "{lost}");
}

/// Pictures are only for those with an interest in them.
#[test]
fn milestones_come_in_order_and_the_end_is_the_last() {
    let (machine, program) = (machine(), interpret(PROGRAM, Options::default()).unwrap());
    let job = job(&machine, &program, Some(seam()));
    let (remote, mut control) = control();
    let milestones = remote.subscribe(Interest::Milestones, 1);
    job::run(&mut SimulatedBoards::default(), &job, &mut control).unwrap();
    drop(control);
    let told: Vec<String> = milestones
        .map(|received| match &*received.event {
            Event::Phase(phase) => phase.to_string(),
            Event::Connected { motion, tracker } => {
                format!("connected {} {}", motion.is_some(), tracker.is_some())
            }
            Event::End { error, .. } => format!("ended {error:?}"),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(
        told,
        [
            "connected true true",
            "setting up the boards",
            "searching reference marks",
            "relating the clocks",
            "approaching",
            "running in",
            "welding",
            "parking",
            "ended None"
        ]
    );
}
