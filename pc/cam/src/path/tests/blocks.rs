//! Blocks that are followed exactly: the elements that the motion board is given.

use super::*;
use curves::nurbs::{Curve, Nurbs};
use shared::trajectory::{CHANNELS, Element, Join, Shape};

const STIR: &str = "G43.4\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\nF300\n";
const WIRE: &str = "G53 G0 X600 Y400 Z300 A0 B0 C0\nG43.4\nG0 X0 Y0 Z20 A0 B0 C0\nF600\n";

fn stir(body: &str) -> Vec<PlannedPath> {
    plan_on("stir-gantry", &format!("{STIR}{body}\nM2")).unwrap()
}

fn legs(path: &PlannedPath) -> Vec<Leg> {
    path.legs().map(Result::unwrap).collect()
}

fn elements(path: &PlannedPath) -> Vec<Element> {
    legs(path).into_iter().map(|leg| leg.element).collect()
}

/// Largest step of a value, and of a slope but at corners of the tip, from one element to the next.
fn steps(elements: &[Element]) -> (f64, f64) {
    let mut largest = (0.0_f64, 0.0_f64);
    for pair in elements.windows(2) {
        let (end, start) = (pair[0].at(pair[0].length), pair[1].at(0.0));
        for i in 0..CHANNELS {
            largest.0 = largest.0.max((end.value[i] - start.value[i]).abs());
            largest.1 = largest.1.max((end.first[i] - start.first[i]).abs());
        }
    }
    largest
}

/// What is between two corners: the tolerance, or none for a stop.
fn joins(mode: &str) -> Vec<Option<f64>> {
    let paths = stir(&format!("{mode}\nG1 X620\nY510\nX600\nY500"));
    assert_eq!(paths.len(), 3, "{mode}");
    let elements = elements(&paths[2]);
    let lines: Vec<u32> = elements.iter().map(|element| element.line).collect();
    assert_eq!(lines, [6, 7, 8, 9], "{mode}");
    assert!(
        elements
            .iter()
            .all(|element| matches!(element.shape, Shape::Line(_)))
    );
    assert!(elements.iter().all(|element| element.feed == 5.0));
    let tolerance = |element: &Element| match element.join {
        Join::Stop => None,
        Join::Blend(tolerance) => Some(tolerance.position),
    };
    elements.iter().map(tolerance).collect()
}

#[test]
fn corners_are_rounded_by_their_tolerance_or_are_stops() {
    let rounded = |p: f64| [Some(p), Some(p), Some(p), None];
    assert_eq!(joins("G64"), rounded(0.05));
    assert_eq!(joins("G64 P0.2"), rounded(0.2));
    assert_eq!(joins("G61"), [None; 4]);
    assert_eq!(joins("G61.1"), [None; 4]);
    // The closer word of the two blocks at a corner counts.
    let paths = stir(
        "G64 P0.2\nG1 X620\nG64 P0.1\nY510\nX600\nG61\nY500\nG64\nX590\nG61.1\nX580\nG64 X570\nX570 Y510",
    );
    let tolerances: Vec<_> = elements(&paths[2]).iter().map(|e| e.join).collect();
    let position = |join: &Join| match join {
        Join::Stop => 0.0,
        Join::Blend(tolerance) => tolerance.position,
    };
    let seen: Vec<f64> = tolerances.iter().map(position).collect();
    // At the end of G61 the path turns; at the start of G61.1 it does not.
    assert_eq!(seen, [0.1, 0.1, 0.0, 0.0, 0.05, 0.0, 0.05, 0.0]);
    let summary = paths[2].blocks.as_ref().unwrap().summary();
    assert_eq!((summary.stops, summary.corners), (3, 2));
    assert_eq!(summary.tolerance_mm, Some(0.05));
}

/// A thousand short blocks with an output each, which no board holds at once.
#[test]
fn a_path_has_any_number_of_blocks_and_outputs() {
    let mut body = "G64 P0.01\nG1\n".to_owned();
    for i in 1..=1000 {
        let phi = f64::from(i) * 0.01;
        let (x, y) = (650.0 - 50.0 * phi.cos(), 500.0 + 50.0 * phi.sin());
        writeln!(body, "M67 E0 Q{i}\nX{x:.4} Y{y:.4} F{}", 300 + i % 7).unwrap();
    }
    let paths = stir(&body);
    let legs = legs(&paths[2]);
    assert_eq!((paths.len(), legs.len()), (3, 1000));
    let mut s = 0.0;
    for (i, leg) in legs.iter().enumerate() {
        assert_eq!((leg.events.len(), leg.element.line), (1, 7 + 2 * i as u32 + 1));
        assert!((leg.events[0].s_mm - s).abs() < 1e-9);
        s += leg.element.length;
    }
    assert!((s - paths[2].length_mm()).abs() < 1e-9);
    let summary = *paths[2].blocks.as_ref().unwrap().summary();
    assert_eq!((summary.blocks, summary.elements, summary.stops), (1000, 1000, 0));
    assert_eq!((summary.lines, summary.speeds.changes), ((8, 2006), 999));
    // Asked for in any order, every place of it is found.
    let course = paths[2].path();
    for part in [0.9, 0.1, 0.5, 1.0, 0.0] {
        let tip = course.at(part * s).unwrap().pose().unwrap().position;
        assert!(
            ((tip - Vector3::new(650.0, 500.0, 50.0)).norm() - 50.0).abs() < 2e-3,
            "{tip}"
        );
    }
}

/// The tool turns about one axis, evenly, and its T and N are off that by next to nothing.
#[test]
fn the_attitude_along_a_line_is_as_close_as_said() {
    let text = format!("{WIRE}G1 X60 A25 B-30 C40\nM2");
    let path = plan_on("wire-arc", &text).unwrap().pop().unwrap();
    let course = path.path();
    let [start, end] = [0.0, path.length_mm()].map(|s| course.at(s).unwrap().pose().unwrap());
    let elements = elements(&path);
    assert!((3..20).contains(&elements.len()), "{}", elements.len());
    let mut s = 0.0;
    for element in &elements {
        for i in 0..=20 {
            let along = element.length * f64::from(i) / 20.0;
            let value = element.at(along).value;
            let exact = interpolate(&start, &end, (s + along) / path.length_mm()).unwrap();
            let wanted = exact.tangent.iter().chain(&exact.normal);
            for (seen, wanted) in value[3..9].iter().zip(wanted) {
                assert!((seen - wanted).abs() < 1.1e-6, "{} at {s}", seen - wanted);
            }
        }
        s += element.length;
    }
    // Slopes come from differences.
    let (value, slope) = steps(&elements);
    assert!(value < 1e-9 && slope < 1e-9, "{value} {slope}");
}

/// Line, arc and three turns with the head turning: where they join smoothly nothing steps, and C continues
/// as it was.
#[test]
fn rotary_axes_come_and_go_evenly_at_joins() {
    let paths = stir("G64 P0.05\nG1 X650\nG3 X700 Y550 J50 C90\nG3 X700 Y550 I-50 P3 C180\nG1 Y600");
    let elements = elements(&paths[2]);
    let (value, slope) = steps(&elements);
    assert!(value < 1e-8 && slope < 1e-6, "{value} {slope}");
    let axes = followed("stir-gantry", &paths, 0.01);
    let last = axes.last().unwrap().2;
    assert!((last[5] - 180.0).abs() < 1e-6, "C{}", last[5]);
    // Half of the way around.
    let begin = 50.0 + 25.0 * std::f64::consts::PI;
    let round = 300.0 * std::f64::consts::PI;
    let middle = axes
        .iter()
        .filter(|at| at.0 == 2)
        .min_by(|a, b| {
            let off = |s: f64| (s - begin - round / 2.0).abs();
            off(a.1).total_cmp(&off(b.1))
        })
        .unwrap();
    assert!((middle.2[5] - 135.0).abs() < 0.02, "C{}", middle.2[5]);
}

const POINTS: [[f64; 3]; 6] = [
    [0.0, 0.0, 20.0],
    [20.0, 0.0, 20.0],
    [50.0, 40.0, 30.0],
    [80.0, -40.0, 50.0],
    [120.0, 10.0, 50.0],
    [150.0, 40.0, 40.0],
];
const KNOTS: [f64; 10] = [0.0, 0.0, 0.0, 0.0, 1.0, 4.0, 5.0, 5.0, 5.0, 5.0];
const WEIGHTS: [f64; 6] = [1.0, 2.0, 1.0, 0.5, 1.0, 3.0];

/// Every point of the elements is one of the curve, at its length.
#[test]
fn a_nurbs_reaches_the_board_as_curves() {
    for turn in ["", " B20 C30"] {
        let mut text = format!("{WIRE}G6.2 P4 ");
        for (i, [x, y, z]) in POINTS.into_iter().enumerate() {
            let end = if i == 5 { turn } else { "" };
            writeln!(text, "K{} X{x} Y{y} Z{z} R{}{end}", KNOTS[i], WEIGHTS[i]).unwrap();
        }
        for knot in &KNOTS[6..] {
            writeln!(text, "K{knot}").unwrap();
        }
        let path = plan_on("wire-arc", &format!("{text}M2")).unwrap().pop().unwrap();
        let elements = elements(&path);
        assert!(
            elements
                .iter()
                .all(|element| matches!(element.shape, Shape::Curve(_)))
        );
        assert!(elements.iter().all(|element| element.line == 5));
        let (value, slope) = steps(&elements);
        assert!(value < 1e-8 && slope < 1e-6, "{value} {slope}");
        let points = POINTS.map(Vector3::from);
        let nurbs = Nurbs::new(3, &points, &WEIGHTS, &KNOTS).unwrap();
        let whole = curves::nurbs::length(&nurbs);
        assert!((path.length_mm() - whole).abs() < 1e-6);
        let mut s = 0.0;
        for element in &elements {
            for part in [0.0, 0.3, 0.8] {
                let u = curves::nurbs::parameter_at_length(&nurbs, 0.0, s + part * element.length);
                let value = element.at(part * element.length).value;
                let off = Vector3::new(value[0], value[1], value[2]) - nurbs.point(u);
                assert!(off.norm() < 1e-5, "{off} at {s}");
            }
            s += element.length;
        }
    }
}

/// The worst of the whole path is reported, with its line.
#[test]
fn what_the_axes_cannot_do_is_told_with_the_line_of_its_block() {
    let message = |body: &str| {
        let text = format!("{STIR}G61\n{body}\nM2");
        plan_on("stir-gantry", &text).unwrap_err().to_string()
    };
    let error = message("G1 X700\nY-2\nX710\nY-5\nY500");
    assert!(
        error.starts_with("line 9, column 1: axis Y would have to go to -5"),
        "{error}"
    );
    let found = too_fast(plan_on(
        "stir-gantry",
        &format!("{STIR}G61\nG1 X610\nF7000 X700\nF300 X800\nM2"),
    ));
    let found = found.to_string();
    assert!(
        found.starts_with("line 7, column 7: the feed of 7000 mm/min is too high"),
        "{found}"
    );
    let error = message("G1 X610\nX650 C190");
    assert!(
        error.starts_with("line 7, column 1: C would come to -170.000°"),
        "{error}"
    );
    let outputs = "M67 E0 Q1\n".repeat(MAX_EVENTS + 1);
    let error = message(&format!("G1 X610\n{outputs}X620"));
    assert!(
        error.starts_with("line 136, column 1: the path has 129 outputs"),
        "{error}"
    );
}
