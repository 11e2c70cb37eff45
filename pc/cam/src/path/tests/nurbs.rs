//! NURBS are followed exactly, at their feed, and what is no way for a tool is refused.

use super::control::tips;
use super::*;
use curves::nurbs::{Curve, Nurbs, length};

/// A quarter of a circle of 100 mm as an exact rational curve, and the same as an arc.
#[test]
fn a_rational_quarter_is_the_arc() {
    let curve = "G6.2 P3 K0\nK0 X1100 Y1000 R0.7071067811865476\nK0 X1100 Y1100\nK1\nK1\nK1";
    let uniform = "G5.2 P1\nX1100 Y1000 P0.7071067811865476\nX1100 Y1100 P1\nG5.3";
    let arc = &plan("F3000\nG3 X1100 Y1100 J100").unwrap()[1];
    for curve in [curve, uniform] {
        let paths = plan(&format!("F3000\n{curve}")).unwrap();
        let path = &paths[1];
        assert!((path.length_mm() - 50.0 * std::f64::consts::PI).abs() < 1e-6);
        assert_eq!(path.limits.velocity, 50.0);
        assert!(path.speed_error < 1e-9, "{}", path.speed_error);
        for (seen, wanted) in tips(path).iter().zip(tips(arc)) {
            assert!((seen - wanted).norm() < 2e-4, "{seen} {wanted}");
        }
    }
}

const POINTS: [[f64; 3]; 7] = [
    [1000.0, 1000.0, 100.0],
    [1020.0, 1000.0, 100.0],
    [1050.0, 1040.0, 110.0],
    [1080.0, 960.0, 130.0],
    [1120.0, 1010.0, 130.0],
    [1150.0, 1040.0, 120.0],
    [1160.0, 1040.0, 120.0],
];
const KNOTS: [f64; 11] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.5, 4.0, 5.0, 5.0, 5.0, 5.0];
const WEIGHTS: [f64; 7] = [1.0, 2.0, 1.0, 0.5, 1.0, 3.0, 1.0];

fn in_space(end: &str) -> String {
    let mut body = "G6.2 P4 ".to_owned();
    for (i, [x, y, z]) in POINTS.into_iter().enumerate() {
        let end = if i == 6 { end } else { "" };
        writeln!(body, "K{} X{x} Y{y} Z{z} R{} {end}", KNOTS[i], WEIGHTS[i]).unwrap();
    }
    for knot in &KNOTS[7..] {
        writeln!(body, "K{knot}").unwrap();
    }
    body
}

/// In space, knots uneven, rotary axes evenly over the length, lines before and after it.
#[test]
fn a_curve_in_space_is_followed_within_a_tenth_of_a_micrometre() {
    let body = format!(
        "F1200\nM62 P0\nG1 X990\nG1 X1000\n{}\nM63 P0\nG1 X1200",
        in_space("C20")
    );
    let text = format!("G43.4\nG0 X980 Y1000 Z100 A0 B0 C0\n{body}\nM2\n");
    let paths = plan_on("dual-beam-gantry", &text).unwrap();
    let [_, path] = &paths[..] else {
        panic!("smooth joins: {} paths", paths.len())
    };
    let points = POINTS.map(Vector3::from);
    let nurbs = Nurbs::new(3, &points, &WEIGHTS, &KNOTS).unwrap();
    let long = length(&nurbs);
    assert!((path.length_mm() - 20.0 - 40.0 - long).abs() < 1e-6);
    // Every point of the path that is on the curve is nearly one of it.
    let exact: Vec<_> = (0..=400_000)
        .map(|i| nurbs.point(5.0 * f64::from(i) / 4e5))
        .collect();
    let (mut next, mut worst) = (0, 0.0_f64);
    let followed = path.path();
    for i in 0..=2000 {
        let s = 20.0 + long * f64::from(i) / 2000.0;
        let tip = followed.at(s).unwrap().pose().unwrap().position;
        while next + 1 < exact.len() && (exact[next + 1] - tip).norm() <= (exact[next] - tip).norm() {
            next += 1;
        }
        let chord = exact[(next + 1).min(400_000)] - exact[next.max(1) - 1];
        let off = tip - exact[next];
        worst = worst.max((off - chord * (off.dot(&chord) / chord.norm_squared())).norm());
    }
    assert!(worst < 2e-4, "{worst} mm off");
    assert!(path.speed_error < 1e-6, "{}", path.speed_error);
    // Half of the turn in the middle, all of it at the end, and the beam goes off there.
    let seen = followed_axes(&paths);
    let c_at = |s: f64| {
        seen.iter()
            .min_by(|a, b| (a.0 - s).abs().total_cmp(&(b.0 - s).abs()))
            .unwrap()
            .1
    };
    assert!((c_at(20.0 + long / 2.0) - 10.0).abs() < 0.05);
    assert!((c_at(20.0 + long + 5.0) - 20.0).abs() < 1e-6);
    let (on, off) = path.weld().unwrap();
    assert!(on == 0.0 && (off - 20.0 - long).abs() < 1e-6);
}

/// s and C of the second path.
fn followed_axes(paths: &[PlannedPath]) -> Vec<(f64, f64)> {
    let steps = followed("dual-beam-gantry", paths, 0.1).into_iter();
    steps
        .filter(|at| at.0 == 1)
        .map(|(_, s, axes)| (s, axes[5]))
        .collect()
}

#[test]
fn a_curve_has_its_time_with_g93_and_its_limit_by_its_bends() {
    let body = in_space("");
    let paths = plan(&format!("G93\n{}", body.replacen("K0", "F6 K0", 1))).unwrap();
    assert!((paths[1].limits.velocity - paths[1].length_mm() / 10.0).abs() < 1e-9);
    let found = too_fast(plan(&format!("F19000\n{body}")));
    assert_eq!(found.place, SourcePosition { line: 4, column: 1 }, "{found}");
}

#[test]
fn what_is_no_way_for_a_tool_is_refused() {
    let message = |body: &str| plan(&format!("F600\n{body}")).unwrap_err().to_string();
    assert_eq!(
        message("G6.2 P3 K0 X1001\nK0 X1100 Y1000\nK0 X1100 Y1100\nK1\nK1\nK1"),
        "line 4, column 1: the first control point is 1.0000 mm from where the tip is; move there first, or leave \
         its X Y Z out"
    );
    // Order 2 is a polygon.
    assert_eq!(
        message("G5.2 L2\nX1100 Y1000\nX1100 Y1100\nG5.3"),
        "line 4, column 1: the NURBS has a corner of 90.0° after 100.000 mm; end it there and write the rest as \
         another one"
    );
    assert_eq!(
        message("G5.2 P1\nX1000 Y1000\nX1100 Y1100\nG5.3"),
        "line 4, column 1: the NURBS has no direction after 0.000 mm: move control points that coincide apart"
    );
    // It begins where the line before ends, at a corner.
    let paths = plan("F600\nG1 X1100\nG5.2 P1\nX1100 Y1050\nX1150 Y1050\nG5.3").unwrap();
    assert!((paths[2].corner_deg.unwrap() - 90.0).abs() < 1e-6);
}
