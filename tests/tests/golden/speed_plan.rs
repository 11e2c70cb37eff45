//! Speed on curves, process window, acceleration passes (mathematics 3.3, 3.4).

use super::file::{Golden, near, near_all, number, numbers};
use parts::window::{CurveLimits, ProcessWindow};
use serde_json::Value;

/// Asserts that these are all the fields there are.
fn only(case: &Value, names: &[&str]) {
    let out = case["out"].as_object().expect("out");
    assert!(
        out.keys().all(|name| names.contains(&name.as_str())),
        "case {}: a field of {out:?} is not checked",
        case["id"]
    );
}

/// Checks the file `speed_plan`.
pub fn speed_plan(golden: &Golden) {
    let tolerance = golden.tolerance;
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        match case["op"].as_str() {
            Some("limit") => {
                only(case, &["v"]);
                let limits = CurveLimits {
                    velocity: number(input, "vmax"),
                    period: number(input, "T"),
                    chord_error: number(input, "chord"),
                    normal_acceleration: number(input, "an"),
                    normal_jerk: number(input, "jn"),
                };
                let radius = input["rho"].as_f64().unwrap_or(f64::INFINITY);
                let v = limits.speed(radius).expect("speed");
                near(case, "v", v, number(out, "v"), tolerance);
            }
            Some("window") => {
                only(case, &["v", "const", "n_below"]);
                let window = ProcessWindow {
                    low: number(input, "vlo"),
                    high: number(input, "vhi"),
                };
                let mut v = numbers(&input["v"]);
                let plan = window.apply(&mut v).expect("window");
                near_all(case, "v", &v, &out["v"], tolerance);
                near(case, "const", plan.constant, number(out, "const"), tolerance);
                near(case, "n_below", plan.n_below as f64, number(out, "n_below"), 0.0);
            }
            Some("passes") => {
                only(case, &["v"]);
                let mut v = numbers(&input["v"]);
                let [at, v0, v1] = ["at", "v0", "v1"].map(|name| number(input, name));
                limit_acceleration(&numbers(&input["s"]), &mut v, at, [v0, v1]);
                near_all(case, "v", &v, &out["v"], tolerance);
            }
            other => panic!("case {}: operation {other:?}", case["id"]),
        }
    }
}

/// Lowers `speeds` \[mm/s\] at the path lengths `s` \[mm\] until none needs more than `acceleration` \[mm/s²\]
/// from its neighbours, with these speeds or less at both ends: v² changes by at most 2aΔs.
fn limit_acceleration(s: &[f64], speeds: &mut [f64], acceleration: f64, [start, end]: [f64; 2]) {
    let last = speeds.len() - 1;
    speeds[0] = speeds[0].min(start);
    speeds[last] = speeds[last].min(end);
    let reachable = |from: f64, way: f64| (from * from + 2.0 * acceleration * way).sqrt();
    for i in 1..=last {
        speeds[i] = speeds[i].min(reachable(speeds[i - 1], s[i] - s[i - 1]));
    }
    for i in (1..=last).rev() {
        speeds[i - 1] = speeds[i - 1].min(reachable(speeds[i], s[i] - s[i - 1]));
    }
}
