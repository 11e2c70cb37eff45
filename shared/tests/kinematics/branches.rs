//! Choice among solutions, and turns of C.

use crate::bench::{Machine, Random, ac_head, ac_head_within, dual_beam, pipe_welder, stir_gantry, wire_arc};
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::{AXES, AXIS_NAMES, Bits};
use shared::kinematics::{StirTilt, violations};
use std::f64::consts::PI;

/// Walks along poses in small steps, each solved near the one before; asserts that no rotary axis moves by more than
/// `step` \[rad\] at a time, and returns the axes at the end.
fn walk(machine: &Machine, start: [f64; AXES], poses: impl Iterator<Item = Pose>, step: f64) -> [f64; AXES] {
    let mut axes = start;
    for (k, pose) in poses.enumerate() {
        let next = machine
            .kinematics
            .inverse(&pose, &axes)
            .expect("a reachable pose");
        for axis in 3..AXES {
            let moved = (next[axis] - axes[axis]).abs();
            assert!(
                moved <= step * (1.0 + 1e-9),
                "{}: {} moves by {moved} at step {k}",
                machine.name,
                AXIS_NAMES[axis]
            );
        }
        axes = next;
    }
    axes
}

const STEPS: usize = 3600;

/// Fractions of a way, 0…1.
fn way() -> impl Iterator<Item = f64> {
    (0..=STEPS).map(|k| k as f64 / STEPS as f64)
}

#[test]
fn the_waist_of_the_pipe_welder_turns_on_over_half_turns() {
    let machine = pipe_welder();
    for turns in [2.0, -2.0] {
        let sweep = turns * 2.0 * PI;
        let start = [200.0, 0.0, 50.0, 0.0, 0.7, 0.3];
        let at = |lambda: f64| {
            let mut axes = start;
            axes[5] += sweep * lambda;
            machine.kinematics.forward(&axes)
        };
        let end = walk(&machine, start, way().map(at), sweep.abs() / STEPS as f64);
        assert!((end[5] - start[5] - sweep).abs() < 1e-9);
    }
}

#[test]
fn the_turntable_turns_on_over_half_turns() {
    let machine = wire_arc();
    let start = [600.0, 400.0, 200.0, 0.1, 0.2, 2.9];
    let sweep = -5.0 * 2.0 * PI;
    let at = |lambda: f64| {
        let mut axes = start;
        axes[5] += sweep * lambda;
        machine.kinematics.forward(&axes)
    };
    let end = walk(&machine, start, way().map(at), sweep.abs() / STEPS as f64);
    assert!((end[5] - start[5] - sweep).abs() < 1e-9);
}

#[test]
fn c_of_the_friction_stir_gantry_follows_the_heading_upright_and_leaning() {
    for tilt in [StirTilt::Positive, StirTilt::Negative] {
        let machine = stir_gantry(tilt);
        for lean in [0.0f64, 1e-10, 1e-6, 0.0436] {
            let at = |lambda: f64| {
                let heading = 1.0 + 4.0 * PI * lambda;
                let travel = Vector3::new(heading.cos(), heading.sin(), 0.0);
                let normal = Vector3::z() * lean.cos() - travel * lean.sin();
                let tangent = travel * lean.cos() + Vector3::z() * lean.sin();
                Pose::new(travel * 50.0, tangent, normal).expect("a pose")
            };
            let ahead = if tilt == StirTilt::Positive { PI } else { 0.0 };
            let mut start = [0.0; AXES];
            start[5] = 1.0 + ahead;
            start[4] = if tilt == StirTilt::Positive { lean } else { -lean };
            // Rounding of N over its tilt is what C can be off by.
            let rounding = if lean > 1e-9 { 1e-15 / lean } else { 0.0 };
            let end = walk(
                &machine,
                start,
                way().map(at),
                4.0 * PI / STEPS as f64 + 2.0 * rounding,
            );
            assert!(
                (end[5] - start[5] - 4.0 * PI).abs() < 1e-9 + rounding,
                "{tilt:?} {lean}: {end:?}"
            );
        }
    }
}

#[test]
fn the_ac_head_turns_on_over_half_turns_within_its_travel() {
    let machine = ac_head();
    let at = |lambda: f64| {
        let (c, a) = (-2.0 * PI + 4.0 * PI * lambda, 0.4f64);
        let normal = Vector3::new(c.sin() * a.sin(), -c.cos() * a.sin(), a.cos());
        Pose::pointing(Vector3::zeros(), normal).expect("a pose")
    };
    let mut start = [0.0; AXES];
    (start[3], start[5]) = (0.4, -2.0 * PI);
    let end = walk(&machine, start, way().map(at), 4.0 * PI / STEPS as f64);
    assert!((end[5] - 2.0 * PI).abs() < 1e-9);
}

#[test]
fn the_ac_head_passes_its_pole_by_a_change_of_sign() {
    let machine = ac_head();
    let c = 2.5f64;
    let at = |lambda: f64| {
        let a = 0.6 - 1.2 * lambda;
        Pose::pointing(
            Vector3::zeros(),
            Vector3::new(c.sin() * a.sin(), -c.cos() * a.sin(), a.cos()),
        )
        .expect("a pose")
    };
    let mut start = [0.0; AXES];
    (start[3], start[5]) = (0.6, c);
    // A middle step stands exactly upright.
    assert!(at(0.5).normal.xy().norm() < 1e-15);
    let end = walk(&machine, start, way().map(at), 1.2 / STEPS as f64 + 1e-12);
    assert!(
        (end[3] + 0.6).abs() < 1e-12 && (end[5] - c).abs() < 1e-12,
        "{end:?}"
    );
}

#[test]
fn the_ac_head_takes_the_nearest_solution_within_its_travel() {
    let mut random = Random(9);
    let machine = ac_head();
    for _ in 0..10_000 {
        let near = random.axes(&machine);
        let pose = machine.kinematics.forward(&random.axes(&machine));
        let axes = machine
            .kinematics
            .inverse(&pose, &near)
            .expect("a reachable pose");
        assert!(!Bits(violations(&axes, &machine.limits).0 & 0b101000).any());
        // The twin and the turns of both: none within the travel is nearer.
        for (a, c) in [
            (axes[3], axes[5]),
            (-axes[3], axes[5] + PI),
            (-axes[3], axes[5] - PI),
        ] {
            for turns in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                let c = c + turns * 2.0 * PI;
                let other = [axes[0], axes[1], axes[2], a, 0.0, c];
                if !Bits(violations(&other, &machine.limits).0 & 0b101000).any() {
                    assert!((c - near[5]).abs() >= (axes[5] - near[5]).abs() - 1e-11);
                }
            }
        }
    }
}

/// Half a turn between two equally near solutions: the smaller way of A decides.
#[test]
fn of_two_equally_near_solutions_of_the_ac_head_a_decides() {
    let machine = ac_head();
    // C = ±90° from near, A = ±0.5.
    let pose =
        Pose::pointing(Vector3::zeros(), Vector3::new(0.5f64.sin(), 0.0, 0.5f64.cos())).expect("a pose");
    for a in [0.4, -0.4] {
        let axes = machine.kinematics.inverse(&pose, &[0.0, 0.0, 0.0, a, 0.0, 0.0]);
        assert!((axes.expect("reachable")[3] - a.signum() * 0.5).abs() < 1e-12);
    }
}

/// With one sign of A there is no twin: beyond the end of its travel C comes back by a whole turn.
#[test]
fn where_the_travel_of_c_ends_another_turn_is_taken() {
    let machine = ac_head_within((0.0, 90.0), (-360.0, 360.0));
    for end in [1.0, -1.0] {
        let (near, beyond) = (end * (2.0 * PI - 0.1), end * (2.0 * PI + 0.1));
        let pose = machine.kinematics.forward(&[0.0, 0.0, 0.0, 0.4, 0.0, beyond]);
        let axes = machine
            .kinematics
            .inverse(&pose, &[0.0, 0.0, 0.0, 0.4, 0.0, near]);
        assert!((axes.expect("reachable")[5] - end * 0.1).abs() < 1e-12);
    }
}

/// The dual-beam gantry has one solution within ±90° of B, whatever is near.
#[test]
fn the_dual_beam_gantry_has_one_solution() {
    let machine = dual_beam();
    let mut random = Random(12);
    for _ in 0..1000 {
        let pose = machine.kinematics.forward(&random.axes(&machine));
        let one = machine.kinematics.inverse(&pose, &random.axes(&machine));
        assert_eq!(one, machine.kinematics.inverse(&pose, &random.axes(&machine)));
    }
}
