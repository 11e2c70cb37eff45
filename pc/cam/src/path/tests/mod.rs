//! Paths planned for the shipped machines: where they lead, how fast, and what is refused.

mod arcs;
mod blocks;
mod control;
mod directions;
mod feeds;
mod jog;
mod machines;
mod nurbs;
mod outputs;
mod program_setup;
mod rotary;
mod short_blocks;
mod smoothing;
mod tilt;
mod too_fast;
mod waits;

use super::*;
use crate::attitude::interpolate;
use nalgebra::Vector3;
use nc::{Options, SourcePosition, interpret};
use shared::geometry::angle;
use shared::trajectory::{SpeedLimits, at_unit_speed, axes_at};
use std::fmt::Write;

fn planner() -> Planner {
    planner_of("dual-beam-gantry")
}

/// A planner for a shipped machine.
fn planner_of(name: &str) -> Planner {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines");
    let file = std::path::Path::new(folder).join(name).with_extension("toml");
    Planner::build(&MachineFile::read(&file).unwrap()).unwrap()
}

/// Plans `program` on a shipped machine from its park position.
fn plan_on(machine: &str, program: &str) -> Result<Vec<PlannedPath>, PathError> {
    let program = interpret(program, Options::default()).unwrap();
    let planner = planner_of(machine);
    planner.program(&program, &planner.planning.park_axes(), None)
}

/// Where the feed of the last of these paths is more than an axis allows.
fn too_fast(paths: Result<Vec<PlannedPath>, PathError>) -> FeedTooHigh {
    let path = paths.unwrap().pop().unwrap();
    path.too_fast.anywhere.expect("a feed that is too high")
}

/// Axes along planned paths in steps of at most `step` mm, as the motion board would follow them from park
/// (mm, degrees); each with the number of its path and s.
fn followed(machine: &str, paths: &[PlannedPath], step: f64) -> Vec<(usize, f64, [f64; AXES])> {
    let planner = planner_of(machine);
    let mut axes = inner(&planner.planning.park_axes());
    let mut seen = Vec::new();
    for (index, planned) in paths.iter().enumerate() {
        let path = planned.path();
        let count = (planned.length_mm() / step).ceil() as usize;
        for i in 0..=count {
            let s = planned.length_mm() * i as f64 / count as f64;
            let point = path.at(s).unwrap();
            axes = axes_at(planner.kinematics(), &point, planned.space, &axes).unwrap();
            seen.push((index, s, std::array::from_fn(|i| axes[i] / AXIS_UNIT[i])));
        }
    }
    seen
}

/// Plans `body` with the tip at X1000 Y1000 Z100, all angles zero.
fn plan(body: &str) -> Result<Vec<PlannedPath>, PathError> {
    let text = format!("G43.4\nG0 X1000 Y1000 Z100 A0 B0 C0\n{body}\nM2\n");
    let program = interpret(&text, Options::default()).unwrap();
    let planner = planner();
    let from = [100.0, 100.0, 900.0, 0.0, 0.0, 0.0];
    planner.program(&program, &from, None)
}

#[test]
fn a_path_begins_where_the_machine_stands_and_ends_at_its_target() {
    let planned = plan("G0 X1200 A30 C-20").unwrap();
    let planner = planner();
    let at = |path: &PlannedPath, s: f64| {
        let pose = path.path().at(s).unwrap().pose().unwrap();
        planner.kinematics().inverse(&pose, &[0.0; AXES]).unwrap()
    };
    let start = at(&planned[0], 0.0);
    for (axis, wanted) in [100.0, 100.0, 900.0, 0.0, 0.0, 0.0].into_iter().enumerate() {
        assert!(
            (start[axis] - wanted).abs() < 1e-9,
            "axis {axis}: {}",
            start[axis]
        );
    }
    let end = at(&planned[1], planned[1].length_mm());
    assert!((end[3].to_degrees() - 30.0).abs() < 1e-9 && (end[5].to_degrees() + 20.0).abs() < 1e-9);
    let tip = planner.kinematics().forward(&end).position;
    assert!((tip - Vector3::new(1200.0, 1000.0, 100.0)).norm() < 1e-9);
}

#[test]
fn a_straight_move_turns_the_head_about_one_axis_at_an_even_rate() {
    let planned = plan("G0 X1100 A80 B20 C60").unwrap();
    let path = planned[1].path();
    let length = planned[1].length_mm();
    let (start, end) = (
        path.at(0.0).unwrap().pose().unwrap(),
        path.at(length).unwrap().pose().unwrap(),
    );
    for i in 0..=100 {
        let part = f64::from(i) / 100.0;
        let pose = path.at(part * length).unwrap().pose().unwrap();
        let exact = interpolate(&start, &end, part).unwrap();
        assert!((pose.position - exact.position).norm() < 1e-9);
        let off = angle(&pose.normal, &exact.normal).max(angle(&pose.tangent, &exact.tangent));
        assert!(off < 1e-4, "{off} rad off the geodesic at {part}");
    }
}

#[test]
fn rapids_use_their_part_of_the_limits_and_no_more() {
    // Turning the head makes the pivot swing: there the acceleration is shared with the curvature.
    for (body, least) in [("G0 Y1500", 0.49), ("G0 Z50", 0.49), ("G0 A60 B10", 0.24)] {
        let planned = plan(body).unwrap();
        let planner = planner();
        let path = planned[1].knot_path();
        let SpeedLimits {
            velocity,
            acceleration,
            ..
        } = planned[1].limits;
        let mut used: f64 = 0.0;
        for i in 0..=500 {
            let point = path.at(planned[1].length_mm() * f64::from(i) / 500.0).unwrap();
            let at = at_unit_speed(planner.kinematics(), &point, planned[1].space, &[0.0; AXES]).unwrap();
            let at = at.at_speed(velocity, acceleration);
            for axis in 0..AXES {
                let limits = &planner.drives[axis];
                let speed = at.velocity[axis].abs() / limits.velocity;
                let acceleration = at.acceleration[axis].abs() / limits.acceleration;
                assert!(
                    speed <= 0.501 && acceleration <= 0.501,
                    "{body}: axis {axis} {speed} {acceleration}"
                );
                used = used.max(speed).max(acceleration);
            }
        }
        assert!(used > least, "{body} uses only {used} of every limit");
    }
}

fn arc(radius: f64, feed: f64) -> String {
    let mut body = format!("F{feed}\nG1\n");
    for i in 1..=40 {
        let phi = f64::from(i) * 10.0 / radius;
        let (x, y) = (1000.0 + radius * phi.sin(), 1000.0 + radius * (1.0 - phi.cos()));
        let c = phi.to_degrees();
        writeln!(body, "X{x:.6} Y{y:.6} C{c:.6} V1={:.4}", 0.01 * f64::from(i)).unwrap();
    }
    body
}

#[test]
fn a_smooth_path_runs_by_its_length_through_every_point() {
    let planned = plan(&arc(600.0, 5000.0)).unwrap();
    let weld = &planned[1];
    assert!((weld.length_mm() - 400.0).abs() < 1e-3);
    assert!(weld.speed_error < 1e-4, "{}", weld.speed_error);
    assert_eq!(weld.knots.len(), 41);
    let last = weld.knots[40];
    assert!((last.value[9] - 0.4).abs() < 1e-9);
    let middle = weld.path().at(205.0).unwrap().pose().unwrap();
    let phi = 205.0_f64 / 600.0;
    let exact = Vector3::new(1000.0 + 600.0 * phi.sin(), 1600.0 - 600.0 * phi.cos(), 100.0);
    assert!(
        (middle.position - exact).norm() < 2e-4,
        "{}",
        (middle.position - exact).norm()
    );
}

#[test]
fn events_happen_where_their_motion_starts() {
    let body = "F5000\nM67 E0 Q100\nG1 X1010\nM62 P0\nX1110\nM63 P0\nX1120";
    let weld = &plan(body).unwrap()[1];
    let places: Vec<f64> = weld.events.iter().map(|event| event.s_mm).collect();
    for (seen, wanted) in places.iter().zip([0.0, 10.0, 110.0]) {
        assert!((seen - wanted).abs() < 1e-9);
    }
    let (on, off) = weld.weld().unwrap();
    assert!((on - 10.0).abs() < 1e-9 && (off - 110.0).abs() < 1e-9);
}

#[test]
fn leaving_the_travel_names_axis_amount_and_line() {
    let error = plan("G0 X1000\nG0 Y3020").unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 4, column 4: axis Y would have to go to 3020.000, 20.000 beyond its travel (0…3000 mm)"
    );
    let error = plan("G0 B31").unwrap_err();
    assert!(matches!(error, PathError::Travel { axis: "B", beyond, .. } if (beyond - 1.0).abs() < 1e-6));
    let error = plan("G0 X1010 V2=12.5").unwrap_err();
    assert!(matches!(error, PathError::Travel { axis: "V2", beyond, .. } if (beyond - 0.5).abs() < 1e-6));
}

#[test]
fn a_feed_above_the_axes_names_the_limiting_one() {
    // The head stands upright: only the tip's own speed counts, 333.333 mm/s along Y. What is named can be kept.
    assert_eq!(
        too_fast(plan("F21000\nG1 Y1400")).to_string(),
        "line 4, column 4: the feed of 21000 mm/min is too high, the speed of Y allows 19999 mm/min"
    );
    assert!(plan(&arc(600.0, 9000.0)).is_ok());
}

#[test]
fn what_is_not_smooth_is_refused_with_its_line() {
    let error = plan("F600\nG1 X1010\nY1010").unwrap_err();
    assert!(
        matches!(error, PathError::Corner { place: SourcePosition { line: 5, .. }, degrees } if (degrees - 90.0).abs() < 1e-9)
    );
    assert!(plan("F600\nG61.1\nG1 X1010\nY1010").is_ok());
    let events = MAX_EVENTS + 1;
    let error = plan(&format!("{}F600\nG1 X1010", "M62 P0\n".repeat(events))).unwrap_err();
    assert!(matches!(error, PathError::TooManyEvents { events: seen, .. } if seen == events));
    let points: String = (1..=CAPACITY).map(|i| format!("G1 X{}\n", 1000 + i)).collect();
    let error = plan(&format!("F600\n{points}")).unwrap_err();
    assert_eq!(
        error,
        PathError::TooLong {
            place: SourcePosition { line: 4, column: 4 },
            knots: CAPACITY + 1
        }
    );
}

#[test]
fn parking_moves_the_first_axes_and_then_all_to_the_park_position() {
    let planner = planner();
    let paths = planner.park(&[1000.0, 1000.0, 700.0, 20.0, 5.0, -10.0]).unwrap();
    let [up, across] = &paths[..] else {
        panic!("Z first, then all")
    };
    let end = |path: &PlannedPath| path.path().at(path.length_mm()).unwrap().axes().position;
    let (above, last) = (end(up), end(across));
    let people = |axes: [f64; AXES]| std::array::from_fn::<_, AXES, _>(|i| axes[i] / AXIS_UNIT[i]);
    for (seen, wanted) in people(above)
        .iter()
        .zip([1000.0, 1000.0, 950.0, 20.0, 5.0, -10.0])
    {
        assert!((seen - wanted).abs() < 1e-9);
    }
    for (seen, wanted) in people(last).iter().zip(planner.planning.park_axes()) {
        assert!((seen - wanted).abs() < 1e-9);
    }
    assert!(planner.park(&planner.planning.park_axes()).unwrap().is_empty());
}

#[test]
fn more_power_than_the_beam_gives_is_refused_with_its_line() {
    let error = plan("M67 E1 Q4000.5\nF600\nG1 X1010").unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 3, column 1: 4000.5 W is more than the maximum of beam 2, 4000 W"
    );
    assert!(plan("M67 E1 Q4000\nF600\nG1 X1010").is_ok());
}
