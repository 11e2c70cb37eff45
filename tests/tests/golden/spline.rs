//! Natural cubic splines (mathematics 0.4.1).

use super::file::{Golden, near_all, numbers};
use curves::NaturalSpline;

/// Checks the file `spline`.
pub fn spline(golden: &Golden) {
    for case in &golden.cases {
        let (x, y) = (numbers(&case["in"]["x"]), numbers(&case["in"]["y"]));
        let (mut second, mut scratch) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        match NaturalSpline::solve(&x, &y, &mut second, &mut scratch) {
            Ok(spline) => {
                assert!(
                    case["err"].is_null(),
                    "case {}: {} was wanted",
                    case["id"],
                    case["err"]
                );
                near_all(case, "M", spline.second(), &case["out"]["M"], golden.tolerance);
                for (i, t) in numbers(&case["in"]["t"]).into_iter().enumerate() {
                    near_all(
                        case,
                        "eval",
                        &spline.at(t),
                        &case["out"]["eval"][i],
                        golden.tolerance,
                    );
                }
            }
            Err(error) => assert_eq!(case["err"], error.to_string(), "case {}", case["id"]),
        }
    }
}
