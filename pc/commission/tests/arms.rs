//! Arms found from where a tip was seen, on machines whose true arms are known.

use commission::{Arms, NoArms, SeenTip, arms, rewrite_arms};
use config::machine::MachineFile;
use serde::Deserialize;
use shared::io::AXES;
use shared::kinematics::{AxisLimits, KinematicsConfig};
use std::path::Path;
use toml::{Table, Value};

const MACHINES: [&str; 5] = [
    "dual-beam-gantry",
    "pipe-welder",
    "ac-head",
    "wire-arc",
    "stir-gantry",
];

fn machine(name: &str) -> MachineFile {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines");
    MachineFile::read(&folder.join(format!("{name}.toml"))).expect("a machine")
}

/// Numbers that are no pattern, −1 to 1.
fn number(i: usize) -> f64 {
    2.0 * ((i as f64 + 1.0) * 0.754_877_666).fract() - 1.0
}

/// The machine with lengths that are off by up to so much.
fn off(believed: &KinematicsConfig, by: f64, from: usize) -> KinematicsConfig {
    fn change(value: &mut Value, by: f64, next: &mut usize) {
        match value {
            Value::Float(length) => {
                *length += by * number(*next);
                *next += 1;
            }
            Value::Array(values) => values.iter_mut().for_each(|value| change(value, by, next)),
            Value::Table(values) => values.iter_mut().for_each(|(_, value)| change(value, by, next)),
            _ => {}
        }
    }
    let mut table = Table::try_from(believed).expect("a table");
    let mut next = from;
    table
        .iter_mut()
        .for_each(|(_, value)| change(value, by, &mut next));
    KinematicsConfig::deserialize(table).expect("a geometry")
}

/// Axes all over their travel, rotary ones up to `swing` to both sides (mm, rad).
fn stands(limits: &[AxisLimits; AXES], count: usize, swing: f64) -> Vec<[f64; AXES]> {
    let axis = |i: usize, axis: usize| {
        let AxisLimits { min, max, .. } = limits[axis];
        let middle = (min + max) / 2.0;
        let half = if axis < 3 {
            (max - min) / 2.0
        } else {
            swing.min((max - min) / 2.0)
        };
        middle + half * number(7 * i + 3 * axis)
    };
    (0..count).map(|i| std::array::from_fn(|k| axis(i, k))).collect()
}

/// What is seen of a machine that is `truly` so, in a work that lies somewhere else, with a noise.
fn seen(
    believed: &KinematicsConfig,
    truly: &KinematicsConfig,
    limits: &[AxisLimits; AXES],
    stands: &[[f64; AXES]],
    noise_mm: f64,
) -> Vec<SeenTip> {
    let [believed, truly] = [believed, truly].map(|config| config.build(limits).expect("a machine"));
    let tip = |(i, axes): (usize, &[f64; AXES])| {
        let beside = truly.forward(axes).position - believed.forward(axes).position;
        SeenTip {
            axes: *axes,
            beside_mm: std::array::from_fn(|k| {
                beside[k] + [0.3, -0.2, 0.1][k] + noise_mm * number(31 * i + k)
            }),
        }
    };
    stands.iter().enumerate().map(tip).collect()
}

fn found(name: &str, by: f64, noise_mm: f64) -> (MachineFile, KinematicsConfig, [AxisLimits; AXES], Arms) {
    let machine = machine(name);
    let believed = machine.motion.kinematics.clone();
    let limits = AxisLimits::build_all(&machine.motion.axes).expect("limits");
    let truly = off(&believed, by, 5);
    let stands = stands(&limits, 30, 0.6);
    let found = arms(
        &believed,
        &limits,
        &seen(&believed, &truly, &limits, &stands, noise_mm),
    );
    (machine, truly, limits, found.expect("arms"))
}

/// Whatever the lengths are that have the same effect: a machine with what was found has its tip where the true one has it, but for
/// one place that all attitudes have alike, in attitudes that were not measured, too.
#[test]
fn a_machine_with_the_arms_that_were_found_is_the_true_one() {
    for name in MACHINES {
        let (machine, truly, limits, arms) = found(name, 0.3, 0.0);
        assert!(arms.before_mm[0] > 0.001, "{name}: {arms:?}");
        assert!(arms.left_mm[0] < 1e-9, "{name}: {arms:?}");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines");
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).expect("a file");
        let text = rewrite_arms(&text, name, &arms.all).expect("a machine file");
        assert!(text.contains("# commissioned; was"), "{name}");
        let written = MachineFile::parse("m.toml", &text)
            .expect("a machine")
            .motion
            .kinematics;
        let [is, was] =
            [&written, &machine.motion.kinematics].map(|config| config.build(&limits).expect("a machine"));
        let truly = truly.build(&limits).expect("a machine");
        let others = stands(&limits, 200, 1.5);
        let away = |axes: &[f64; AXES]| truly.forward(axes).position - is.forward(axes).position;
        let mean = others.iter().map(away).sum::<nalgebra::Vector3<f64>>() / others.len() as f64;
        for axes in &others {
            // Lengths are written to 0.1 µm.
            assert!(
                (away(axes) - mean).norm() < 1e-3,
                "{name}: {}",
                (away(axes) - mean).norm()
            );
        }
        assert_ne!(is, was, "{name}");
    }
}

/// A length that is seen by itself is as uncertain as it is told.
#[test]
fn uncertainties_are_those_of_what_was_found() {
    let (mut told, mut kept) = (0, 0);
    for name in MACHINES {
        for by in 0..8 {
            let machine = machine(name);
            let believed = machine.motion.kinematics.clone();
            let limits = AxisLimits::build_all(&machine.motion.axes).expect("limits");
            let truly = off(&believed, 0.2, 11 * by);
            let stands = stands(&limits, 27, 0.5);
            let tips = seen(&believed, &truly, &limits, &stands, 0.01);
            let found = arms(&believed, &limits, &tips).expect("arms");
            let exact = arms(
                &believed,
                &limits,
                &seen(&believed, &truly, &limits, &stands, 0.0),
            )
            .expect("arms");
            for (arm, exact) in found.all.iter().zip(&exact.all) {
                let Some(uncertainty) = arm.uncertainty_mm else {
                    continue;
                };
                told += 1;
                kept += usize::from((arm.found_mm - exact.found_mm).abs() <= uncertainty);
            }
        }
    }
    assert!(told > 60 && kept * 100 >= told * 90, "{kept} of {told}");
}

#[test]
fn what_tells_nothing_is_refused() {
    let machine = machine("ac-head");
    let believed = &machine.motion.kinematics;
    let limits = AxisLimits::build_all(&machine.motion.axes).expect("limits");
    let few = seen(believed, believed, &limits, &stands(&limits, 3, 0.6), 0.0);
    let error = arms(believed, &limits, &few).unwrap_err();
    assert_eq!(
        error,
        NoArms::Few {
            seen: 3,
            lengths: 6,
            wanted: 4
        }
    );
    let many = stands(&limits, 30, 0.6);
    let wrong = seen(believed, &off(believed, 20.0, 5), &limits, &many, 0.0);
    let error = arms(believed, &limits, &wrong).unwrap_err().to_string();
    assert!(
        error.contains("mm off, more than 5 mm: look at the machine file"),
        "{error}"
    );
    // A head that never turns tells nothing of its arms, and changes nothing.
    let still = stands(&limits, 30, 0.0);
    let found = arms(
        believed,
        &limits,
        &seen(believed, &off(believed, 0.3, 5), &limits, &still, 0.0),
    )
    .expect("arms");
    for arm in &found.all {
        assert_eq!(
            (arm.found_mm, arm.uncertainty_mm),
            (arm.before_mm, None),
            "{}",
            arm.name()
        );
    }
}
