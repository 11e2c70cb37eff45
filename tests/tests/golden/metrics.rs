//! Errors of runs (mathematics 4.4).

use super::file::{Golden, near, number, numbers, vector};
use cam::metrics::{compare, distance_to_polyline};
use serde_json::Value;

/// Checks a number that may be absent.
fn near_if_any(case: &Value, what: &str, seen: Option<f64>, tolerance: f64) {
    let wanted = case["out"][what].as_f64();
    assert_eq!(seen.is_some(), wanted.is_some(), "case {}: {what}", case["id"]);
    if let (Some(seen), Some(wanted)) = (seen, wanted) {
        near(case, what, seen, wanted, tolerance);
    }
}

/// Checks the file `metrics`.
pub fn metrics(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        if let Some(polyline) = input["poly"].as_array() {
            let polyline: Vec<_> = polyline.iter().map(vector).collect();
            let distance = distance_to_polyline(&polyline, &vector(&input["p"])).expect("a polyline");
            near(case, "dist", distance, number(out, "dist"), golden.tolerance);
            continue;
        }
        match compare(&numbers(&input["measured"]), &numbers(&input["ref"])) {
            Ok(seen) => {
                near(case, "mae", seen.mae, number(out, "mae"), golden.tolerance);
                near(case, "rmse", seen.rmse, number(out, "rmse"), golden.tolerance);
                near(case, "maxabs", seen.max, number(out, "maxabs"), golden.tolerance);
                near_if_any(case, "mape", seen.mape_percent, golden.tolerance);
                assert_eq!(out["mape_n"], seen.mape_count, "case {}: mape_n", case["id"]);
                near_if_any(case, "nmae", seen.nmae_percent, golden.tolerance);
            }
            Err(error) => {
                let class = case["err"]
                    .as_str()
                    .unwrap_or_else(|| panic!("case {}: {error}", case["id"]));
                assert!(
                    error.to_string().starts_with(class),
                    "case {}: {error}",
                    case["id"]
                );
            }
        }
    }
}
