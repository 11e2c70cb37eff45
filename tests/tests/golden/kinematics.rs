//! The dual-beam gantry and attitude (mathematics 0.2–0.4).

use super::file::{Golden, near, near_all, number, numbers, vector};
use cam::attitude::interpolate;
use nalgebra::Vector3;
use serde_json::Value;
use shared::geometry::{Pose, PoseMotion};
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AxisConfig, AxisLimits, Chain, DualBeam, DualBeamConfig, feed_limit, violations};

pub fn machine(case: &Value) -> DualBeam {
    let geometry = &case["in"]["geo"];
    let array = |key: &str| -> [f64; 3] { numbers(&geometry[key]).try_into().expect("three numbers") };
    let across = numbers(&geometry["ot"]);
    let config = DualBeamConfig {
        o1_mm: array("o1"),
        o2_mm: array("o2"),
        o3_mm: [across[0], across[1], -number(geometry, "L")],
    };
    config
        .build(&[AxisLimits::NOT_FITTED; AXES])
        .expect("a valid geometry")
}

fn axes(value: &Value) -> [f64; AXES] {
    numbers(value).try_into().expect("six axes")
}

/// Travel and speeds of the published machine (mathematics 0.1).
fn limits() -> [AxisLimits; AXES] {
    let axis = |travel_min, travel_max, max_velocity| AxisConfig {
        travel_min,
        travel_max,
        max_velocity,
        max_acceleration: 1000.0,
        max_jerk: 10_000.0,
    };
    let configs = [
        axis(0.0, 5000.0, 1000.0 / 3.0),
        axis(0.0, 3000.0, 1000.0 / 3.0),
        axis(0.0, 1000.0, 500.0 / 3.0),
        axis(-100.0, 100.0, 120.0),
        axis(-30.0, 30.0, 120.0),
        axis(-90.0, 90.0, 120.0),
    ];
    AxisLimits::build_all(&configs.map(Some)).expect("valid limits")
}

/// Checks the file `m0_kin`.
pub fn m0_kin(golden: &Golden) {
    let (mm, rad) = (
        number(&golden.file["tol"], "mm"),
        number(&golden.file["tol"], "rad"),
    );
    for case in &golden.cases {
        let kinematics = machine(case);
        let (input, out) = (&case["in"], &case["out"]);
        if case["op"] == "fwd" {
            let pose = kinematics.forward(&axes(&input["q"]));
            near_all(case, "P", pose.position.as_slice(), &out["P"], mm);
            near_all(case, "N", pose.normal.as_slice(), &out["N"], rad);
            near_all(case, "T", pose.tangent.as_slice(), &out["T"], rad);
            continue;
        }
        let pose = Pose::new(vector(&input["P"]), vector(&input["T"]), vector(&input["N"]));
        let solved = pose
            .map_err(|e| e.to_string())
            .and_then(|pose| kinematics.inverse(&pose, &[0.0; AXES]).map_err(|e| e.to_string()));
        match solved {
            Ok(q) => {
                assert!(
                    case["err"].is_null(),
                    "case {}: {} was wanted",
                    case["id"],
                    case["err"]
                );
                let wanted = numbers(&out["q"]);
                for (i, (&seen, wanted)) in q.iter().zip(wanted).enumerate() {
                    near(case, AXIS_NAMES[i], seen, wanted, if i < 3 { mm } else { rad });
                }
                let outside = violations(&q, &limits());
                let names: Vec<Value> = (0..AXES)
                    .filter(|&i| outside.get(i))
                    .map(|i| AXIS_NAMES[i].into())
                    .collect();
                assert_eq!(Value::from(names), out["violations"], "case {}", case["id"]);
            }
            Err(error) => assert_eq!(case["err"], error, "case {}", case["id"]),
        }
    }
}

/// Checks the file `m0_vel`.
pub fn m0_vel(golden: &Golden) {
    for case in &golden.cases {
        let kinematics = machine(case);
        let (input, out) = (&case["in"], &case["out"]);
        let q = axes(&input["q"]);
        let (t, omega) = (vector(&input["t"]), vector(&input["omega"]));
        let motion = PoseMotion {
            velocity: t,
            angular_velocity: omega,
            acceleration: vector(&input["acc"]),
            angular_acceleration: vector(&input["alpha"]),
        };
        let (rates, accelerations) = kinematics.derivatives(&q, &motion).expect("derivatives");
        near_all(case, "qd", &rates, &out["qd"], golden.tolerance);
        near_all(case, "qdd", &accelerations, &out["qdd"], golden.tolerance);
        let (feed, axis) = feed_limit(&rates, &limits());
        near(case, "feed_max", feed, number(out, "feed_max"), golden.tolerance);
        assert_eq!(out["axis"], AXIS_NAMES[axis], "case {}", case["id"]);
        // The golden Jacobian takes the rates back to the twist.
        for (row, wanted) in (0..6).zip(t.iter().chain(omega.iter())) {
            let row = numbers(&out["J"][row]);
            let seen: f64 = row.iter().zip(rates).map(|(j, rate)| j * rate).sum();
            near(case, "J·qd", seen, *wanted, golden.tolerance);
        }
    }
}

/// Checks the file `m0_slerp`.
pub fn m0_slerp(golden: &Golden) {
    for case in &golden.cases {
        let input = &case["in"];
        let column = |matrix: &Value, c: usize| Vector3::from_fn(|r, _| numbers(&matrix[r])[c]);
        let pose = |p: &str, r: &str| Pose {
            position: vector(&input[p]),
            tangent: column(&input[r], 0),
            normal: column(&input[r], 2),
        };
        match interpolate(&pose("P0", "R0"), &pose("P1", "R1"), number(input, "lam")) {
            Ok(pose) => {
                assert!(
                    case["err"].is_null(),
                    "case {}: {} was wanted",
                    case["id"],
                    case["err"]
                );
                let out = &case["out"];
                near_all(case, "P", pose.position.as_slice(), &out["P"], golden.tolerance);
                for (c, seen) in [pose.tangent, pose.lateral(), pose.normal].iter().enumerate() {
                    let wanted = column(&out["R"], c);
                    near(case, "R", (seen - wanted).norm(), 0.0, golden.tolerance);
                }
            }
            Err(error) => assert_eq!(case["err"], error.to_string(), "case {}", case["id"]),
        }
    }
}
