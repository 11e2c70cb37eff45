//! Speeds: inside the window and what the machine can do, and what is said where it cannot.

use super::super::window::ProcessWindow;
use super::*;
use crate::bead::speed::{FeedStep, Limit, plan as plan_speed};
use nalgebra::Vector3;
use shared::io::AXES;
use shared::kinematics::AxisLimits;
use shared::trajectory::at_unit_speed;

const WINDOW: ProcessWindow = ProcessWindow { low: 4.0, high: 16.0 };

/// Largest |q̇|, |q̈| and |q⃛| of every axis on a path at its speed, against the axes' limits.
fn shares(path: &PlannedPath, machine: &MachineFile) -> [f64; 3] {
    let limits = AxisLimits::build_all(&machine.motion.axes).unwrap();
    let planner = Planner::build(machine).unwrap();
    let (curve, v) = (path.knot_path(), path.limits.velocity);
    let dt = 1e-3;
    let mut near = [0.0; AXES];
    let mut past: Vec<[f64; AXES]> = Vec::new();
    let mut largest = [0.0_f64; 3];
    let count = (path.length_mm() / v / dt) as usize;
    for k in 0..count {
        let point = curve.at(v * dt * k as f64).unwrap();
        let at = at_unit_speed(planner.kinematics(), &point, path.space, &near).unwrap();
        let at = at.at_speed(v, 0.0);
        near = at.position;
        past.push(at.acceleration);
        for axis in 0..AXES {
            let mut seen = [at.velocity[axis], at.acceleration[axis], 0.0];
            if k >= 20 {
                seen[2] = (past[k][axis] - past[k - 20][axis]) / (20.0 * dt);
            }
            let allowed = [
                limits[axis].velocity,
                limits[axis].acceleration,
                limits[axis].jerk,
            ];
            for i in 0..3 {
                largest[i] = largest[i].max(seen[i].abs() / allowed[i]);
            }
        }
    }
    largest
}

/// The leaf needs no slowing down: one F, inside the window and inside what every axis can do.
#[test]
fn the_leaf_runs_at_one_speed_that_curve_and_axes_allow() {
    let machine = machine();
    let plan = plan(&leaf(), &machine).unwrap();
    assert_eq!(plan.program.matches(" F").count(), 2, "one for each layer");
    for path in feed_paths(&plan.program, &machine) {
        let v = path.limits.velocity;
        assert!((WINDOW.low..=WINDOW.high).contains(&v), "{v}");
        // ∛(8000·0.332²): the sharpest corner at the machine's jerk.
        assert!((9.3..9.8).contains(&v), "{v}");
        let shares = shares(&path, &machine);
        assert!(shares.iter().all(|share| *share <= 1.0), "{shares:?}");
    }
    assert!(
        plan.notes
            .iter()
            .any(|note| note.contains("one speed of 9.5") && note.contains("radius of 0.33 mm")),
        "{:?}",
        plan.notes
    );
}

/// The axis that is weak decides, and is named.
#[test]
fn a_weak_axis_lowers_the_speed_and_is_named() {
    let mut machine = machine();
    let y = machine.motion.axes[1].as_mut().unwrap();
    y.max_jerk = 2000.0;
    let plan = plan(&leaf(), &machine).unwrap();
    let path = &feed_paths(&plan.program, &machine)[0];
    let shares = shares(path, &machine);
    assert!(shares[2] > 0.5 && shares[2] <= 1.0, "{shares:?}");
    assert!(
        plan.notes[3].contains("limited by the jerk of Y"),
        "{}",
        plan.notes[3]
    );
}

fn limits(speeds: &[f64]) -> Vec<Limit> {
    let limit = |(i, speed): (usize, &f64)| Limit {
        s: i as f64 + 0.5,
        place: Vector3::x() * i as f64,
        speed: *speed,
        cause: "this test".to_owned(),
    };
    speeds.iter().enumerate().map(limit).collect()
}

/// Motions that end at 1, 2, 3… with one limit in each.
fn steps(speeds: &[f64]) -> Vec<(usize, f64)> {
    let targets: Vec<f64> = (1..=speeds.len()).map(|i| i as f64).collect();
    let plan = plan_speed(&limits(speeds), &targets, &WINDOW).unwrap();
    plan.feeds
        .iter()
        .map(|FeedStep { target, mm_min }| (*target, *mm_min))
        .collect()
}

#[test]
fn one_speed_where_the_machine_can_and_slow_stretches_where_it_cannot() {
    assert_eq!(steps(&[30.0, 20.0, 25.0]), [(0, 960.0)]);
    assert_eq!(steps(&[30.0, 7.5, 25.0]), [(0, 450.0)]);
    assert_eq!(steps(&[30.0, 7.5012, 25.0]), [(0, 450.0)]);
    assert_eq!(steps(&[9.0, 4.0, 9.0]), [(0, 240.0)]);
    // Below the window, each corner is one stretch at its slowest.
    let corners = [9.0, 3.0, 2.0, 9.0, 9.0, 1.93, 9.0];
    assert_eq!(
        steps(&corners),
        [(0, 240.0), (1, 120.0), (3, 240.0), (5, 115.8), (6, 240.0)]
    );
    let targets: Vec<f64> = (1..=corners.len()).map(|i| i as f64).collect();
    let plan = plan_speed(&limits(&corners), &targets, &WINDOW).unwrap();
    assert_eq!((plan.constant, plan.slowest.speed), (4.0, 1.93));
    let below: Vec<_> = plan.below.iter().map(|limit| (limit.s, limit.speed)).collect();
    assert_eq!(below, [(2.5, 2.0), (5.5, 1.93)]);
}

#[test]
fn more_slow_corners_than_the_boards_have_steps_are_refused() {
    let speeds =
        |count: usize| -> Vec<f64> { (0..2 * count + 1).map(|i| 5.0 - 2.0 * (i % 2) as f64).collect() };
    assert_eq!(steps(&speeds(62)).len(), 125);
    let targets: Vec<f64> = (1..=127).map(f64::from).collect();
    let error = plan_speed(&limits(&speeds(63)), &targets, &WINDOW).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("in 63 corners, and the boards change the speed in 62"),
        "{error}"
    );
}

/// A machine that is too weak for the sharp corners: the lowest speed of the window, and less in some corners, which
/// the notes name.
#[test]
fn what_the_machine_cannot_do_inside_the_window_is_slower_and_said() {
    let mut machine = machine();
    machine.planning.path_jerk_mm_s3 = 300.0;
    let plan = plan(&leaf(), &machine).unwrap();
    let path = &feed_paths(&plan.program, &machine)[0];
    assert_eq!(path.limits.velocity, 4.0);
    let steps: Vec<f64> = path.steps.iter().map(|step| step.velocity).collect();
    // ∛(300·ρ²) < 4 below 0.462 mm: seven corners of the leaf, the sharpest at 3.2 mm/s.
    assert_eq!(steps.len(), 14, "{steps:?}");
    let slowest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(
        (slowest - libm::cbrt(300.0 * 0.332 * 0.332)).abs() < 0.02,
        "{slowest}"
    );
    let warnings: Vec<_> = plan
        .notes
        .iter()
        .filter(|note| note.starts_with("below the window"))
        .collect();
    assert_eq!(warnings.len(), 7, "{:?}", plan.notes);
    assert!(
        warnings[0].contains("mm/s at X32.") && warnings[0].contains("radius of 0.3"),
        "{}",
        warnings[0]
    );
    // √(4³/300).
    assert!(
        plan.notes
            .iter()
            .any(|note| note.contains("WARNING") && note.contains("radius of 0.46 mm on")),
        "{:?}",
        plan.notes
    );
    // What the boards are given keeps the curve's own limit everywhere.
    for leg in path.legs() {
        let element = leg.unwrap().element;
        for i in 0..=20 {
            let bend = element.at(element.length * f64::from(i) / 20.0).second;
            let curvature = libm::sqrt(bend[..3].iter().map(|x| x * x).sum());
            let jerk = element.feed * element.feed * element.feed * curvature * curvature;
            assert!(jerk <= 300.0 * 1.01, "{jerk} mm/s³ in line {}", element.line);
        }
    }
}
