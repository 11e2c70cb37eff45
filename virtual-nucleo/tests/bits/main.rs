//! What the shipped images give out is, to the bit, what the same controllers give on this computer for the same inputs.
//!
//! Both boards boot on the model, get their parameters, and home; then the motion board runs a short path with position,
//! attitude and beams, while the tracker moves its slides; then the tracker follows a seam along a path, with both beams. Each
//! tick's inputs are those that the machine showed, requests and datagrams come in the order in which each board took them,
//! datagrams with the times of arrival that the firmware read, and then the controllers that the simulated boards use get the
//! same. Compared are all codes of the converters, enables and gates at every tick, every answer, whose `played` has a
//! digest of the axes' references at each path tick, and every path state, permit, capture and sample of telemetry.

mod cameras;
#[path = "../common/mod.rs"]
mod common;
mod journal;
mod paths;
mod record;
mod replay;

use cameras::seam;
use journal::Event;
use paths::{BURNS, TRACKED};
use record::Record;
use replay::Difference;
use shared::protocol::{BeamPermit, Datagram, Request, Response};
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
    let Response::MotionStatus(end) = record.end() else {
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
    let Response::TrackerStatus(end) = record.end() else {
        panic!("the last answer is a status")
    };
    assert!(end.homed && end.fault.is_none() && end.lost == 0, "{end:?}");
    assert!(end.accepted.iter().all(|accepted| *accepted > 500), "{end:?}");
}

#[test]
fn the_slides_follow_the_seam_where_both_beams_burn() {
    let [motion, tracker] = recorded();
    let burning = |datagram: &&Datagram| match datagram {
        Datagram::PathState(state) => state.path_id == TRACKED && state.beams == [true; 2],
        _ => false,
    };
    let burns = motion.sent.iter().filter(burning).count();
    // 145 mm at 100 mm/s, a path state each millisecond.
    assert!(burns.abs_diff(1450) <= 2, "{burns}");
    let seen = tracker.sent.iter().filter_map(|datagram| match datagram {
        Datagram::Capture(capture) if capture.path_id == TRACKED => Some(capture),
        _ => None,
    });
    let (mut captures, mut worst) = (0, 0.0);
    for capture in seen.filter(|capture| (BURNS[0]..BURNS[1]).contains(&capture.s_mm)) {
        captures += 1;
        for (slide, seam) in capture.slides_mm.iter().zip(seam(capture.s_mm)) {
            worst = f64::max(worst, (slide - seam).abs());
        }
    }
    println!("{captures} captures, at most {worst:.4} mm beside the seam");
    assert!(captures > 100 && worst < 0.05, "{captures} captures, {worst} mm");
}

/// What is found if a board had been told otherwise.
fn found(board: usize, change: impl Fn(&mut Request)) -> Difference {
    found_of_events(board, |event| {
        if let Event::Asked(asked) = event {
            change(&mut asked.request);
        }
    })
}

/// What is found if a board had taken in something else.
fn found_of_events(board: usize, change: impl FnMut(&mut Event)) -> Difference {
    let mut record = recorded()[board].clone();
    record.events.iter_mut().for_each(change);
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

#[test]
fn one_measurement_that_is_off_by_a_picometre_is_noticed_in_the_telemetry() {
    let mut measurements = 0;
    let difference = found_of_events(1, |event| {
        if let Event::Datagram(datagram, _) = event
            && let Datagram::Measurement(measurement) = &mut **datagram
        {
            measurements += 1;
            // The first come before there is a path.
            if let (500, Some(side)) = (measurements, &mut measurement.sides[0]) {
                side.delta_u_mm += 1e-9;
            }
        }
    });
    let Difference::Datagram { board, .. } = difference else {
        panic!("{difference}")
    };
    assert!(matches!(*board, Datagram::TrackerTelemetry(_)), "{board:?}");
}

#[test]
fn a_permit_that_is_withheld_is_noticed_at_the_power_of_the_beams() {
    let difference = found_of_events(0, |event| {
        if let Event::Datagram(datagram, _) = event
            && let Datagram::Permit(permit) = &mut **datagram
        {
            permit.sides[1] = BeamPermit::No;
        }
    });
    assert!(matches!(difference, Difference::Output { output: "code 8", .. }));
}
