//! The seam of two pipes (mathematics 1.1–1.3).

use super::file::{Golden, near, near_all, number};
use parts::pipes::{Intersection, PipePair, SaddleError, SeamFrame, SeamPoint, Sheet};
use serde_json::Value;

/// Tolerances of the file.
struct Tolerance {
    mm: f64,
    unit: f64,
}

/// Checks the file `saddle`.
pub fn saddle(golden: &Golden) {
    let tolerance = Tolerance {
        mm: number(&golden.file["tol"], "mm"),
        unit: number(&golden.file["tol"], "unit"),
    };
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let [main, branch, angle, offset] = ["R", "r", "beta", "delta"].map(|name| number(input, name));
        let pair = match PipePair::new(main, branch, angle, offset) {
            Ok(pair) => pair,
            Err(error) => {
                is(case, &error, &case["err"]);
                continue;
            }
        };
        assert!(case["err"].is_null(), "{} was wanted: {case}", case["err"]);
        meeting(case, &pair, &tolerance);
        let theta = number(input, "theta");
        let sheet = if number(input, "sheet") > 0.0 {
            Sheet::Plus
        } else {
            Sheet::Minus
        };
        let stopped = match pair.at_theta(theta, sheet) {
            Ok(point) => {
                near_all(case, "pS", point.branch.as_slice(), &out["pS"], tolerance.mm);
                near_all(case, "pM", point.main.as_slice(), &out["pM"], tolerance.mm);
                match point.frame() {
                    Ok(frame) => {
                        groove(case, &pair, &point, &frame, &tolerance);
                        match pair.theta_derivative(theta, sheet) {
                            Ok(slope) => {
                                near_all(case, "dp", slope.as_slice(), &out["dp"], tolerance.mm);
                                None
                            }
                            Err(error) => Some((error, "dp")),
                        }
                    }
                    Err(error) => Some((error, "t")),
                }
            }
            Err(error) => Some((error, "pS")),
        };
        if let Some((error, first_missing)) = stopped {
            is(case, &error, &out["err_at"]);
            assert!(out[first_missing].is_null(), "{error} at {first_missing}: {case}");
        } else {
            assert!(out["err_at"].is_null(), "{} was wanted: {case}", out["err_at"]);
        }
    }
}

/// Asserts that `error` is of the class `wanted`.
fn is(case: &Value, error: &SaddleError, wanted: &Value) {
    let class = wanted.as_str().unwrap_or_else(|| panic!("{error}: {case}"));
    assert!(error.to_string().starts_with(class), "{error}: {case}");
}

fn meeting(case: &Value, pair: &PipePair, tolerance: &Tolerance) {
    let kind = match pair.meeting() {
        Intersection::None => "none",
        Intersection::Full => "full",
        Intersection::Tangent => "tangent",
        Intersection::Partial => "partial",
    };
    assert_eq!(case["out"]["kind"], kind, "case {}", case["id"]);
    let wanted = case["out"]["thetas"].as_array().expect("thetas");
    let intervals = pair.intervals();
    assert_eq!(intervals.len(), wanted.len(), "case {}: thetas", case["id"]);
    for (seen, wanted) in intervals.iter().zip(wanted) {
        near_all(case, "thetas", seen, wanted, tolerance.unit);
    }
}

fn groove(case: &Value, pair: &PipePair, point: &SeamPoint, frame: &SeamFrame, tolerance: &Tolerance) {
    let out = &case["out"];
    for (what, seen) in [
        ("NA", point.branch_normal),
        ("NB", point.main_normal),
        ("t", frame.tangent),
        ("lA", frame.branch_wall),
        ("lB", frame.main_wall),
        ("axis", frame.torch),
    ] {
        near_all(case, what, seen.as_slice(), &out[what], tolerance.unit);
    }
    near(case, "psi", frame.groove, number(out, "psi"), tolerance.unit);
    near(
        case,
        "alpha",
        frame.work_angle(),
        number(out, "alpha"),
        tolerance.unit,
    );
    // The machine is given on the plus sheet only.
    if !out["rho"].is_null() {
        let at = pair.machine_coordinates(point, &frame.torch);
        for (what, seen, tolerance) in [
            ("rho", at.radial, tolerance.mm),
            ("z", at.axial, tolerance.mm),
            ("elev", at.elevation, tolerance.unit),
            ("eps", at.out_of_plane, tolerance.unit),
        ] {
            near(case, what, seen, number(out, what), tolerance);
        }
    }
}
