//! Axes to pose and back, over the whole travel.

use crate::bench::{Machine, Random, frame, machines, pipe_welder};
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::kinematics::violations;

const POSES: usize = 100_000;

/// The worst distances that [`POSES`] random poses of `machine` come back with: of the tip \[mm\], and of the
/// directions \[rad\].
fn worst(machine: &Machine) -> (f64, f64) {
    let mut random = Random(1);
    let (mut mm, mut rad) = (0.0f64, 0.0f64);
    for _ in 0..POSES {
        let pose = machine.kinematics.forward(&random.axes(machine));
        let near = random.axes(machine);
        let axes = machine
            .kinematics
            .inverse(&pose, &near)
            .expect("a reachable pose");
        let back = machine.kinematics.forward(&axes);
        mm = mm.max((back.position - pose.position).norm());
        rad = rad.max((back.normal - pose.normal).norm());
        if machine.unique {
            rad = rad.max((back.tangent - pose.tangent).norm());
        }
    }
    (mm, rad)
}

#[test]
fn a_hundred_thousand_random_poses_a_machine_come_back_within_a_picometre() {
    for machine in machines() {
        let (mm, rad) = worst(&machine);
        println!("{}: {mm:.1e} mm, {rad:.1e} rad over {POSES} poses", machine.name);
        assert!(mm <= 1e-9 && rad <= 1e-9, "{}: {mm} mm, {rad} rad", machine.name);
    }
}

#[test]
fn axes_come_back_from_near_by() {
    for machine in machines() {
        let mut random = Random(2);
        for _ in 0..10_000 {
            let axes = random.axes(&machine);
            let near = axes.map(|x| x + random.within(-0.1, 0.1));
            // Near its pole an angle is as uncertain as the direction is small: leave it out.
            let sin = |angle: f64| if angle == 0.0 { 1.0 } else { angle.sin().abs() };
            if sin(axes[3]).min(sin(axes[4])) < 0.01 {
                continue;
            }
            let pose = machine.kinematics.forward(&axes);
            let back = machine
                .kinematics
                .inverse(&pose, &near)
                .expect("a reachable pose");
            for (axis, (back, axis_was)) in back.iter().zip(axes).enumerate() {
                let tolerance = if axis < 3 { 1e-9 } else { 1e-12 };
                assert!(
                    (back - axis_was).abs() <= tolerance,
                    "{}: axis {axis} {axis_was} came back as {back}",
                    machine.name
                );
            }
            assert!(!violations(&back, &machine.limits).any(), "{}", machine.name);
        }
    }
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    for machine in machines() {
        let mut random = Random(3);
        for _ in 0..10_000 {
            let [t, m, n] = frame(&machine.kinematics.forward(&random.axes(&machine)));
            for (u, v, dot) in [(t, t, 1.0), (n, n, 1.0), (t, n, 0.0)] {
                assert!((u.dot(&v) - dot).abs() < 1e-14, "{}", machine.name);
            }
            assert!((t.cross(&m) - n).norm() < 1e-14, "{}", machine.name);
        }
    }
}

#[test]
fn the_pipe_welder_realises_the_part_of_n_in_the_plane_of_its_arm() {
    let machine = pipe_welder();
    let mut random = Random(4);
    for _ in 0..10_000 {
        let wanted = machine.kinematics.forward(&random.axes(&machine));
        let lean = random.within(-0.5, 0.5);
        let pose = Pose {
            normal: wanted.normal * lean.cos() + wanted.tangent * lean.sin(),
            tangent: wanted.tangent * lean.cos() - wanted.normal * lean.sin(),
            ..wanted
        };
        let axes = machine.kinematics.inverse(&pose, &[0.0; 6]).expect("a solution");
        let seen = machine.kinematics.forward(&axes);
        assert!((seen.position - wanted.position).norm() < 1e-9);
        assert!((seen.normal - wanted.normal).norm() < 1e-12);
    }
}

#[test]
fn a_pose_that_is_not_a_number_is_none() {
    let bad = Vector3::new(0.0, f64::NAN, 0.0);
    let (x, z) = (Vector3::x(), Vector3::z());
    assert!(Pose::new(bad, x, z).is_err() && Pose::new(x, bad, z).is_err() && Pose::new(x, x, bad).is_err());
}

/// Axes before that are not a number never pass for axes within the travel.
#[test]
fn near_that_is_not_a_number_is_refused_or_leaves_no_trace() {
    for machine in machines() {
        let pose = machine.kinematics.forward(&Random(5).axes(&machine));
        if let Ok(axes) = machine.kinematics.inverse(&pose, &[f64::NAN; 6]) {
            assert!(
                axes.iter().all(|x| x.is_finite()) || violations(&axes, &machine.limits).any(),
                "{}: {axes:?}",
                machine.name
            );
        }
    }
}
