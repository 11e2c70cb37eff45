//! Where an axis has no effect on the tool: it stays, and a motion that would need it to jump is refused.

use crate::bench::{Machine, ac_head, dual_beam, pipe_welder, stir_gantry, wire_arc};
use nalgebra::Vector3;
use shared::geometry::{Pose, PoseMotion};
use shared::io::AXES;
use shared::kinematics::{KinematicsError, StirTilt};

const B: usize = 4;
const C: usize = 5;

fn motion(v: Vector3<f64>, omega: Vector3<f64>, alpha: Vector3<f64>) -> PoseMotion {
    PoseMotion {
        velocity: v,
        angular_velocity: omega,
        acceleration: Vector3::zeros(),
        angular_acceleration: alpha,
    }
}

/// A tool that points straight up, with its T at the heading.
fn upright(position: Vector3<f64>, heading: f64) -> Pose {
    Pose {
        position,
        tangent: Vector3::new(heading.cos(), heading.sin(), 0.0),
        normal: Vector3::z(),
    }
}

/// Rates of `machine` in the pose, near C = `c`.
fn rates(
    machine: &Machine,
    pose: &Pose,
    motion: &PoseMotion,
    c: f64,
) -> Result<[f64; AXES], KinematicsError> {
    let near = [300.0, 0.0, 0.0, 0.0, 0.0, c];
    let together = machine.kinematics.inverse_motion(pose, motion, &near)?;
    let apart = machine.kinematics.derivatives(&together.position, motion)?;
    assert_eq!(apart.0, together.velocity);
    Ok(together.velocity)
}

#[test]
fn an_upright_ac_head_keeps_c_and_tilts_only_about_its_a_axis() {
    let machine = ac_head();
    let c = 0.8f64;
    let pose = upright(Vector3::new(10.0, 20.0, 30.0), 2.0);
    for tilt in [0.0, 5e-10] {
        let pose = Pose::new(pose.position, pose.tangent, Vector3::new(tilt, 0.0, 1.0)).expect("a pose");
        let axes = machine
            .kinematics
            .inverse(&pose, &[0.0, 0.0, 0.0, 0.5, 0.0, c])
            .expect("reachable");
        assert_eq!((axes[3], axes[5]), (0.0, c));
        assert!((machine.kinematics.forward(&axes).position - pose.position).norm() < 1e-12);
    }
    let (a_axis, across) = (
        Vector3::new(c.cos(), c.sin(), 0.0),
        Vector3::new(-c.sin(), c.cos(), 0.0),
    );
    let (zero, v) = (Vector3::zeros(), Vector3::new(3.0, -2.0, 1.0));
    // Travel alone, and spin about the tool itself, need no turn.
    let seen = rates(&machine, &pose, &motion(v, Vector3::z() * 0.7, zero), c).expect("no turn needed");
    assert_eq!(seen, [3.0, -2.0, 1.0, 0.0, 0.0, 0.0]);
    let seen = rates(&machine, &pose, &motion(zero, a_axis * 0.3, zero), c).expect("no turn needed");
    assert!((seen[3] - 0.3).abs() < 1e-15 && seen[5] == 0.0);
    // A tilt across needs C to jump by a quarter turn.
    let pole = KinematicsError::Pole { axis: C };
    for across in [motion(zero, across * 0.3, zero), motion(zero, zero, across * 0.3)] {
        assert_eq!(rates(&machine, &pose, &across, c), Err(pole));
    }
    assert_eq!(
        pole.to_string(),
        "pole of C: the axis would have to jump; turn it earlier, or avoid the pole"
    );
}

#[test]
fn an_upright_stirring_pin_turns_with_the_heading() {
    for (tilt, behind) in [
        (StirTilt::Positive, std::f64::consts::PI),
        (StirTilt::Negative, 0.0),
    ] {
        let machine = stir_gantry(tilt);
        let heading = 0.4f64;
        let pose = upright(Vector3::new(10.0, 20.0, 30.0), heading);
        let axes = machine
            .kinematics
            .inverse(&pose, &[0.0, 0.0, 0.0, 0.0, 0.0, heading + behind]);
        let axes = axes.expect("reachable");
        assert_eq!(axes[B], 0.0);
        assert!((axes[C] - heading - behind).abs() < 1e-15);
        // B tilts about e_B = (−sinC, cosC, 0), the head turns about z.
        let (sin, cos) = axes[C].sin_cos();
        let b_axis = Vector3::new(-sin, cos, 0.0);
        let zero = Vector3::zeros();
        let turn = motion(zero, Vector3::z() * 0.7 + b_axis * 0.1, Vector3::z() * 0.2);
        // N̈ across is 2 Ḃ Ċ: what ω × (ω × N) makes of the two turns, and the tilting axis turns with C.
        let turn = PoseMotion {
            angular_acceleration: turn.angular_acceleration + Vector3::z().cross(&b_axis) * 0.07,
            ..turn
        };
        let seen = rates(&machine, &pose, &turn, axes[C]).expect("C follows");
        assert!(
            (seen[B] - 0.1).abs() < 1e-12 && (seen[C] - 0.7).abs() < 1e-12,
            "{seen:?}"
        );
        let across = motion(zero, Vector3::new(cos, sin, 0.0) * 0.1, zero);
        assert_eq!(
            rates(&machine, &pose, &across, axes[C]),
            Err(KinematicsError::Pole { axis: C })
        );
    }
}

#[test]
fn on_the_axis_of_the_pipe_the_waist_stays_and_the_tip_leaves_along_the_arm() {
    let machine = pipe_welder();
    let c = 0.8f64;
    let (e_r, e_t) = (
        Vector3::new(c.cos(), c.sin(), 0.0),
        Vector3::new(-c.sin(), c.cos(), 0.0),
    );
    let pose = Pose {
        position: Vector3::z() * 40.0,
        tangent: e_t,
        normal: e_r * 0.6 + Vector3::z() * 0.8,
    };
    let zero = Vector3::zeros();
    let up = rates(&machine, &pose, &motion(Vector3::z() * 5.0, zero, zero), c).expect("no turn needed");
    assert_eq!(up, [0.0, 0.0, 5.0, 0.0, 0.0, 0.0]);
    let out = rates(&machine, &pose, &motion(e_r * 5.0, zero, zero), c).expect("no turn needed");
    assert!((out[0] - 5.0).abs() < 1e-12 && out[C] == 0.0);
    for v in [e_t * 5.0, e_r * -5.0] {
        let seen = rates(&machine, &pose, &motion(v, zero, zero), c);
        assert_eq!(seen, Err(KinematicsError::Pole { axis: C }), "{v}");
    }
    // A torch that points along the weld has no elevation.
    let along = Pose {
        position: e_r * 40.0,
        tangent: -Vector3::z(),
        normal: e_t,
    };
    assert_eq!(
        machine.kinematics.inverse(&along, &[0.0; AXES]),
        Err(KinematicsError::Pole { axis: B })
    );
}

#[test]
fn a_vertical_tangent_locks_the_machines_that_follow_it() {
    for machine in [dual_beam(), wire_arc()] {
        let pose = Pose {
            position: Vector3::zeros(),
            tangent: Vector3::z(),
            normal: Vector3::x(),
        };
        let motion = motion(Vector3::x(), Vector3::zeros(), Vector3::zeros());
        let near = [0.0; AXES];
        let kinematics = &machine.kinematics;
        assert_eq!(kinematics.inverse(&pose, &near), Err(KinematicsError::GimbalLock));
        assert_eq!(
            kinematics.inverse_motion(&pose, &motion, &near),
            Err(KinematicsError::GimbalLock)
        );
        let locked = [0.0, 0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0];
        assert_eq!(
            kinematics.derivatives(&locked, &motion),
            Err(KinematicsError::GimbalLock)
        );
    }
}
