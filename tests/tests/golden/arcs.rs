//! Arcs through three points, stepping, arcs with the tool along the tangent (mathematics 1.4, 1.5, 4.2).

use super::file::{Golden, near, near_all, number, numbers, vector};
use nalgebra::Vector3;
use serde_json::Value;
use shared::geometry::{Arc, Turn};
use shared::trajectory::MatchedTurn;

/// Checks the file `arc3`.
pub fn arc3(golden: &Golden) {
    let relative = number(&golden.file["tol"], "rel_R");
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let [a, b, c] = ["A", "B", "C"].map(|name| vector(&input[name]));
        let arc = match Arc::through(a, b, c) {
            Ok(arc) => arc,
            Err(error) => {
                let wanted = case["err"].as_str().unwrap_or_else(|| panic!("{error}: {case}"));
                assert!(error.to_string().starts_with(wanted), "{error}: {case}");
                continue;
            }
        };
        assert!(case["err"].is_null(), "{} was wanted: {case}", case["err"]);
        let mm = relative * number(out, "R");
        near(case, "R", arc.radius(), number(out, "R"), mm);
        near_all(case, "O", arc.centre().as_slice(), &out["O"], mm);
        near_all(case, "n", arc.axis().as_slice(), &out["n"], relative);
        near(case, "phiB", arc.angle_of(&b), number(out, "phiB"), relative);
        near(case, "phiC", arc.angle_of(&c), number(out, "phiC"), relative);
        near(case, "sweep", arc.sweep(), number(out, "phiC"), relative);
        near_all(case, "end", arc.end().as_slice(), &out["end"], mm);
        let step = number(input, "ds");
        let exact: Vec<_> = arc.equal_steps(step).expect("a step").collect();
        let tangent: Vec<_> = arc.tangent_walk(step).expect("a step").collect();
        for (name, points) in [("exact", exact), ("tangent", tangent)] {
            assert_eq!(
                out[format!("n_{name}")],
                points.len(),
                "case {}: {name}",
                case["id"]
            );
            for (place, i) in [("1", 1), ("mid", points.len() / 2)] {
                let wanted = &out[format!("{name}_{place}")];
                near_all(case, name, points[i].as_slice(), wanted, mm);
            }
            assert!((points[points.len() - 1] - c).norm() <= mm, "case {}", case["id"]);
        }
    }
}

/// A point of the XY plane.
fn flat(value: &Value) -> Vector3<f64> {
    let xy = numbers(value);
    Vector3::new(xy[0], xy[1], 0.0)
}

/// Checks the file `fsw_arc`.
pub fn fsw_arc(golden: &Golden) {
    let tolerance = golden.tolerance;
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let [p0, p1, c] = ["p0", "p1", "c"].map(|name| flat(&input[name]));
        let turn = if input["ccw"] == true {
            Turn::CounterClockwise
        } else {
            Turn::Clockwise
        };
        let arc = Arc::about_centre(p0, p1, c, Vector3::z(), turn).expect("an arc");
        let matched = MatchedTurn::build(&arc, number(input, "v"), number(input, "a")).expect("limits");
        let path = matched.path();
        for (what, seen) in [
            ("sweep", arc.signed_sweep(&Vector3::z())),
            ("ta", path.ramp()),
            ("tc", path.cruise()),
            ("vp", path.peak()),
            ("s_a", matched.ramp_length()),
            ("phi_a", matched.ramp_angle()),
            ("c_acc", matched.acceleration()),
            ("c_vel", matched.velocity()),
            ("c_move", matched.sweep()),
            ("heading0", arc.heading(0.0).expect("a plane arc")),
        ] {
            near(case, what, seen, number(out, what), tolerance);
        }
        near(case, "R", arc.radius(), number(input, "R"), tolerance);
        for (i, t) in numbers(&input["t"]).into_iter().enumerate() {
            let s = path.at(t).s;
            near(case, "s", s, numbers(&out["s"])[i], tolerance);
            let wanted = numbers(&out["C"])[i];
            let heading = arc.heading(s).expect("a plane arc");
            near(case, "C", heading, wanted, tolerance);
            near(
                case,
                "matched C",
                number(out, "heading0") + matched.at(t),
                wanted,
                tolerance,
            );
        }
    }
}
