//! The pose beside a path that is tracked.

use crate::bench::{Bench, TRAVEL_MAX, Y, config, load};
use shared::geometry::{Pose, PoseOffset};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{PathAction, PathEvent, PathJoin, Refusal, Request};
use shared::state::State;
use shared::trajectory::PathSpace;

const FEED: f64 = 50.0;
const OFFSET: PoseOffset = PoseOffset {
    lateral_mm: 5.0,
    normal_mm: -2.0,
    about_tangent_rad: 0.02,
};
/// Drives follow their references to this much, on the move \[mm\].
const FOLLOWED: f64 = 0.01;

/// On a line of `length` mm along Y that is tracked up to `tracked` mm, and where it begins.
fn tracked_line(length: f64, tracked: f64) -> (Bench, Pose) {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let line = bench.along_y(0.0, length, FEED, PathJoin::Stop);
    let start = planned(&mut bench);
    bench.loaded(&load(line, true));
    let tracking = |s_mm, on| PathEvent {
        s_mm,
        action: PathAction::Tracking { on },
    };
    let events = [tracking(0.0, true), tracking(tracked, false)];
    bench.loaded(&Request::LoadEvents(events.into_iter().collect()));
    bench.run();
    (bench, start)
}

/// So many ms with a PC that is alive.
fn run_ms(bench: &mut Bench, ms: u32) {
    for i in 0..ms {
        bench.run_ms(1);
        if i % 100 == 0 {
            bench.status();
        }
    }
}

/// Where the references of the axes have the pose.
fn planned(bench: &mut Bench) -> Pose {
    let machine = config().kinematics().unwrap();
    let reference = bench.status().reference;
    machine.forward(&std::array::from_fn(|axis| reference[axis] * AXIS_UNIT[axis]))
}

/// How far the newest sample's pose is beside the line: along M, N, about T.
fn beside(bench: &Bench, start: &Pose) -> [f64; 3] {
    let machine = config().kinematics().unwrap();
    let sample = bench.samples.last().unwrap();
    let pose = machine.forward(&sample.axes);
    let mut on_line = start.position;
    on_line.y += sample.s_mm;
    let off = pose.position - on_line;
    [
        off.dot(&start.lateral()),
        off.dot(&start.normal),
        -pose.normal.dot(&start.lateral()),
    ]
}

#[track_caller]
fn near(seen: [f64; 3], wanted: [f64; 3], by: f64) {
    for (seen, wanted) in seen.iter().zip(wanted) {
        assert!((seen - wanted).abs() <= by, "{seen} instead of {wanted}");
    }
}

#[test]
fn an_offset_is_blended_in_slowly_and_the_path_goes_on_beside_itself() {
    let (mut bench, start) = tracked_line(450.0, 450.0);
    run_ms(&mut bench, 500);
    bench.done(&Request::OffsetPose(OFFSET));
    let (mut fastest, mut expected) = (0.0f64, [0.0; 3]);
    let mut before = beside(&bench, &start);
    for ms in 0..3000 {
        bench.run_ms(1);
        let now = beside(&bench, &start);
        if ms % 20 == 0 {
            // Over 20 ms, since gratings count in 0.1 µm.
            let rate = (now[0] - before[0]) / 0.02;
            fastest = fastest.max(rate);
            assert!(rate > -0.1, "{rate} mm/s");
            before = now;
            bench.status();
        }
        let aside = bench.path_state.unwrap().superimposed_rate;
        expected = std::array::from_fn(|i| expected[i] + aside[i] * 1e-3);
    }
    assert!(fastest > 1.0 && fastest <= 5.1, "{fastest} mm/s");
    near(expected, OFFSET.numbers(), 0.001);
    assert_eq!(bench.status().superimposed, OFFSET);
    near(beside(&bench, &start), OFFSET.numbers(), FOLLOWED);
    assert_eq!(bench.status().state, State::Running);
    assert_eq!(bench.path_state.unwrap().superimposed_rate, [0.0; 3]);
}

#[test]
fn no_axis_gets_more_than_a_twentieth_of_its_limits_besides() {
    let (mut plain, _) = tracked_line(450.0, 450.0);
    let (mut bench, _) = tracked_line(450.0, 450.0);
    let limits = config().axes.map(Option::unwrap);
    let mut added = [[0.0f64; 4]; 6];
    for ms in 0..4000 {
        if ms == 700 {
            bench.done(&Request::OffsetPose(OFFSET));
        }
        for bench in [&mut plain, &mut bench] {
            bench.run_ms(1);
        }
        let (with, without) = (bench.status().reference, plain.status().reference);
        for axis in 0..6 {
            let now = with[axis] - without[axis];
            let [x, v, a, _] = added[axis];
            let speed = (now - x) * 1e3;
            let acceleration = (speed - v) * 1e3;
            added[axis] = [now, speed, acceleration, (acceleration - a) * 1e3];
            let limit = &limits[axis];
            assert!(speed.abs() <= 0.0501 * limit.max_velocity);
            assert!(acceleration.abs() <= 0.0501 * limit.max_acceleration);
            assert!(
                added[axis][3].abs() <= 0.055 * limit.max_jerk,
                "{}",
                added[axis][3]
            );
        }
    }
    assert!(added[Y - 1][0].abs() > 1.0);
}

#[test]
fn a_hold_holds_the_blend_too_and_a_resume_goes_on_with_it() {
    let (mut bench, start) = tracked_line(450.0, 450.0);
    run_ms(&mut bench, 500);
    bench.done(&Request::OffsetPose(OFFSET));
    run_ms(&mut bench, 900);
    bench.done(&Request::Hold);
    run_ms(&mut bench, 200);
    let held = beside(&bench, &start);
    assert!(held[0] > 0.5 && held[0] < 4.5, "{held:?}");
    run_ms(&mut bench, 2000);
    near(beside(&bench, &start), held, 0.001);
    assert_eq!(bench.status().state, State::Holding);
    bench.done(&Request::Resume);
    run_ms(&mut bench, 3500);
    near(beside(&bench, &start), OFFSET.numbers(), FOLLOWED);
}

#[test]
fn where_tracking_ends_the_pose_goes_back_and_the_path_ends_where_it_was_planned() {
    // Too short for all of the way back: the rest of it comes at the end of the path.
    for length in [300.0, 220.0] {
        let (mut bench, start) = tracked_line(length, 200.0);
        run_ms(&mut bench, 500);
        bench.done(&Request::OffsetPose(OFFSET));
        bench.until(State::Idle, 12_000);
        let mut end = start;
        end.position.y += length;
        let stands = planned(&mut bench);
        assert!((stands.position - end.position).norm() < 1e-9, "{stands:?}");
        assert!((stands.normal - end.normal).norm() < 1e-12);
    }
}

#[test]
fn a_new_offset_takes_the_place_of_the_last_one_in_the_middle_of_its_blend() {
    let (mut bench, start) = tracked_line(450.0, 450.0);
    run_ms(&mut bench, 500);
    bench.done(&Request::OffsetPose(OFFSET));
    run_ms(&mut bench, 800);
    let other = PoseOffset {
        lateral_mm: -1.0,
        ..PoseOffset::NONE
    };
    bench.done(&Request::OffsetPose(other));
    let mut before = beside(&bench, &start)[0];
    for _ in 0..300 {
        bench.run_ms(10);
        bench.status();
        let now = beside(&bench, &start)[0];
        assert!((now - before).abs() < 0.052, "{} mm/s", (now - before) * 100.0);
        before = now;
    }
    near(beside(&bench, &start), other.numbers(), FOLLOWED);
}

#[test]
fn after_a_stop_the_next_path_begins_where_the_axes_stand() {
    let (mut bench, start) = tracked_line(450.0, 450.0);
    run_ms(&mut bench, 500);
    bench.done(&Request::OffsetPose(OFFSET));
    run_ms(&mut bench, 900);
    bench.done(&Request::Stop);
    bench.until(State::Idle, 2000);
    let aside = beside(&bench, &start)[0];
    assert!(aside > 0.5 && aside < 4.5, "{aside} mm");
    let stands = planned(&mut bench);
    bench.begin(PathSpace::Tool);
    let on = bench.along_y(0.0, 20.0, FEED, PathJoin::Stop);
    bench.loaded(&load(on, true));
    bench.run();
    bench.until(State::Idle, 3000);
    let mut end = stands.position;
    end.y += 20.0;
    assert!((planned(&mut bench).position - end).norm() < 1e-9);
}

#[test]
fn an_offset_is_refused_where_nothing_is_tracked_or_the_machine_ends() {
    let mut bench = Bench::homed();
    let offset = Request::OffsetPose(OFFSET);
    let idle = Refusal::WrongState { state: State::Idle };
    assert_eq!(bench.refused(&offset), idle);
    let (mut bench, _) = tracked_line(300.0, 100.0);
    run_ms(&mut bench, 500);
    let far = PoseOffset {
        normal_mm: 26.0,
        ..PoseOffset::NONE
    };
    let too_far = Refusal::OffsetTooFar {
        most_mm: 25.0,
        most_deg: 5.729_578,
    };
    for offset in [
        far,
        PoseOffset::of([0.0, 0.0, 0.11]),
        PoseOffset::of([f64::NAN, 0.0, 0.0]),
    ] {
        assert_eq!(bench.refused(&Request::OffsetPose(offset)), too_far);
    }
    run_ms(&mut bench, 2500);
    assert_eq!(bench.refused(&offset), Refusal::NotTracking);
    assert_eq!(bench.path_state.unwrap().superimposed_rate, [0.0; 3]);
    // 4 mm below the end of the travel of Z.
    let mut bench = Bench::homed();
    let z = bench.status().reference[2];
    let rise = TRAVEL_MAX - 4.0 - z;
    bench.begin(PathSpace::Tool);
    let mut up = bench.along_y(0.0, rise, 100.0, PathJoin::Stop);
    if let shared::protocol::PathShape::Line { start, end } = &mut up.shape {
        *end = [start[0], start[1], start[2] + rise];
    }
    bench.loaded(&load(up, true));
    bench.run();
    bench.until(State::Idle, 10_000);
    bench.begin(PathSpace::Tool);
    let line = bench.along_y(0.0, 300.0, FEED, PathJoin::Stop);
    bench.loaded(&load(line, true));
    let on = PathEvent {
        s_mm: 0.0,
        action: PathAction::Tracking { on: true },
    };
    bench.loaded(&Request::LoadEvents([on].into_iter().collect()));
    bench.run();
    run_ms(&mut bench, 500);
    let up = |normal_mm| {
        Request::OffsetPose(PoseOffset {
            normal_mm,
            ..PoseOffset::NONE
        })
    };
    let assert_ends = |bench: &mut Bench| {
        let Refusal::OffsetBeyondTravel { axis: 2, position } = bench.refused(&up(5.0)) else {
            panic!("Z ends");
        };
        assert!((position - 1001.0).abs() < 1e-3, "{position} mm");
    };
    assert_ends(&mut bench);
    // An offset is one of the plan, whatever the pose is beside it already.
    bench.done(&up(3.0));
    run_ms(&mut bench, 3000);
    assert_eq!(bench.status().state, State::Running);
    assert!((bench.status().reference[2] - 999.0).abs() < 1e-3);
    assert_ends(&mut bench);
}
