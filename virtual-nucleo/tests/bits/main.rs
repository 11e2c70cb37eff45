//! What the shipped images give out is, to the bit, what the same controllers give on this computer for the same inputs.
//!
//! Both boards boot on the model, get their parameters, and home; then the motion board runs a short path with position,
//! attitude and beams, while the tracker moves its slides. Each tick's inputs are those that the machine showed, each
//! request comes after the tick that the board itself told, and then the controllers that the simulated boards use get the same.
//! Compared are all codes of the converters, enables and gates at every tick, and every answer, whose `played` has a
//! digest of the axes' references at each path tick.

#[path = "../common/mod.rs"]
mod common;
mod record;
mod replay;

use record::{Record, TRACKED};
use replay::Difference;
use shared::protocol::{Request, Response};
use std::sync::OnceLock;

/// One run is enough for all.
fn recorded() -> &'static [Record; 2] {
    static RECORDS: OnceLock<[Record; 2]> = OnceLock::new();
    RECORDS.get_or_init(record::both)
}

#[test]
fn every_code_and_answer_of_the_motion_board_is_that_of_the_simulated_one() {
    let record = &recorded()[0];
    let same = replay::motion(record).unwrap_or_else(|difference| panic!("{difference}"));
    println!("motion: {same}");
    let driven: Vec<_> = (0..12).filter(|output| record.moves(*output)).collect();
    // All motors and both beams; DAC 2 D is not wired, and the machine has no analog outputs.
    assert_eq!(driven, [0, 1, 2, 3, 4, 5, 6, 8, 9]);
    assert!(record.steps.iter().any(|step| step.gates == [true, true]));
    let Some(Response::MotionStatus(end)) = record.asked.last().map(|asked| &asked.answer) else {
        panic!("the last answer is a status")
    };
    assert!(
        end.homed && end.fault.is_none() && end.played.ticks > 1000,
        "{end:?}"
    );
    assert_eq!((end.servo_lost, end.path_lost), (0, 0));
}

#[test]
fn every_code_and_answer_of_the_tracker_board_is_that_of_the_simulated_one() {
    let record = &recorded()[1];
    let same = replay::tracker(record).unwrap_or_else(|difference| panic!("{difference}"));
    println!("tracker: {same}");
    assert!((0..4).all(|output| record.moves(output)));
    let Some(Response::TrackerStatus(end)) = record.asked.last().map(|asked| &asked.answer) else {
        panic!("the last answer is a status")
    };
    assert!(end.homed && end.fault.is_none() && end.lost == 0, "{end:?}");
    for (slide, target) in end.slides_mm.iter().zip(TRACKED) {
        assert!((slide - target).abs() < 0.01, "{end:?}");
    }
}

/// What is found if a board had been told otherwise.
fn found(board: usize, change: impl Fn(&mut Request)) -> Difference {
    let mut record = recorded()[board].clone();
    for asked in &mut record.asked {
        change(&mut asked.request);
    }
    let replayed = [replay::motion, replay::tracker][board](&record);
    match replayed {
        Ok(same) => panic!("nothing differs: {same}"),
        Err(difference) => {
            println!("{difference}");
            difference
        }
    }
}

#[test]
fn a_scale_that_is_off_by_a_millionth_is_noticed_in_the_codes() {
    let of_motion = found(0, |request| {
        if let Request::ConfigureMotion(config) = request
            && let Some(motor) = &mut config.motors[0]
        {
            motor.velocity_at_10v *= 1.0 + 1e-6;
        }
    });
    assert!(matches!(of_motion, Difference::Output { output: "code 0", .. }));
    let of_tracker = found(1, |request| {
        if let Request::ConfigureTracker(config) = request {
            config.slides[2].velocity_at_10v_mm_s *= 1.0 + 1e-6;
        }
    });
    assert!(matches!(of_tracker, Difference::Output { output: "code 2", .. }));
}

#[test]
fn a_feed_that_is_off_by_its_last_bit_is_noticed_in_an_answer() {
    let difference = found(0, |request| {
        if let Request::LoadElements { elements, .. } = request {
            for element in elements {
                element.feed_mm_s = element.feed_mm_s.next_up();
            }
        }
    });
    let Difference::Answer { board, here, .. } = difference else {
        panic!("{difference}")
    };
    let (Response::MotionStatus(board), Response::MotionStatus(here)) = (*board, *here) else {
        panic!("a status differs")
    };
    assert_ne!(board.played.digest, here.played.digest);
}
