//! Where the tool truly is, against the closed forms of the machines and against geometry by hand.

use super::*;
use config::machine::MachineFile;
use nalgebra::{Rotation3, Vector3};
use plant::AngularError;
use shared::geometry::Pose;
use shared::kinematics::AxisLimits;

/// Angles about x, y and z.
const A: usize = 0;
const B: usize = 1;
const C: usize = 2;

fn machine(name: &str) -> MachineFile {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines");
    MachineFile::read(format!("{folder}/{name}.toml").as_ref()).unwrap()
}

/// Axes from all over the travel of a machine (mm, rad).
fn stands(machine: &MachineFile) -> Vec<[f64; AXES]> {
    let limits = AxisLimits::build_all(&machine.motion.axes).unwrap();
    let share = |i: usize, axis: usize| ((i * (2 * axis + 3)) as f64 * 0.618).fract();
    let place = |i: usize, axis: usize| {
        let AxisLimits { min, max, .. } = limits[axis];
        min + (max - min) * share(i, axis)
    };
    (0..200)
        .map(|i| std::array::from_fn(|axis| place(i, axis)))
        .collect()
}

/// The machine that is called so, with errors about, along.
fn chain(name: &str, errors: &[(usize, usize, AngularError)]) -> TrueChain {
    let mut file = PlantFile::shipped(name).unwrap();
    for (about, along, error) in errors {
        file.angular[*along][*about] = *error;
    }
    file.chain(&machine(name).motion).unwrap()
}

fn constant(deg: f64) -> AngularError {
    AngularError {
        constant: deg,
        ..AngularError::default()
    }
}

fn near(is: &Pose, wanted: &Pose) {
    let off = [
        (is.position - wanted.position) * 1e-3,
        is.tangent - wanted.tangent,
        is.normal - wanted.normal,
    ];
    assert!(
        off.iter().all(|off| off.norm() < 1e-12),
        "{is:?} is not {wanted:?}"
    );
}

#[test]
fn joints_one_after_the_other_are_the_closed_form_of_every_machine() {
    for name in names() {
        let machine = machine(name);
        let kinematics = machine.motion.kinematics().unwrap();
        // Too small to be seen, but not none.
        let chain = chain(name, &[(A, 0, constant(1e-18))]);
        for axes in stands(&machine) {
            near(&chain.forward(&axes), &kinematics.forward(&axes));
        }
    }
}

/// What a joint turns about its own axis is what the axis turns; a turntable turns the work, so the tool the other way.
#[test]
fn an_error_about_a_rotary_axis_is_one_of_its_angle() {
    for (name, about, along, way) in [
        ("dual-beam-gantry", C, 5, 1.0),
        ("stir-gantry", C, 5, 1.0),
        ("pipe-welder", C, 5, 1.0),
        ("wire-arc", C, 5, -1.0),
    ] {
        let machine = machine(name);
        let kinematics = machine.motion.kinematics().unwrap();
        let slope = AngularError {
            slope: 0.01,
            ..AngularError::default()
        };
        let chain = chain(name, &[(about, along, slope)]);
        for axes in stands(&machine) {
            let mut turned = axes;
            turned[along] += way * 0.01 * axes[along];
            near(&chain.forward(&axes), &kinematics.forward(&turned));
        }
    }
}

/// A yaw of X takes the beam, the ram and the head with it about the zero of the carriage; a roll of Z only the head.
#[test]
fn a_carriage_turns_all_that_it_carries_about_its_zero() {
    let machine = machine("dual-beam-gantry");
    let kinematics = machine.motion.kinematics().unwrap();
    let yaw = AngularError {
        constant: 0.02,
        slope: 3e-5,
        wave: plant::Wave {
            amplitude: 0.004,
            period: 700.0,
        },
    };
    let pitch = constant(-0.05);
    let chain = chain("dual-beam-gantry", &[(C, 0, yaw), (B, 2, pitch)]);
    for axes in stands(&machine) {
        let [x, y, z, ..] = axes;
        let head = {
            let mut still = axes;
            [still[0], still[1], still[2]] = [0.0; 3];
            kinematics.forward(&still)
        };
        let angle = 0.02 + 3e-5 * x + 0.004 * (x / 700.0 * std::f64::consts::TAU).sin();
        let by_x = Rotation3::from_axis_angle(&Vector3::z_axis(), angle.to_radians());
        let by_z = Rotation3::from_axis_angle(&Vector3::y_axis(), -0.05_f64.to_radians());
        let wanted = Pose {
            position: Vector3::new(x, 0.0, 0.0) + by_x * (Vector3::new(0.0, y, z) + by_z * head.position),
            tangent: by_x * by_z * head.tangent,
            normal: by_x * by_z * head.normal,
        };
        near(&chain.forward(&axes), &wanted);
    }
}

/// An arm that is longer than believed.
#[test]
fn the_geometry_of_a_plant_file_is_the_true_one() {
    let text = include_str!("../../../../machines/stir-gantry.plant.toml");
    let text = format!("{text}\n[kinematics.stir-gantry]\nl4_mm = -305.25\ntilt = \"negative\"\n");
    let file = PlantFile::parse("my.plant.toml", &text).unwrap();
    let machine = machine("stir-gantry");
    let believed = machine.motion.kinematics().unwrap();
    let chain = file.chain(&machine.motion).unwrap();
    for axes in stands(&machine) {
        let [is, was] = [chain.forward(&axes), believed.forward(&axes)];
        let longer = (Vector3::z() - was.normal) * 0.25;
        near(
            &is,
            &Pose {
                position: was.position + longer,
                ..was
            },
        );
    }
}
