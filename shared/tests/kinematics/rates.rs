//! Rates and accelerations against differences of forward and of inverse.

use crate::bench::{Machine, Random, differences, distance, machines, motion_of};
use nalgebra::Vector3;
use shared::geometry::{Pose, rotate};
use shared::io::AXES;

/// Time step of the differences \[s\].
const STEP: f64 = 0.01;

/// Axes away from the poles, where angles are well determined.
fn regular_axes(random: &mut Random, machine: &Machine) -> [f64; AXES] {
    loop {
        let axes = random.axes(machine);
        let tilt = |angle: f64| angle == 0.0 || angle.abs() > 0.05;
        if tilt(axes[3]) && tilt(axes[4]) {
            return axes;
        }
    }
}

/// Random rates of the axes the machine has: mm/s and rad/s.
fn random_rates(random: &mut Random, machine: &Machine) -> [f64; AXES] {
    std::array::from_fn(|i| {
        let rate = random.within(-1.0, 1.0) * if i < 3 { 100.0 } else { 0.5 };
        if machine.limits[i].max > machine.limits[i].min {
            rate
        } else {
            0.0
        }
    })
}

#[test]
fn rates_and_accelerations_are_those_that_move_the_tool_so() {
    for machine in machines() {
        let mut random = Random(7);
        let mut worst = 0.0f64;
        for _ in 0..500 {
            let q = regular_axes(&mut random, &machine);
            let (q1, q2) = (
                random_rates(&mut random, &machine),
                random_rates(&mut random, &machine),
            );
            let at =
                |t: f64| -> [f64; AXES] { std::array::from_fn(|i| q[i] + q1[i] * t + q2[i] * t * t / 2.0) };
            let motion = motion_of(STEP, |t| machine.kinematics.forward(&at(t)));
            let (rates, accelerations) = machine.kinematics.derivatives(&q, &motion).expect("regular");
            worst = worst
                .max(distance(&rates, &q1))
                .max(distance(&accelerations, &q2));
            let only_rates = machine
                .kinematics
                .rates(&q, &motion.velocity, &motion.angular_velocity);
            assert_eq!(only_rates, Ok(rates), "{}", machine.name);
        }
        println!("{}: {worst:.1e} from the differences", machine.name);
        assert!(worst < 2e-6, "{}: {worst}", machine.name);
    }
}

/// Any pose, also one whose N the pipe welder cannot quite realise, in any motion.
#[test]
fn axes_in_motion_are_the_derivatives_of_inverse() {
    for machine in machines() {
        let mut random = Random(8);
        let mut worst = 0.0f64;
        for _ in 0..500 {
            let q = regular_axes(&mut random, &machine);
            let start = machine.kinematics.forward(&q);
            let (v, a) = (random.vector(20.0), random.vector(20.0));
            let turn = random.vector(1.0).normalize();
            // Slow, so that the differences stay within the travel of the small tilts.
            let (rate, acceleration) = (random.within(-0.2, 0.2), random.within(-0.2, 0.2));
            let lean = if machine.name == "pipe welder" {
                random.within(-0.3, 0.3)
            } else {
                0.0
            };
            let at = |t: f64| {
                let angle = rate * t + acceleration * t * t / 2.0;
                let turned = |v: &Vector3<f64>| rotate(&turn, angle, v);
                let (n, t_lean) = (
                    start.normal * lean.cos() + start.tangent * lean.sin(),
                    start.tangent * lean.cos() - start.normal * lean.sin(),
                );
                Pose {
                    position: start.position + v * t + a * (t * t / 2.0),
                    tangent: turned(&t_lean),
                    normal: turned(&n),
                }
            };
            let Ok(middle) = machine
                .kinematics
                .inverse_motion(&at(0.0), &motion_of(STEP, at), &q)
            else {
                panic!("{}: no solution at {q:?}", machine.name);
            };
            let inverse = |t: f64| machine.kinematics.inverse(&at(t), &q);
            if [-3.0, 3.0].iter().any(|k| inverse(k * STEP).is_err()) {
                // The differences would leave the travel.
                continue;
            }
            let (rates, accelerations) = differences(STEP, |t| inverse(t).expect("inside the travel"));
            worst = worst
                .max(distance(&middle.position, &inverse(0.0).expect("a solution")))
                .max(distance(&middle.velocity, &rates))
                .max(distance(&middle.acceleration, &accelerations));
        }
        println!("{}: {worst:.1e} from the differences of inverse", machine.name);
        assert!(worst < 1e-5, "{}: {worst}", machine.name);
    }
}
