//! The shipped machines behind a motion board.

use core::f64::consts::PI;
use plant::{BodyConfig, GeometryConfig, MotionPlant, TouchConfig, Wave};
use plant_file::{DEFAULT_MACHINE, PlantFile, names};
use shared::io::{Bits, DacCode, MOTORS, MotionCommand, MotionFeedback, PROCESS_INPUTS, SIDES};
use shared::kinematics::KinematicsConfig;
use shared::units::DEG_PER_RAD;

/// All inputs of the process on.
const ANSWERS: Bits = Bits((1 << PROCESS_INPUTS) - 1);

fn shipped(machine: &str) -> PlantFile {
    PlantFile::shipped(machine).unwrap()
}

fn default() -> MotionPlant {
    shipped(DEFAULT_MACHINE).motion()
}

fn command(ratio: [f64; MOTORS]) -> MotionCommand {
    MotionCommand {
        enable: true,
        dac: ratio.map(|r| DacCode::from_ratio(r, 1.0)),
        ..MotionCommand::SAFE
    }
}

/// Runs until `done` or `ticks` are over; the last feedback.
fn run(plant: &mut MotionPlant, command: &MotionCommand, ticks: u32) -> MotionFeedback {
    let mut feedback = plant.advance(command);
    for _ in 1..ticks {
        feedback = plant.advance(command);
    }
    feedback
}

#[test]
fn a_disabled_machine_stands_and_counts_from_zero() {
    let mut plant = default();
    let mut ignored = command([1.0; MOTORS]);
    ignored.enable = false;
    let before = plant.truth();
    let feedback = run(&mut plant, &ignored, 400);
    let dark = MotionFeedback {
        beam_power: [Some(DacCode::ZERO); SIDES],
        process: ANSWERS,
        ..MotionFeedback::NONE
    };
    assert_eq!(feedback, dark);
    assert_eq!(plant.truth(), before);
    assert_eq!(before[0], 35.013);
    assert!((before[4] - 3.2_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn ten_volts_drive_every_motor_at_its_speed() {
    let mut plant = default();
    let half = command([0.5; MOTORS]);
    run(&mut plant, &half, 800);
    let before = plant.truth();
    run(&mut plant, &half, 400);
    let after = plant.truth();
    let degrees = 75.0_f64.to_radians();
    for (i, speed) in [200.0, 200.0, 200.0, 100.0, degrees, degrees, degrees]
        .into_iter()
        .enumerate()
    {
        let seen = (after[i] - before[i]) / 0.1;
        assert!((seen / speed - 1.0).abs() < 2e-3, "motor {i}: {seen}");
    }
}

#[test]
fn counts_and_truth_agree_within_half_a_count() {
    let mut plant = default();
    let start = plant.truth();
    for k in 0..2000 {
        let ratio = 0.3 * libm::sin(f64::from(k) * 0.01);
        let feedback = plant.advance(&command([ratio; MOTORS]));
        let truth = plant.truth();
        for i in 0..MOTORS {
            let per_unit = if i < 4 { 10_000.0 } else { 10_000.0 * DEG_PER_RAD };
            let error = feedback.counts[i] as f64 - (truth[i] - start[i]) * per_unit;
            // Half a count for the reading, half for the line at power-up.
            assert!(error.abs() <= 1.0 + 1e-6, "motor {i}: {error}");
        }
    }
}

#[test]
fn marks_latch_one_count_whatever_the_direction_and_show_the_square_offset() {
    let mut plant = default();
    let start = plant.truth();
    let down = command([-0.05, -0.05, -0.05, 0.1, -0.05, 0.05, -0.05]);
    let up = command(down.dac.map(|code| -code.ratio()));
    let mut seen = [[None; MOTORS]; 2];
    for (latched, command) in seen.iter_mut().zip([&down, &up]) {
        for _ in 0..8000 {
            for (latched, mark) in latched.iter_mut().zip(plant.advance(command).mark) {
                *latched = latched.or(mark);
            }
        }
    }
    assert_eq!(seen[0], seen[1]);
    let mark = seen[0].map(|mark| mark.expect("every mark was passed") as f64);
    let position = |i: usize| 20.0 - mark[i] / 10_000.0;
    let out_of_square = start[0] - start[1];
    assert!((position(0) - position(1) - (0.037 + out_of_square)).abs() < 2e-4);
    assert!((out_of_square - 0.06).abs() < 1e-9);
    assert!((mark[4] / 10_000.0 + 3.2).abs() < 2e-4);
}

#[test]
fn limit_switches_close_at_both_ends_of_the_travel() {
    let mut plant = default();
    let low = run(
        &mut plant,
        &command([-0.5, -0.5, -0.5, -0.5, -0.5, -0.5, -0.5]),
        42_000,
    );
    assert_eq!((low.limit_minus.0, low.limit_plus.0), (0b111_1111, 0));
    let high = run(&mut plant, &command([1.0; MOTORS]), 160_000);
    assert_eq!((high.limit_minus.0, high.limit_plus.0), (0, 0b111_1111));
}

#[test]
fn disabling_stops_every_motor_within_a_tenth_of_a_second() {
    let mut plant = default();
    run(&mut plant, &command([1.0; MOTORS]), 1600);
    run(&mut plant, &MotionCommand::SAFE, 400);
    let rest = plant.truth();
    run(&mut plant, &MotionCommand::SAFE, 400);
    assert_eq!(plant.truth(), rest);
}

#[test]
fn a_beam_needs_its_gate_and_its_power() {
    let mut plant = default();
    let mut command = MotionCommand::SAFE;
    command.beam_gate = [true, true];
    command.beam_power = [DacCode(1000), DacCode::ZERO];
    let feedback = plant.advance(&command);
    assert_eq!(plant.beams(), [true, false]);
    assert_eq!(feedback.beam_power, command.beam_power.map(Some));
    plant.advance(&MotionCommand::SAFE);
    assert_eq!(plant.beams(), [false, false]);
    plant.stick_beam(1, Some(DacCode(500)));
    let feedback = plant.advance(&MotionCommand::SAFE);
    assert_eq!(plant.beams(), [false, true]);
    assert_eq!(feedback.beam_power, [DacCode::ZERO, DacCode(500)].map(Some));
}

#[test]
fn two_plants_with_the_same_commands_stay_equal_to_the_bit() {
    let mut one = default();
    let mut two = default();
    for k in 0..1000 {
        let command = command([libm::sin(f64::from(k) * 0.03); MOTORS]);
        assert_eq!(one.advance(&command), two.advance(&command));
    }
    assert_eq!(one, two);
}

#[test]
fn machines_are_called_as_their_kinematics() {
    let known: Vec<&str> = names().collect();
    // A list of joints is any machine: its plant is a file of its own, as it is.
    for name in KinematicsConfig::NAMES
        .iter()
        .filter(|name| **name != "serial-chain")
    {
        assert!(known.contains(name), "{name} has no plant");
    }
}

#[test]
fn every_machine_obeys_and_what_is_not_wired_stays() {
    for name in names() {
        let file = shipped(name);
        let mut plant = file.motion();
        let start = plant.truth();
        let feedback = run(&mut plant, &command([0.01; MOTORS]), 4000);
        assert_eq!((feedback.limit_minus.0, feedback.limit_plus.0), (0, 0), "{name}");
        for (i, motor) in file.plant.motors.iter().enumerate() {
            let moved = plant.truth()[i] - start[i];
            assert_eq!(motor.is_some(), moved > 0.0, "{name}, motor {i}");
            assert_eq!(motor.is_some(), feedback.counts[i] > 0, "{name}, motor {i}");
        }
    }
}

#[test]
fn an_input_is_on_while_the_axes_are_inside_what_they_touch() {
    let mut file = shipped(DEFAULT_MACHINE);
    let at = file.motion().truth();
    // X has two motors, which stand askew.
    let x = 0.5 * (at[0] + at[1]);
    let from = [x + 2.0, at[2] - 1.0, at[3] - 1.0];
    let body = BodyConfig {
        from,
        to: [x + 5.0, at[2] + 1.0, at[3] + 1.0],
    };
    file.plant.touch = Some(TouchConfig {
        input: 2,
        bodies: [body].into_iter().collect(),
    });
    let mut plant = file.motion();
    let mut ratios = [0.0; MOTORS];
    (ratios[0], ratios[1]) = (0.02, 0.02);
    let creep = command(ratios);
    let mut seen = Vec::new();
    for _ in 0..20_000 {
        let on = plant.advance(&creep).process;
        assert_eq!(on.0 & 0b1101, 0b1101, "the others answer");
        let truth = plant.truth();
        let inside = (2.0..=5.0).contains(&(0.5 * (truth[0] + truth[1]) - x));
        assert_eq!(on.get(1), inside);
        if seen.last() != Some(&inside) {
            seen.push(inside);
        }
    }
    assert_eq!(seen, [false, true, false]);
    // Beside it in Y nothing is touched.
    let mut beside = file.clone();
    let touch = beside.plant.touch.as_mut().unwrap();
    (touch.bodies[0].from[1], touch.bodies[0].to[1]) = (at[2] + 1.0, at[2] + 2.0);
    let mut plant = beside.motion();
    assert!((0..20_000).all(|_| !plant.advance(&creep).process.get(1)));
}

#[test]
fn errors_of_geometry_move_the_tool_but_no_grating() {
    let straight = shipped(DEFAULT_MACHINE);
    let mut bent = straight.clone();
    let wave = Wave {
        amplitude: 0.02,
        period: 30.0,
    };
    let error = |motor, axis, slope, wave| GeometryConfig {
        motor,
        axis,
        slope,
        wave,
    };
    // Z over X, and A over Y, in degrees.
    bent.plant.geometry = [error(3, 0, 1e-4, wave), error(4, 1, 1e-3, Wave::default())]
        .into_iter()
        .collect();
    let (mut straight, mut bent) = (straight.motion(), bent.motion());
    let command = command([0.1; MOTORS]);
    for _ in 0..50 {
        assert_eq!(run(&mut straight, &command, 40), run(&mut bent, &command, 40));
        let (at, off) = (straight.truth(), bent.truth());
        let x = (at[0] + at[1]) / 2.0;
        let z = 1e-4 * x + 0.02 * (2.0 * PI * x / 30.0).sin();
        let a = (1e-3 * at[2]).to_radians();
        for motor in 0..MOTORS {
            let expected = [0.0, 0.0, 0.0, z, a, 0.0, 0.0][motor];
            assert!((off[motor] - at[motor] - expected).abs() < 1e-12, "motor {motor}");
        }
    }
}
