//! Arcs through three points, stepping, arcs with the tool along the tangent (mathematics 1.4, 1.5, 4.2).

use super::file::{Golden, near, near_all, number, numbers, vector};
use super::trapezoid::Trapezoid;
use nalgebra::Vector3;
use serde_json::Value;
use shared::geometry::{Arc, Turn};

/// Checks the file `arc3`.
pub fn arc3(golden: &Golden) {
    let relative = number(&golden.file["tol"], "rel_R");
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let [a, b, c] = ["A", "B", "C"].map(|name| vector(&input[name]));
        let arc = match through(a, b, c) {
            Ok(arc) => arc,
            Err(error) => {
                let wanted = case["err"].as_str().unwrap_or_else(|| panic!("{error}: {case}"));
                assert_eq!(error, wanted, "{case}");
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
        let exact = equal_steps(&arc, step);
        let tangent = tangent_walk(&arc, step);
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

/// The arc from `a` through `b` to `c` (mathematics 1.4), right-handed about (b−a)×(c−a); or why there is none.
fn through(a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>) -> Result<Arc, &'static str> {
    let (to_b, to_c) = (b - a, c - a);
    let sides = [to_b.norm(), to_c.norm(), (c - b).norm()];
    let longest = sides.into_iter().fold(0.0, f64::max);
    let shortest = sides.into_iter().fold(longest, f64::min);
    if shortest <= 1e-9 * longest {
        return Err("coincident");
    }
    let normal = to_b.cross(&to_c);
    let area = normal.norm();
    if area < 1e-9 * longest * longest {
        return Err("collinear");
    }
    let to_centre = (normal.cross(&to_b) * to_c.norm_squared() + to_c.cross(&normal) * to_b.norm_squared())
        / (2.0 * area * area);
    let arc = Arc::about_centre(a, c, a + to_centre, normal, Turn::CounterClockwise);
    Ok(arc.expect("points as far from the centre as each other"))
}

/// Points from start to end, both included, at equal angles and at most `step` \[mm\] apart along the arc.
fn equal_steps(arc: &Arc, step: f64) -> Vec<Vector3<f64>> {
    let steps = (arc.radius() * arc.sweep() / step - 1e-9).ceil().max(1.0) as usize;
    let angle = |i| arc.sweep() * i as f64 / steps as f64;
    (0..=steps).map(|i| arc.at_angle(angle(i))).collect()
}

/// The published walk (mathematics 1.5): a `step` \[mm\] along the tangent, then back onto the circle, until the end is
/// nearer than a step, then the end.
///
/// It keeps the radius, but turns by atan(step/R) where step/R was meant: the feed is low by (step/R)²/3, and the last
/// step is a rest of any size.
fn tangent_walk(arc: &Arc, step: f64) -> Vec<Vector3<f64>> {
    let per_step = (step / arc.radius()).atan();
    let mut points = vec![arc.start()];
    let mut point = arc.start();
    while points.len() as f64 * per_step < arc.sweep() - 1e-12 {
        let tangent = arc.axis().cross(&(point - arc.centre()));
        let ahead = point + tangent * (step / tangent.norm()) - arc.centre();
        point = arc.centre() + ahead * (arc.radius() / ahead.norm());
        points.push(point);
    }
    points.push(arc.end());
    points
}

/// Direction of travel along an arc of the XY plane, from X about +Z, after the length `s` \[rad\].
fn heading(arc: &Arc, s: f64) -> f64 {
    let first = arc.at(0.0).first;
    first.y.atan2(first.x) + arc.signed_sweep(&Vector3::z()) * s / arc.length()
}

/// The published rule for a tool that turns with an arc (mathematics 4.2): a trapezoid of the C axis that matches the
/// trapezoid of the path, with equal times and C = C₀ ± s/R.
///
/// It is exact only while the path really runs this very trapezoid: with the override at 50 % from the middle
/// of a quarter arc on, C is 22.5° off. What the machines do follows from the tangent of the arc at any speed.
struct MatchedTurn {
    path: Trapezoid,
    radius: f64,
    /// Positive about +Z \[rad\].
    sweep: f64,
}

impl MatchedTurn {
    fn build(arc: &Arc, velocity: f64, acceleration: f64) -> Self {
        Self {
            path: Trapezoid::build(arc.radius() * arc.sweep(), velocity, acceleration),
            radius: arc.radius(),
            sweep: arc.signed_sweep(&Vector3::z()),
        }
    }

    /// Path length of the acceleration \[mm\].
    fn ramp_length(&self) -> f64 {
        self.path.peak() * self.path.ramp() / 2.0
    }

    /// Angle of the acceleration φₐ \[rad\].
    fn ramp_angle(&self) -> f64 {
        self.ramp_length() / self.radius
    }

    /// Angular acceleration of C, 2φₐ/tₐ² \[rad/s²\].
    fn acceleration(&self) -> f64 {
        2.0 * self.ramp_angle() / (self.path.ramp() * self.path.ramp())
    }

    /// Highest angular speed of C \[rad/s\].
    fn velocity(&self) -> f64 {
        self.path.peak() / self.radius
    }

    /// Angle C has turned by after the time `t` \[s\], positive about +Z \[rad\].
    fn at(&self, t: f64) -> f64 {
        (self.path.at(t).s / self.radius).copysign(self.sweep)
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
        let matched = MatchedTurn::build(&arc, number(input, "v"), number(input, "a"));
        let path = &matched.path;
        for (what, seen) in [
            ("sweep", arc.signed_sweep(&Vector3::z())),
            ("ta", path.ramp()),
            ("tc", path.cruise()),
            ("vp", path.peak()),
            ("s_a", matched.ramp_length()),
            ("phi_a", matched.ramp_angle()),
            ("c_acc", matched.acceleration()),
            ("c_vel", matched.velocity()),
            ("c_move", matched.sweep),
            ("heading0", heading(&arc, 0.0)),
        ] {
            near(case, what, seen, number(out, what), tolerance);
        }
        near(case, "R", arc.radius(), number(input, "R"), tolerance);
        for (i, t) in numbers(&input["t"]).into_iter().enumerate() {
            let s = path.at(t).s;
            near(case, "s", s, numbers(&out["s"])[i], tolerance);
            let wanted = numbers(&out["C"])[i];
            let heading = heading(&arc, s);
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
