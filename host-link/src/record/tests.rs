use super::*;
use crate::spool::Spool;
use shared::io::SLIDES;
use shared::protocol::Role;
use shared::state::{State, TrackerState};

/// A tick of a motion board at rest in the origin.
fn motion_sample(tick: u32) -> MotionSample {
    MotionSample {
        tick,
        time_us: u64::from(tick) * 1000,
        state: State::Running,
        path_id: 1,
        s_mm: 0.0,
        speed_mm_s: 0.0,
        beams: [true; 2],
        outputs: 0,
        inputs: 0,
        levels: [0.0; 4],
        switched: shared::io::SwitchedLines::NONE,
        axes: [0.0; AXES],
        truth: Some([0.0; MOTORS]),
        following_error: [0.0; MOTORS],
        skew_mm: 0.0,
        load: None,
    }
}

/// A tick of a tracker board at rest.
fn tracker_sample(tick: u32) -> TrackerSample {
    TrackerSample {
        tick,
        time_us: u64::from(tick) * 1000,
        state: TrackerState::Tracking,
        fault: None,
        slides_mm: [0.0; SLIDES],
        truth_mm: Some([0.0; SLIDES]),
        target_mm: [0.0; SLIDES],
        dac: [0; SLIDES],
    }
}

fn ticks_of(samples: &Spool<MotionSample>) -> Vec<u32> {
    samples.iter().map(|sample| sample.tick).collect()
}

#[test]
fn late_and_double_samples_find_their_place_and_gaps_are_counted() {
    let mut record = Record::default();
    for tick in [10, 11, 15, 13, 11, 12, 20] {
        record.add_motion(&[motion_sample(tick)]);
    }
    let ticks: Vec<u32> = record.motion().iter().map(|s| s.tick).collect();
    assert_eq!(ticks, [10, 11, 12, 13, 15, 20]);
    let recorded = record.finish();
    assert_eq!(ticks_of(recorded.motion()), ticks);
    assert_eq!(recorded.missing(), (5, 0));
}

/// A record of 25 s, of which something comes late.
#[test]
fn what_comes_too_late_for_memory_is_missing_and_the_rest_is_in_order() {
    let spooling = Spooling {
        in_memory: 3000,
        ..Spooling::default()
    };
    let mut record = Record::new(spooling);
    let last = 25_000;
    let (late, too_late, never) = (24_000, 100, 12_345);
    for tick in (1..=last).filter(|tick| ![late, too_late, never].contains(tick)) {
        record.add_motion(&[motion_sample(tick)]);
        record.add_tracker(&[tracker_sample(tick)]);
        assert!(record.motion().len() < 21_000);
    }
    assert!(record.motion().len() >= 20_000 && record.motion().back().unwrap().tick == last);
    for again in [late, too_late, 200, last] {
        record.add_motion(&[motion_sample(again)]);
    }
    let recorded = record.finish();
    let expected: Vec<u32> = (1..=last)
        .filter(|tick| ![too_late, never].contains(tick))
        .collect();
    assert!(ticks_of(recorded.motion()) == expected);
    assert_eq!(recorded.missing(), (2, 3));
    assert_eq!(recorded.check(), Ok(()));
}

#[test]
fn ticks_that_begin_anew_go_on() {
    let mut record = Record::default();
    for tick in [u32::MAX - 1, 1, u32::MAX, 2, 1] {
        record.add_motion(&[motion_sample(tick)]);
    }
    let recorded = record.finish();
    assert_eq!(ticks_of(recorded.motion()), [u32::MAX - 1, u32::MAX, 1, 2]);
    assert_eq!(recorded.missing(), (1, 0));
}

#[test]
fn samples_that_the_disk_does_not_take_are_missing_and_told() {
    let mut record = Record::new(Spooling {
        folder: Some("/there/is/no/such/folder".into()),
        in_memory: 1000,
        ..Spooling::default()
    });
    for tick in 1..=23_000 {
        record.add_motion(&[motion_sample(tick)]);
    }
    let recorded = record.finish();
    let error = recorded.check().unwrap_err();
    assert_eq!(error.board, Role::Motion);
    let missing = u64::from(recorded.missing().0);
    assert!(missing >= 22_000 && missing == error.source.records, "{error}");
    assert_eq!(recorded.motion().len() + missing, 23_000);
}

#[test]
fn positions_between_ticks_lie_on_a_line_and_gaps_have_none() {
    let mut record = Record::default();
    for tick in [1, 2, 30] {
        let mut sample = motion_sample(tick);
        sample.truth = Some([f64::from(tick); MOTORS]);
        record.add_motion(&[sample]);
        let mut sample = tracker_sample(tick);
        sample.truth_mm = None;
        sample.slides_mm = [f64::from(tick) * 2.0; SLIDES];
        record.add_tracker(&[sample]);
    }
    assert_eq!(
        record.machine_at(1250).unwrap().0,
        MachinePosition::Motors([1.25; MOTORS])
    );
    for outside in [999, 2001, 30_001] {
        assert!(record.machine_at(outside).is_none(), "{outside}");
    }
    let recorded = record.finish();
    let mut slides = recorded.slides();
    let expected = [
        (999, None),
        (1250, Some(2.5)),
        (1750, Some(3.5)),
        (2000, Some(4.0)),
        // Not in order of time.
        (1250, None),
        (2001, None),
        (30_000, Some(60.0)),
        (30_001, None),
    ];
    for (time_us, position) in expected {
        assert_eq!(slides.at(time_us), position.map(|mm| [mm; SLIDES]), "{time_us}");
    }
}
