//! Paths with arcs: how exact they are, where they stop, and which arcs there are not.

use super::*;
use nc::Motion;
use shared::protocol::PathAction;
use shared::trajectory::Join;

const STIR: &str = "G43.4\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\nF120\n";

fn stir(body: &str) -> Result<Vec<PlannedPath>, PathError> {
    plan_on("stir-gantry", &format!("{STIR}{body}\nM2"))
}

/// Largest value of `error` along a path, in steps of 0.05 mm; its arguments are s, position and T.
fn largest(planned: &PlannedPath, error: impl Fn(f64, Vector3<f64>, Vector3<f64>) -> f64) -> f64 {
    let path = planned.path();
    let count = (planned.length_mm() / 0.05) as usize;
    (0..=count)
        .map(|i| planned.length_mm() * i as f64 / count as f64)
        .map(|s| {
            let pose = path.at(s).unwrap().pose().unwrap();
            error(s, pose.position, pose.tangent)
        })
        .fold(0.0, f64::max)
}

/// A line, a quarter of a circle and a line again, tool turning with the arc: one path, on the contour, heading along
/// it but for the lengths in which C starts and stops turning.
#[test]
fn line_arc_line_is_followed_exactly_with_the_tool_along_it() {
    let paths = stir("G1 X650\nG3 X700 Y550 J50 C90\nG1 Y600").unwrap();
    let [_, _, weld] = &paths[..] else {
        panic!("one feed path")
    };
    let quarter = 25.0 * std::f64::consts::PI;
    assert!((weld.length_mm() - 100.0 - quarter).abs() < 1e-9);
    let ideal = |s: f64| {
        let arc = (s - 50.0).clamp(0.0, quarter);
        let (sin, cos) = (arc / 50.0).sin_cos();
        let along = Vector3::new(cos, sin, 0.0);
        let begin = Vector3::new(600.0 + s.min(50.0), 500.0, 50.0);
        let off = Vector3::new(50.0 * sin, 50.0 * (1.0 - cos), 0.0);
        (begin + off + along * (s - 50.0 - quarter).max(0.0), along)
    };
    let off = largest(weld, |s, position, _| (position - ideal(s).0).norm());
    assert!(off < 1e-5, "{off} mm off");
    let heading = |tangent: Vector3<f64>| tangent.y.atan2(tangent.x);
    let wrong = |s: f64, tangent: Vector3<f64>| {
        angle(
            &ideal(s).1,
            &Vector3::new(heading(tangent).cos(), heading(tangent).sin(), 0.0),
        )
    };
    let within = largest(weld, |s, _, tangent| {
        let near_join = [50.0, 50.0 + quarter].iter().any(|join| (s - join).abs() < 0.1);
        if near_join { 0.0 } else { wrong(s, tangent) }
    });
    assert!(within < 1e-6, "{within} rad");
    let at_joins = largest(weld, |s, _, tangent| wrong(s, tangent)).to_degrees();
    assert!(at_joins < 0.02, "{at_joins}°");
    assert!(weld.speed_error < 1e-7, "{}", weld.speed_error);
    assert!(weld.corner_deg.is_none());
}

/// A full circle with C turning by 360°, and a helix of most of a turn: the rotary axes turn evenly.
#[test]
fn more_than_half_a_turn_in_an_arc_turns_evenly() {
    let program = "G43.4\nG0 X100 Y0 Z240 B0 C0\nG0 X40 Y0 Z100 B60 C0\nF600\nG3 I-40 Z110 C360\nM2";
    let paths = plan_on("pipe-welder", program).unwrap();
    let turn = paths.last().unwrap();
    assert!((turn.length_mm() - libm::hypot(80.0 * std::f64::consts::PI, 10.0)).abs() < 1e-9);
    let seen = followed("pipe-welder", &paths, 0.1);
    for (_, s, axes) in seen.iter().filter(|at| at.0 == 2) {
        let part = s / turn.length_mm();
        assert!((axes[5] - 360.0 * part).abs() < 1e-4, "C{} at {s}", axes[5]);
        assert!((axes[0] - 70.0).abs() < 1e-4 && (axes[4] - 60.0).abs() < 1e-4);
        assert!((axes[2] - (100.0 + 10.0 * part + 60.0 * 60f64.to_radians().sin())).abs() < 1e-4);
    }
    let elements = turn.blocks.as_ref().unwrap().summary().elements;
    assert!(elements < 80, "{elements}");
}

/// R takes the shorter arc, −R the longer one, and both meet the same ends as their centres.
#[test]
fn a_radius_makes_the_arc_that_its_centre_makes() {
    let same = [
        ("G2 X650 Y550 R50", "G2 X650 Y550 I50 J0"),
        ("G3 X650 Y550 R50", "G3 X650 Y550 I0 J50"),
        ("G2 X650 Y550 R-50", "G2 X650 Y550 I0 J50"),
        ("G3 X650 Y550 R-50", "G3 X650 Y550 I50 J0"),
        ("G3 X700 R50", "G3 X700 I50"),
    ];
    for (radius, centre) in same {
        let [by_radius, by_centre] = [radius, centre].map(|body| stir(body).unwrap().pop().unwrap());
        assert!(
            (by_radius.length_mm() - by_centre.length_mm()).abs() < 1e-6,
            "{radius}"
        );
        let middle = |path: &PlannedPath| path.path().at(path.length_mm() / 3.0).unwrap().pose().unwrap();
        let distance = (middle(&by_radius).position - middle(&by_centre).position).norm();
        assert!(distance < 1e-6, "{radius}: {distance}");
    }
}

#[test]
fn arcs_that_do_not_exist_are_named() {
    let message = |body: &str| stir(body).unwrap_err().to_string();
    assert_eq!(
        message("G1 X610\nG3 X660 Y560 J50"),
        "line 6, column 4: no arc here: radius mismatch: the start is 50.0000 mm from the centre, the end 50.9902 mm, a \
         difference of 0.9902 mm; 0.0510 mm is allowed here (0.1 % of the radius, but 0.028 mm in any case and never more \
         than 0.5 mm); correct the centre or the end"
    );
    assert_eq!(
        message("G3 X700 R49"),
        "line 5, column 4: half the distance of the arc's ends is 50.0000 mm, and R is less than that by 1.0000 mm; \
         0.0500 mm is allowed here (0.1 % of the radius, but 0.028 mm in any case and never more than 0.5 mm); correct R or \
         the end"
    );
    assert_eq!(
        message("G3 R10"),
        "line 5, column 4: R does not define the centre of a full circle; use I J K"
    );
    assert!(message("G3 X650 I0 J0").contains("zero radius"));
}

/// With radii that differ, or an R that is too small, the path still ends where the block says, and elements that the
/// board makes of numbers are the same.
#[test]
fn arcs_that_do_not_quite_fit_end_where_the_block_says() {
    for (body, end, taken) in [
        ("G3 X700.049 I50", [700.049, 500.0], true),
        ("G3 X700.051 I50", [700.051, 500.0], false),
        ("G3 X650 Y550.049 I50 C-90", [650.0, 550.049], true),
        ("G2 X650 Y449.96 P2 I50 C90", [650.0, 449.96], true),
        ("G3 X650 Y550.06 I50", [650.0, 550.06], false),
        ("G3 X700 R49.951", [700.0, 500.0], true),
        ("G3 X700 R-49.949", [700.0, 500.0], false),
        ("G2 X600.004 Y500 I0.5", [600.004, 500.0], true),
    ] {
        let paths = stir(body);
        assert_eq!(paths.is_ok(), taken, "{body}: {:?}", paths.err());
        let Ok(paths) = paths else { continue };
        let path = paths.last().unwrap();
        let point = path.path().at(path.length_mm()).unwrap();
        let off = (point.value[0] - end[0]).hypot(point.value[1] - end[1]);
        assert!(off < 1e-9, "{body}: {off}");
        for leg in path.legs().map(Result::unwrap) {
            let sent = shared::protocol::PathElement::from(&leg.element);
            assert!(sent.build().is_ok(), "{body}");
        }
    }
}

/// With G61 the path stops exactly at a corner and continues; what is switched is at its place.
#[test]
fn a_corner_stops_exactly_with_g61() {
    let body =
        "M67 E0 Q1200\nM62 P0\nG1 X650\nG3 X700 Y550 J50\nM67 E0 Q900\nG1 X690 Y560\nM63 P0\nG1 X680 Y570";
    let paths = stir(&format!("G61\n{body}")).unwrap();
    let [_, _, path] = &paths[..] else {
        panic!("one feed path: {}", paths.len())
    };
    let summary = path.blocks.as_ref().unwrap().summary();
    assert_eq!((summary.blocks, summary.stops, summary.corners), (4, 1, 1));
    assert!((summary.sharpest.to_degrees() - 45.0).abs() < 1e-6);
    assert_eq!(path.motion, Motion::Feed);
    let (corner, side) = (50.0 + 25.0 * std::f64::consts::PI, 0);
    let expected = [
        (0.0, PathAction::Power { side, watt: 1200.0 }),
        (0.0, PathAction::Beam { side, on: true }),
        (corner, PathAction::Power { side, watt: 900.0 }),
        (corner + 200f64.sqrt(), PathAction::Beam { side, on: false }),
    ];
    let legs: Vec<_> = path.legs().map(Result::unwrap).collect();
    let events: Vec<_> = legs.iter().flat_map(|leg| &leg.events).collect();
    assert_eq!(events.len(), 4);
    for (event, (s, action)) in events.iter().zip(expected) {
        assert!(
            (event.s_mm - s).abs() < 1e-9 && event.action == action,
            "{event:?}"
        );
    }
    let stops: Vec<_> = legs.iter().filter(|leg| leg.element.join == Join::Stop).collect();
    assert_eq!(stops.len(), 2);
    // With G64 it is rounded.
    let paths = stir(body).unwrap();
    let summary = paths[2].blocks.as_ref().unwrap().summary();
    assert_eq!((summary.stops, summary.tolerance_mm), (0, Some(0.05)));
}

/// Half a degree is gone over without a stop and without leaving the corner by a micrometre.
#[test]
fn a_corner_of_less_than_half_a_degree_is_gone_over() {
    let body = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (x, y) = (700.0 - 50.0 * sin, 550.0 + 50.0 * cos);
        format!("G61 G3 X700 Y550 I0 J50\nG1 X{x:.6} Y{y:.6}")
    };
    let start = "G1 X650\n";
    let paths = stir(&format!("{start}{}", body(0.4))).unwrap();
    assert_eq!(paths.len(), 3);
    let corner = Vector3::new(700.0, 550.0, 50.0);
    let near = largest(&paths[2], |_, position, _| {
        1.0 / (position - corner).norm().max(1e-9)
    });
    assert!(near > 1.0 / 0.05);
    let weld = &paths[2];
    let at = weld
        .path()
        .at(50.0 + 25.0 * std::f64::consts::PI)
        .unwrap()
        .pose()
        .unwrap();
    assert!(
        (at.position - corner).norm() < 1e-3,
        "{}",
        (at.position - corner).norm()
    );
    let stops = |degrees: f64| {
        let paths = stir(&format!("{start}{}", body(degrees))).unwrap();
        paths[2].blocks.as_ref().unwrap().summary().stops
    };
    assert_eq!([0.4, 0.6].map(stops), [0, 1]);
}

/// With a laser's feed the head cannot begin to turn at once: that takes a length, in which no limit is passed.
#[test]
fn fast_joins_stay_within_the_axes() {
    let body = "F6000\nG1 X1100\nG3 X1400 Y1300 J300 C80\nG1 Y1500";
    let planned = plan(body).unwrap().pop().unwrap();
    let planner = planner();
    let path = planned.knot_path();
    let mut near = [1000.0, 1000.0, 750.0, 0.0, 0.0, 0.0];
    let steps = (planned.length_mm() / 0.1) as usize;
    for i in 0..=steps {
        let s = planned.length_mm() * i as f64 / steps as f64;
        let point = path.at(s).unwrap();
        let at = at_unit_speed(planner.kinematics(), &point, planned.space, &near).unwrap();
        let at = at.at_speed(100.0, 0.0);
        near = at.position;
        for axis in 0..AXES {
            let acceleration = at.acceleration[axis].abs() / planner.drives[axis].acceleration;
            assert!(acceleration <= 1.001, "axis {axis}: {acceleration} at {s}");
        }
    }
    // Without room for that change the machine has to slow down.
    let found = too_fast(plan("F6000\nG1 X1100\nG3 X1110 Y1010 J10 C90\nG1 Y1500"));
    assert_eq!(found.axis, "C", "{found}");
}
