//! Each machine as a product of homogeneous matrices, joint by joint: another way to the same pose.

use crate::bench::{Machine, Random, ac_head, dual_beam, pipe_welder, stir_gantry, wire_arc};
use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use shared::io::AXES;
use shared::kinematics::{StirTilt, WireArcConfig};
use std::f64::consts::FRAC_PI_2;

fn shift(x: f64, y: f64, z: f64) -> Matrix4<f64> {
    Matrix4::new_translation(&Vector3::new(x, y, z))
}

fn turn(axis: Unit<Vector3<f64>>, angle: f64) -> Matrix4<f64> {
    Rotation3::from_axis_angle(&axis, angle).to_homogeneous()
}

fn rx(angle: f64) -> Matrix4<f64> {
    turn(Vector3::x_axis(), angle)
}

fn ry(angle: f64) -> Matrix4<f64> {
    turn(Vector3::y_axis(), angle)
}

fn rz(angle: f64) -> Matrix4<f64> {
    turn(Vector3::z_axis(), angle)
}

/// Asserts that forward gives the tip, and T and N as the columns named, of the product at random axes.
fn same(
    machine: &Machine,
    product: impl Fn(&[f64; AXES]) -> Matrix4<f64>,
    tangent: (usize, f64),
    normal: usize,
) {
    let mut random = Random(6);
    for _ in 0..10_000 {
        let axes = random.axes(machine);
        let pose = machine.kinematics.forward(&axes);
        let m = product(&axes);
        let column = |i: usize| m.fixed_view::<3, 1>(0, i).into_owned();
        let away = [
            (pose.position - column(3)).norm() / 1000.0,
            (pose.tangent - column(tangent.0) * tangent.1).norm(),
            (pose.normal - column(normal)).norm(),
        ];
        assert!(
            away.iter().all(|d| *d < 2e-14),
            "{}: {away:?} at {axes:?}",
            machine.name
        );
    }
}

#[test]
fn the_dual_beam_gantry_is_its_joints() {
    let product = |q: &[f64; AXES]| {
        shift(q[0], q[1], q[2])
            * rz(q[5])
            * shift(-22.7, 62.5, -22.2)
            * ry(q[4])
            * shift(-37.8, 11.3, -58.8)
            * rx(q[3])
            * shift(-0.18, -0.51, -615.6)
    };
    same(&dual_beam(), product, (0, 1.0), 2);
}

/// The arm lies along x of the turning frame, the torch along x of the tilting one.
#[test]
fn the_pipe_welder_is_its_joints() {
    let product = |q: &[f64; AXES]| rz(q[5]) * shift(q[0], 0.0, q[2]) * ry(-q[4]) * shift(-85.0, 0.0, 0.0);
    same(&pipe_welder(), product, (1, 1.0), 0);
}

#[test]
fn the_ac_head_is_its_joints() {
    let product = |q: &[f64; AXES]| {
        shift(q[0], q[1], q[2]) * rz(q[5]) * shift(18.2, -40.1, 40.8) * rx(q[3]) * shift(-19.0, -18.5, -236.4)
    };
    same(&ac_head(), product, (0, 1.0), 2);
}

/// From the machine to the torch and from the machine to the part; the torch in the part's frame is the inverse of
/// the one times the other.
#[test]
fn the_wire_arc_robot_is_its_two_chains() {
    let torch = |q: &[f64; AXES]| shift(q[0], q[1], q[2]) * rx(q[3]) * shift(3.1, -7.4, -310.5);
    let part = |q: &[f64; AXES]| shift(612.3, 407.9, -151.2) * ry(q[4]) * shift(-4.6, 12.8, 96.7) * rz(q[5]);
    let product = |q: &[f64; AXES]| part(q).try_inverse().expect("rigid") * torch(q);
    same(&wire_arc(), product, (0, 1.0), 2);
}

/// Signs, by hand: turntable at (1000, 0, 0) with its face 100 above the tilt axis, torch straight down by 200.
#[test]
fn the_positioner_turns_left_and_tilts_towards_x() {
    use shared::kinematics::{AxisLimits, Chain};
    let robot = WireArcConfig {
        torch_mm: [0.0, 0.0, -200.0],
        tilt_axis_mm: [1000.0, 0.0, 0.0],
        turntable_mm: [0.0, 0.0, 100.0],
    };
    let robot = robot
        .build(&[AxisLimits::NOT_FITTED; AXES])
        .expect("a valid geometry");
    let near = |seen: Vector3<f64>, x: f64, y: f64, z: f64| {
        assert!((seen - Vector3::new(x, y, z)).norm() < 1e-9, "{seen}");
    };
    // The tip 50 beyond the centre along y stands, after a quarter turn of C, on the part's x axis.
    let pose = robot.forward(&[1000.0, 50.0, 300.0, 0.0, 0.0, FRAC_PI_2]);
    near(pose.position, 50.0, 0.0, 0.0);
    near(pose.normal, 0.0, 0.0, 1.0);
    near(pose.tangent, 0.0, -1.0, 0.0);
    // Tilted by B = 90° the face looks along x, and a tip 7 in front of it is 7 above the part's centre.
    let pose = robot.forward(&[1107.0, 0.0, 200.0, 0.0, FRAC_PI_2, 0.0]);
    near(pose.position, 0.0, 0.0, 7.0);
    near(pose.normal, -1.0, 0.0, 0.0);
    // A = 90° carries the tip from below the A axis to beyond it along y.
    let pose = robot.forward(&[1000.0, -200.0, 100.0, FRAC_PI_2, 0.0, 0.0]);
    near(pose.position, 0.0, 0.0, 0.0);
    near(pose.normal, 0.0, -1.0, 0.0);
}

/// The Denavit–Hartenberg product of mathematics 4.1.
#[test]
fn the_friction_stir_gantry_is_its_denavit_hartenberg_product() {
    let link = |theta: f64, d: f64, alpha: f64| rz(theta) * shift(0.0, 0.0, d) * rx(alpha);
    // The base frame's x, y, z are the machine's Y, Z, X.
    let base = Matrix4::from_columns(&[
        Vector3::y().push(0.0),
        Vector3::z().push(0.0),
        Vector3::x().push(0.0),
        Vector3::zeros().push(1.0),
    ]);
    let product = |q: &[f64; AXES]| {
        let home = shift(0.0, 0.0, 305.0);
        let chain = link(FRAC_PI_2, -q[0], FRAC_PI_2)
            * link(FRAC_PI_2, q[1], FRAC_PI_2)
            * link(0.0, q[2], 0.0)
            * link(q[5], 0.0, -FRAC_PI_2)
            * link(q[4], 0.0, FRAC_PI_2)
            * link(0.0, -305.0, 0.0);
        home * base * chain
    };
    same(&stir_gantry(StirTilt::Positive), product, (0, -1.0), 2);
    same(&stir_gantry(StirTilt::Negative), product, (0, 1.0), 2);
}
