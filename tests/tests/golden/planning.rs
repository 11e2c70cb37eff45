//! Planning of the dual-beam head (mathematics 0.5, 0.6).

use super::file::{Golden, near, near_all, number, vector};
use super::kinematics::machine;
use dual_beam::{
    LocateError, Location, Polyline, SeamPlace, closest_approach, locate, locate_symmetric, slide_extension,
};
use serde_json::Value;
use shared::geometry::{Pose, rotate};
use shared::kinematics::Chain;

fn class(error: LocateError) -> &'static str {
    match error {
        LocateError::Miss => "miss",
        LocateError::TooFar => "too far",
        LocateError::ParallelBeams => "parallel beams",
        LocateError::CrossBefore => "beams cross",
        LocateError::ZeroVector => "zero vector",
        LocateError::NoConvergence => "no convergence",
    }
}

fn polyline(value: &Value) -> Polyline {
    Polyline::new(value.as_array().expect("points").iter().map(vector).collect())
}

fn place(input: &Value) -> SeamPlace {
    SeamPlace {
        point: vector(&input["P1"]),
        tangent: vector(&input["t1"]),
        normal: vector(&input["n1"]),
    }
}

/// The result if there is one; otherwise the error was the wanted one.
fn expected<T>(case: &Value, result: Result<T, LocateError>) -> Option<T> {
    match (result, case["err"].as_str()) {
        (Ok(value), None) => Some(value),
        (Err(error), Some(wanted)) => {
            assert_eq!(class(error), wanted, "case {}", case["id"]);
            None
        }
        (Err(error), None) => panic!("case {}: {error}", case["id"]),
        (Ok(_), Some(wanted)) => panic!("case {}: no error, golden \"{wanted}\"", case["id"]),
    }
}

fn check_location(case: &Value, at: &Location, tolerance: f64) {
    let out = &case["out"];
    near_all(case, "P2", at.p2.as_slice(), &out["P2"], tolerance);
    near_all(case, "P3", at.tip.as_slice(), &out["P3"], tolerance);
    near_all(case, "T3", at.tangent.as_slice(), &out["T3"], tolerance);
    near_all(case, "N3", at.normal.as_slice(), &out["N3"], tolerance);
    near(case, "gap", at.gap, number(out, "gap"), tolerance);
    near(case, "sE", at.distance[0], number(out, "sE"), tolerance);
    near(case, "sF", at.distance[1], number(out, "sF"), tolerance);
}

/// Checks the file `m0_plan`.
pub fn m0_plan(golden: &Golden) {
    for case in &golden.cases {
        let input = &case["in"];
        let t2 = (!input["t2"].is_null()).then(|| vector(&input["t2"]));
        let result = locate(
            &place(input),
            &polyline(&input["L2"]),
            number(input, "theta1"),
            number(input, "theta2"),
            number(input, "gap_max"),
            input["sigma_prev"].as_f64(),
            t2,
        );
        let Some(at) = expected(case, result) else {
            continue;
        };
        check_location(case, &at, golden.tolerance);
        let out = &case["out"];
        near(case, "sigma2", at.sigma2, number(out, "sigma2"), golden.tolerance);
        near(case, "hits", at.hits as f64, number(out, "nhits"), 0.0);
        near_all(case, "N1", at.beams[0].as_slice(), &out["N1"], golden.tolerance);
        near_all(case, "N2", at.beams[1].as_slice(), &out["N2"], golden.tolerance);
    }
}

/// Checks the file `m0_beams`.
pub fn m0_beams(golden: &Golden) {
    for case in &golden.cases {
        let input = &case["in"];
        let [e, n1, f, n2] = ["E", "N1", "F", "N2"].map(|key| vector(&input[key]));
        let Some(at) = expected(case, closest_approach(&e, &n1, &f, &n2)) else {
            continue;
        };
        let out = &case["out"];
        near_all(case, "D", at.tip.as_slice(), &out["D"], golden.tolerance);
        near(case, "gap", at.gap, number(out, "gap"), golden.tolerance);
        let working = number(input, "ell") - number(input, "f") - number(input, "zd");
        for (k, (distance, extension)) in [("sE", "v1"), ("sF", "v2")].into_iter().enumerate() {
            near(
                case,
                distance,
                at.distance[k],
                number(out, distance),
                golden.tolerance,
            );
            let v = slide_extension(working, at.distance[k]);
            near(case, extension, v, number(out, extension), golden.tolerance);
        }
    }
}

/// Checks the file `m0_e2e`.
pub fn m0_e2e(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let (place, other) = (place(input), polyline(&input["L2"]));
        let (theta1, theta2) = (number(input, "theta1"), number(input, "theta2"));
        let gap_max = number(input, "gap_max");
        let result = match input["mode"].as_str() {
            Some("paper") => locate(&place, &other, theta1, theta2, gap_max, None, None),
            Some("sym") => locate_symmetric(&place, &other, theta1, theta2, gap_max, None),
            mode => panic!("case {}: mode {mode:?}", case["id"]),
        };
        let Some(at) = expected(case, result) else {
            continue;
        };
        check_location(case, &at, golden.tolerance);
        let pose = Pose::new(at.tip, at.tangent, at.normal).expect("a pose");
        let q = machine(case).inverse(&pose, &[0.0; 6]).expect("a solution");
        near_all(case, "q", &q, &out["q"], golden.tolerance);
        let working = number(input, "ell") - number(input, "f") - number(input, "zd");
        for (k, point) in [place.point, at.p2].into_iter().enumerate() {
            let turn = [-theta2, theta2][k] / 2.0;
            let axis = rotate(&pose.tangent, turn, &pose.normal);
            near_all(
                case,
                "beam",
                axis.as_slice(),
                &out[["beam1", "beam2"][k]],
                golden.tolerance,
            );
            let off = (point - at.tip).cross(&axis).norm();
            assert!(off < 1e-8, "case {}: beam {} misses by {off}", case["id"], k + 1);
            let v = slide_extension(working, at.distance[k]);
            near(case, "v", v, number(out, ["v1", "v2"][k]), golden.tolerance);
        }
    }
}
