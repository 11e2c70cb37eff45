//! The motion board with the dual-beam gantry, and with the other machines.

mod bench;
mod machines;
mod readback;

use super::*;
use bench::{Bench, config, plant_of};
use plant_file::DEFAULT_MACHINE;
use shared::protocol::Refusal;
use shared::state::{Fault, State};

#[test]
fn homing_finds_the_marks_and_squares_the_gantry() {
    let mut bench = Bench::homed();
    assert!(bench.status().homed);
    bench.run_ms(200);
    let truth = bench.board.plant.truth();
    // Positions are counted from the marks, so they agree with the truth to a few counts.
    let status = bench.status();
    let true_axes = [truth[0], truth[2], truth[3], truth[4], truth[5], truth[6]];
    for axis in 0..6 {
        let position = status.axes[axis] * shared::kinematics::AXIS_UNIT[axis];
        assert!(
            (position - true_axes[axis]).abs() < 0.002,
            "axis {axis}: {position} {true_axes:?}"
        );
    }
    assert!(
        (truth[0] - truth[1]).abs() < 0.002,
        "skew {}",
        truth[0] - truth[1]
    );
}

#[test]
fn a_line_is_followed_within_micrometres_with_the_beam_where_it_belongs() {
    let mut bench = Bench::homed();
    bench.load_line(200.0);
    bench.run();
    bench.samples.clear();
    bench.until(State::Idle, 5_000);
    let beam: Vec<_> = bench.samples.iter().filter(|sample| sample.beams[0]).collect();
    let (first, last) = (beam.first().expect("beam on"), beam.last().expect("beam on"));
    assert!(
        (first.s_mm - 20.0).abs() < 0.151 && (last.s_mm - 180.0).abs() < 0.151,
        "{} {}",
        first.s_mm,
        last.s_mm
    );
    let worst = bench
        .samples
        .iter()
        .flat_map(|sample| sample.following_error)
        .fold(0.0, f32::max);
    assert!(worst < 0.05, "following error {worst}");
    let skew = bench
        .samples
        .iter()
        .map(|sample| sample.skew_mm)
        .fold(0.0, f32::max);
    assert!(skew < 0.03, "skew {skew}");
    println!("following error {worst}, skew {skew}");
}

#[test]
fn hold_stops_on_the_path_with_the_beam_off_and_resume_goes_on() {
    let mut bench = Bench::homed();
    bench.load_line(300.0);
    bench.run();
    bench.run_ms(400);
    assert!(bench.samples.last().expect("samples").beams[0]);
    bench.done(&Request::Hold);
    bench.run_ms(5);
    assert_eq!(bench.samples.last().expect("samples").beams, [false; 2]);
    bench.run_ms(300);
    bench.status();
    bench.run_ms(300);
    let held = bench.status();
    assert_eq!(held.state, State::Holding);
    assert!(held.s_mm > 20.0 && held.s_mm < 280.0);
    let line = bench.board.plant.truth();
    bench.run_ms(100);
    let moved = bench.board.plant.truth()[0] - line[0];
    assert!(moved.abs() < 2e-3, "moved {moved}");
    bench.done(&Request::Resume);
    bench.run_ms(20);
    bench.until(State::Idle, 5_000);
    assert_eq!(bench.status().s_mm, 300.0);
}

#[test]
fn a_silent_pc_stops_the_machine_on_the_path() {
    let mut bench = Bench::homed();
    bench.load_line(600.0);
    bench.run();
    bench.run_ms(2000);
    let status = bench.status();
    assert_eq!(status.state, State::Fault);
    assert!(
        matches!(status.fault, Some(Fault::LinkLost { .. })),
        "{:?}",
        status.fault
    );
    assert!(status.s_mm < 300.0);
    bench.done(&Request::Reset);
    assert_eq!(bench.status().state, State::Off);
}

#[test]
fn the_emergency_stop_switches_everything_off_in_one_tick() {
    let mut bench = Bench::homed();
    bench.load_line(300.0);
    bench.run();
    bench.run_ms(400);
    bench.board.estop = [true; 2];
    bench.now_us += 250;
    bench.board.tick(bench.now_us);
    assert_eq!(bench.board.command, MotionCommand::SAFE);
    bench.run_ms(5);
    assert_eq!(bench.status().fault, Some(Fault::EmergencyStop));
    assert!(bench.board.handle(&Request::Home) != Response::Done);
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    let mut bench = Bench {
        board: MotionBoard::new(plant_of(DEFAULT_MACHINE)),
        now_us: 0,
        samples: Vec::new(),
    };
    let refused = |bench: &mut Bench, request: Request| match bench.board.handle(&request) {
        Response::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&mut bench, Request::Home), Refusal::NotConfigured);
    let mut bad = config();
    bad.motors[2].as_mut().expect("Y").kp = -1.0;
    assert!(matches!(
        refused(&mut bench, Request::ConfigureMotion(bad)),
        Refusal::Parameter(_)
    ));
    let mut bench = Bench::homed();
    assert_eq!(refused(&mut bench, Request::Run), Refusal::NoPath);
    assert!(matches!(
        refused(&mut bench, Request::Hold),
        Refusal::WrongState { state: State::Idle }
    ));
    bench.load_line(100.0);
    bench.run();
    bench.until(State::Idle, 5_000);
    // The path is over.
    assert_eq!(refused(&mut bench, Request::Run), Refusal::NoPath);
    assert_eq!(
        refused(&mut bench, Request::ConfigureMotion(config())),
        Refusal::WrongState { state: State::Idle }
    );
}
