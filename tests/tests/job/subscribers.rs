//! Who watches a job does not change it.

use super::*;
use host_link::control;
use host_link::events::Interest;
use system_tests::{NoOperator, Operator, Sleeper, run};

#[test]
fn a_subscriber_that_sleeps_changes_nothing_and_is_told_what_it_lost() {
    let (machine, program) = (machine(), interpret(PROGRAM, Options::default()).unwrap());
    let job = job(&machine, &program, Some(seam()));
    let weld = |operator: &mut dyn Operator| {
        let ended = run(&mut SimulatedBoards::default(), &job, operator).unwrap();
        assert!(ended.error.is_none(), "{:?}", ended.error);
        ended.record
    };
    let mut sleeper = Sleeper::default();
    assert!(
        weld(&mut NoOperator).motion() == weld(&mut sleeper).motion(),
        "the boards told something else"
    );
    let lost = sleeper.end();
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
