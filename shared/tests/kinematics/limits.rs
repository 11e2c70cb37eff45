//! Travel and speeds.

use crate::bench::{Machine, Random, ac_head, ac_head_within, machines, stir_gantry};
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::{AXES, AXIS_NAMES, Bits};
use shared::kinematics::{KinematicsError, StirTilt, feed_limit, violations};
use std::f64::consts::PI;

#[test]
fn what_is_outside_the_travel_of_every_solution_is_named() {
    let (a, b, c) = (3, 4, 5);
    let tilted = |a: f64, c: f64| {
        let normal = Vector3::new(c.sin() * a.sin(), -c.cos() * a.sin(), a.cos());
        Pose::pointing(Vector3::zeros(), normal).expect("a pose")
    };
    let near = [0.0; AXES];
    let refused =
        |machine: &Machine, pose: &Pose| machine.kinematics.inverse(pose, &near).expect_err("refused");
    let head = ac_head();
    assert_eq!(
        refused(&head, &tilted(1.6, 0.3)),
        KinematicsError::OutOfRange { axis: a }
    );
    assert_eq!(
        refused(&head, &tilted(PI, 0.0)),
        KinematicsError::OutOfRange { axis: a }
    );
    // One sign of A only, and C within ±90°: no twin helps.
    let narrow = ac_head_within((0.0, 90.0), (-90.0, 90.0));
    assert_eq!(
        refused(&narrow, &tilted(0.5, 1.7)),
        KinematicsError::OutOfRange { axis: c }
    );
    // Upright, C would stay where it already is outside its travel.
    let outside = [0.0, 0.0, 0.0, 0.0, 0.0, 1.7];
    let upright = narrow.kinematics.inverse(&tilted(0.0, 0.0), &outside);
    assert_eq!(upright, Err(KinematicsError::OutOfRange { axis: c }));
    let stir = stir_gantry(StirTilt::Positive);
    assert_eq!(
        refused(&stir, &tilted(0.2, 0.0)),
        KinematicsError::OutOfRange { axis: b }
    );
    assert_eq!(refused(&stir, &tilted(1.6, 0.0)), KinematicsError::BelowHorizon);
    assert!(
        KinematicsError::OutOfRange { axis: b }
            .to_string()
            .starts_with("B out of range")
    );
    assert!(
        KinematicsError::BelowHorizon
            .to_string()
            .starts_with("axis below horizon")
    );
}

/// Axes that no choice of a solution can bring back into the travel.
#[test]
fn an_axis_driven_beyond_its_travel_is_listed() {
    for machine in machines() {
        let mut random = Random(10);
        for axis in 0..AXES {
            let limit = machine.limits[axis];
            let chosen = machine.name.contains("A/C") && axis > 2;
            if limit.min == limit.max || chosen {
                continue;
            }
            let mut axes = random.axes(&machine);
            for (edge, beyond) in [(limit.min, -0.02), (limit.max, 0.02)] {
                axes[axis] = edge + beyond;
                let pose = machine.kinematics.forward(&axes);
                match machine.kinematics.inverse(&pose, &axes) {
                    Ok(back) => {
                        let mut only = Bits::NONE;
                        only.set(axis, true);
                        // The friction-stir gantry cannot lean the other way: it takes the twin with C turned.
                        let twin = machine.name.contains("stir") && axis == 4;
                        assert!(
                            twin || violations(&back, &machine.limits) == only,
                            "{}: {} at {axes:?} gave {back:?}",
                            machine.name,
                            AXIS_NAMES[axis]
                        );
                    }
                    Err(error) => assert_eq!(error, KinematicsError::OutOfRange { axis }, "{}", machine.name),
                }
            }
        }
    }
}

/// The highest feed brings exactly the named axis to its highest speed.
#[test]
fn the_highest_feed_is_that_of_the_named_axis() {
    for machine in machines() {
        let mut random = Random(11);
        for _ in 0..1000 {
            let mut axes = random.axes(&machine);
            axes[3] = if axes[3] == 0.0 {
                0.0
            } else {
                axes[3].abs().max(0.1)
            };
            let (t, omega) = (random.vector(1.0), random.vector(0.01));
            let Ok(rates) = machine.kinematics.rates(&axes, &t, &omega) else {
                panic!("{} at {axes:?}", machine.name);
            };
            let (feed, limiting) = feed_limit(&rates, &machine.limits);
            let share = |axis: usize| rates[axis].abs() * feed / machine.limits[axis].velocity;
            assert!((share(limiting) - 1.0).abs() < 1e-12, "{}", machine.name);
            assert!(
                (0..AXES).all(|axis| share(axis) <= 1.0 + 1e-12),
                "{}",
                machine.name
            );
        }
    }
}
