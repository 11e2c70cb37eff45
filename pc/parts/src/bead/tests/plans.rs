//! What is planned, against the curve it is planned from.

use super::*;
use crate::bead::curve_file::CurveFile;
use curves::nurbs::Curve;
use nalgebra::Vector3;
use shared::io::AXES;

/// A place of a path: s, tip, direction of travel, and T.
type At = (f64, Vector3<f64>, Vector3<f64>, Vector3<f64>);

/// A path every `step` mm.
fn along(path: &PlannedPath, step: f64) -> Vec<At> {
    let curve = path.path();
    let count = (path.length_mm() / step).ceil() as usize;
    let at = |i: usize| {
        let s = path.length_mm() * i as f64 / count as f64;
        let point = curve.at(s).unwrap();
        let vector = |c: &[f64], k: usize| Vector3::new(c[k], c[k + 1], c[k + 2]);
        let [tip, t] = [0, 3].map(|k| vector(&point.value, k));
        (s, tip, vector(&point.first, 0), t)
    };
    (0..=count).map(at).collect()
}

/// Distance of `p` from a polyline.
fn distance(polyline: &[Vector3<f64>], p: &Vector3<f64>) -> f64 {
    let to_chord = |pair: &[Vector3<f64>]| {
        let chord = pair[1] - pair[0];
        let part = ((p - pair[0]).dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
        (pair[0] + chord * part - p).norm()
    };
    polyline.windows(2).map(to_chord).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_shipped_program_is_the_plan_of_the_shipped_part() {
    let plan = plan(&leaf(), &machine()).unwrap();
    let program = std::fs::read_to_string(shipped("programs/leaf.ngc")).unwrap();
    assert!(
        plan.program == program,
        "plan programs/leaf.toml again and ship what comes of it"
    );
}

/// Searched for without any help of the planner: the distance of every point of the path from a fine polyline on
/// the NURBS.
#[test]
fn both_layers_of_the_leaf_follow_the_nurbs() {
    let plan = plan(&leaf(), &machine()).unwrap();
    let paths = feed_paths(&plan.program, &machine());
    assert_eq!(paths.len(), 2);
    let file = CurveFile::read(&shipped("programs/leaf.json")).unwrap();
    let nurbs = file.nurbs("leaf.json").unwrap();
    let [from, to] = nurbs.domain();
    let count = 14_000;
    let outline: Vec<_> = (0..=count)
        .map(|i| nurbs.point(from + (to - from) * f64::from(i) / f64::from(count)))
        .collect();
    for (layer, path) in paths.iter().enumerate() {
        let lift = Vector3::z() * 2.0 * layer as f64;
        let off = along(path, 0.1)
            .iter()
            .map(|(_, tip, ..)| distance(&outline, &(tip - lift)))
            .fold(0.0, f64::max);
        assert!((1e-5..2e-3).contains(&off), "layer {layer}: {off} mm");
        assert!(path.knots.len() < 400, "{}", path.knots.len());
        assert!(path.speed_error < 2e-3, "{}", path.speed_error);
    }
}

/// The arc begins to burn at the beginning of the curve after the lead-in, and burns for once around and the
/// overlap; all of that on the curve.
#[test]
fn a_closed_bead_begins_and_ends_on_its_own_curve() {
    let plan = plan(&leaf(), &machine()).unwrap();
    let path = &feed_paths(&plan.program, &machine())[0];
    let (start, end) = path.weld().unwrap();
    let length = 351.95;
    assert!(
        (start - 3.0).abs() < 1e-3 && (end - start - length - 2.0).abs() < 0.02,
        "{start} {end}"
    );
    assert!((path.length_mm() - end - 3.0).abs() < 1e-3);
    let tips = along(path, 0.05);
    let at = |s: f64| {
        tips.iter()
            .min_by(|a, b| (a.0 - s).abs().total_cmp(&(b.0 - s).abs()))
            .unwrap()
    };
    // Once around is back where the arc began, in the same direction.
    let (from, to) = (at(start), at(start + path.length_mm() - 8.0));
    assert!((from.1 - to.1).norm() < 0.06, "{:?} {:?}", from.1, to.1);
    assert!((from.2 - to.2).norm() < 0.01);
    assert!(
        plan.notes[0].contains("closed bead of 351.95 mm"),
        "{}",
        plan.notes[0]
    );
}

#[test]
fn an_open_bead_is_led_into_and_out_of_on_its_tangents() {
    let plan = plan(QUARTER, &machine()).unwrap();
    let path = &feed_paths(&plan.program, &machine())[0];
    let (start, end) = path.weld().unwrap();
    let quarter = 15.0 * std::f64::consts::PI;
    assert!(
        (start - 5.0).abs() < 1e-4 && (end - start - quarter).abs() < 1e-3,
        "{start} {end}"
    );
    for (s, tip, ..) in along(path, 0.25) {
        let off = if s < start {
            (tip - Vector3::new(30.0, s - start, 0.0)).norm()
        } else if s > end {
            (tip - Vector3::new(end - s, 30.0, 0.0)).norm()
        } else {
            (tip.norm() - 30.0).abs()
        };
        assert!(off < 2e-3, "{off} at {s}");
    }
}

#[test]
fn the_turntable_stands_still_or_turns_travel_into_x() {
    let machine = machine();
    let follow = QUARTER.replace("lead_mm", "attitude = \"tangent\"\nlead_mm");
    for (part, turns) in [(QUARTER, false), (&follow, true)] {
        let plan = plan(part, &machine).unwrap();
        for (s, _, travel, t) in along(&feed_paths(&plan.program, &machine)[0], 0.5) {
            let wanted = if turns { travel.normalize() } else { Vector3::x() };
            assert!((t - wanted).norm() < 0.011, "at {s}: {t:?}, not {wanted:?}");
        }
    }
}

/// A leaf around which C follows the tangent turns once and a little more: found within ±360°, wherever it starts.
#[test]
fn the_turntable_is_turned_into_its_travel() {
    let circle = "\
[bead]
lead_mm = 8.0
overlap_mm = 5.0
power_w = 1500.0
attitude = \"tangent\"
[bead.nurbs]
degree = 2
control_points_mm = [[40.0, 0.0, 0.0], [40.0, 40.0, 0.0], [0.0, 40.0, 0.0], [-40.0, 40.0, 0.0], [-40.0, 0.0, 0.0],
    [-40.0, -40.0, 0.0], [0.0, -40.0, 0.0], [40.0, -40.0, 0.0], [40.0, 0.0, 0.0]]
weights = [1, 0.7071067811865476, 1, 0.7071067811865476, 1, 0.7071067811865476, 1, 0.7071067811865476, 1]
knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
";
    let machine = machine();
    let plan = plan(circle, &machine).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let path = &feed_paths(&plan.program, &machine)[0];
    let mut near = [0.0; AXES];
    let first = plan.program.lines().find(|line| line.contains("G53 G0")).unwrap();
    let word = first.split(' ').find_map(|word| word.strip_prefix('C')).unwrap();
    near[5] = word.parse::<f64>().unwrap().to_radians();
    let start = near[5];
    for (_, tip, _, t) in along(path, 0.5) {
        let pose = shared::geometry::Pose::new(tip, t, Vector3::z()).unwrap();
        near = planner.kinematics().inverse(&pose, &near).unwrap();
        assert!(near[5].to_degrees().abs() <= 360.0, "{}", near[5].to_degrees());
    }
    let turned = (near[5] - start).to_degrees();
    assert!(
        (turned + 360.0 + (21.0 / 40.0_f64).to_degrees()).abs() < 0.1,
        "{turned}"
    );
    let narrow = std::fs::read_to_string(shipped("machines/wire-arc.toml"))
        .unwrap()
        .replace("travel_min = -360.0", "travel_min = -170.0")
        .replace("travel_max = 360.0", "travel_max = 200.0");
    let narrow = MachineFile::parse("m.toml", &narrow).unwrap();
    let error = crate::bead::tests::plan(circle, &narrow)
        .expect_err("370° at most")
        .to_string();
    assert!(error.contains("turntable would have to turn"), "{error}");
}
