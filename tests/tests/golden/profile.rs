//! The smoothed trapezoid of speed (mathematics 0.4.2).

use super::file::{Golden, near, number, numbers};
use super::trapezoid::{SmoothedTrapezoid, Trapezoid};

/// Checks the file `profile`.
pub fn profile(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let trapezoid = Trapezoid::build(number(input, "Lp"), number(input, "v"), number(input, "a"));
        near(
            case,
            "t_total",
            trapezoid.duration(),
            number(out, "t_total"),
            golden.tolerance,
        );
        let window = input["M"].as_u64().expect("M") as usize;
        let smoothed = SmoothedTrapezoid::build(trapezoid, number(input, "T"), window);
        assert_eq!(out["n"], smoothed.samples(), "case {}", case["id"]);
        for (k, s) in numbers(&out["idx"]).into_iter().zip(numbers(&out["s"])) {
            near(case, "s", smoothed.sample(k as usize), s, golden.tolerance);
        }
    }
}
