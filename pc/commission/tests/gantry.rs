//! The cross-coupling of a gantry beside the gains of its motors, and machines with softened loops.

use commission::{Lag, Loop, Margins, TRAVEL, rewrite_all, softened};
use config::machine::MachineFile;
use shared::config::MotionConfig;
use shared::motion::Machine;

const X1: usize = 0;
const X2: usize = 1;
const Y: usize = 2;
const C: usize = 6;
const SHIPPED: &str = include_str!("../../../machines/dual-beam-gantry.toml");

fn machine(text: &str) -> MotionConfig {
    MachineFile::parse("m.toml", text).expect("a machine").motion
}

/// What was found of a motor of the shipped machine, which now has this gain.
fn with_gain(index: usize, kp: f64) -> Loop {
    let mut motor = machine(SHIPPED).motors[index].clone().expect("it is fitted");
    motor.ki *= kp / motor.kp;
    motor.kp = kp;
    Loop {
        motor,
        margins: Margins::of(&[]),
        before: Margins::of(&[]),
        lag: Lag {
            gain: 1.0,
            delay_s: 0.0,
        },
        held: None,
    }
}

fn coupling(text: &str) -> f64 {
    machine(text).gantry.expect("X is one").coupling
}

#[test]
fn the_coupling_goes_with_the_lesser_gain_of_both_motors_whichever_is_written_first() {
    let (x1, x2, y) = (with_gain(X1, 90.0), with_gain(X2, 60.0), with_gain(Y, 100.0));
    let before = machine(SHIPPED);
    let gain = |index: usize| before.motors[index].as_ref().expect("it is fitted").kp;
    let expected = coupling(SHIPPED) * 60.0 / gain(X1).min(gain(X2));
    assert!(expected > 0.0);
    let written = |found: &[&[(usize, &Loop)]]| {
        found.iter().fold(SHIPPED.to_owned(), |text, found| {
            rewrite_all(&text, &machine(&text), &[], found).expect("these motors are in it")
        })
    };
    for order in [
        &[&[(X1, &x1), (X2, &x2), (Y, &y)][..]][..],
        &[&[(X1, &x1)], &[(Y, &y)], &[(X2, &x2)]],
        &[&[(X2, &x2)], &[(X1, &x1)]],
    ] {
        let found = coupling(&written(order));
        assert!(
            (found - expected).abs() < 1e-3 * expected,
            "{found} instead of {expected}"
        );
    }
    assert_eq!(coupling(&written(&[&[(Y, &y)]])), coupling(SHIPPED));

    // What stays is left alone, and what was there before is told.
    let own = "[motors.X1]\nkp = 120.0\n[gantry]\ncoupling = 40.0 # assumed\ncoupling_derivative = 0.0\n";
    let written = rewrite_all(own, &before, &[], &[(X1, &x2)]).expect("both are in it");
    assert!(
        written.ends_with("[gantry]\ncoupling = 20.0 # commissioned; was 40.0\ncoupling_derivative = 0.0\n"),
        "{written}"
    );
    assert!(rewrite_all("[motors.X1]\nkp = 120.0\n", &before, &[], &[(X1, &x2)]).is_err());
}

#[test]
fn every_motor_that_was_measured_has_a_vibration_limit_and_keeps_its_own() {
    let own = SHIPPED.replacen(
        "following_error_base",
        "vibration_limit = 0.05\nfollowing_error_base",
        1,
    );
    let x2 = with_gain(X2, 60.0);
    let written = rewrite_all(&own, &machine(&own), &[X1, X2, Y, C], &[(X2, &x2)]).expect("they are in it");
    let limits = machine(&written)
        .motors
        .map(|motor| motor.expect("it is fitted").vibration_limit);
    let expected = [0.05, 0.02, 0.02, 0.0, 0.0, 0.0, 0.01];
    assert_eq!(limits, expected);
    assert!(written.contains("vibration_limit = 0.02 # commissioned; was none"));
}

/// With a quarter of its gain a drive is told as much where its motor is four times as far off.
#[test]
fn softened_machines_trip_later_but_no_further_than_an_excitation_goes_and_are_machines() {
    for name in [
        "dual-beam-gantry",
        "pipe-welder",
        "ac-head",
        "wire-arc",
        "stir-gantry",
    ] {
        let path = format!("{}/../../machines/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let mut before = MachineFile::read(path.as_ref()).expect("a machine").motion;
        // The last is as much as the least travel allows.
        for base in [0.1, 0.5, 1.0] {
            let motors = before.motors.iter_mut().flatten();
            motors.for_each(|motor| motor.following_error_base = base);
            let softened = softened(&before);
            if let Err(error) = Machine::build(&softened) {
                panic!("{name}, {base}: {error}");
            }
            let largest = softened
                .motors
                .iter()
                .flatten()
                .map(|motor| motor.following_error_base);
            assert_eq!(
                largest.fold(0.0, f64::max),
                (4.0 * base).min(TRAVEL),
                "{name}, {base}"
            );
        }
    }
}
