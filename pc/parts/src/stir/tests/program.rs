//! Planned programs: the shipped one, how exact they are, and where C ends.

use super::*;
use crate::stir::contour::Segment;
use shared::io::AXES;
use shared::kinematics::AXIS_UNIT;

/// Plans `part` and follows it in steps of 0.02 mm: everywhere the tip is on the contour, C on its heading but for
/// whole turns, B where it was said. Returns C over the way \[°\].
fn assert_exact(part: &Stir, machine: &MachineFile) -> Vec<f64> {
    let job = part.job(machine).unwrap();
    let planner = Planner::build(machine).unwrap();
    let paths = planned(part, machine);
    let joins: Vec<f64> = job.contour.segments().iter().map(Segment::end_s).collect();
    let mut axes: [f64; AXES] = machine.planning.park_axes();
    for (axis, unit) in axes.iter_mut().zip(AXIS_UNIT) {
        *axis *= unit;
    }
    let mut seen = Vec::new();
    let mut start_s = 0.0;
    let contour_paths = along(&paths);
    assert_eq!(contour_paths.len(), job.passes.len());
    for (planned, pass) in contour_paths.into_iter().zip(&job.passes) {
        axes[4] = job.b;
        axes[5] = job.contour.at(pass.from).1 + pass.offset;
        let path = planned.path();
        let steps = (planned.length_mm() / 0.02).ceil();
        for i in 0..=steps as usize {
            let s = planned.length_mm() * i as f64 / steps;
            let pose = path.at(s).unwrap().pose().unwrap();
            axes = planner.kinematics().inverse(&pose, &axes).unwrap();
            let (place, heading) = job.contour.at(start_s + s);
            let off = (pose.position - place).norm();
            assert!(off < 1e-5, "{off} mm off at {s}");
            let wrong = (axes[5] - heading - pass.offset).to_degrees().abs();
            let near_join = joins.iter().any(|join| (start_s + s - join).abs() < 0.1);
            let limit = if near_join { 0.0035 } else { 0.001 };
            assert!(wrong < limit, "C is {wrong}° off at {s}");
            let tilt = (axes[4] - job.b).to_degrees().abs();
            assert!(tilt < 1e-4, "B is {tilt}° off at {s}");
            seen.push(axes[5].to_degrees());
        }
        start_s += planned.length_mm();
    }
    assert!((start_s - job.contour.length()).abs() < 1e-4);
    seen
}

fn range(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

#[test]
fn the_shipped_program_is_the_plan_of_the_shipped_part() {
    let plan = plan(&part_with("", ""), &machine()).unwrap();
    let text = std::fs::read_to_string(shipped("programs/stir-contour.ngc")).unwrap();
    assert!(text == plan.program, "plan it again:\n{}", plan.program);
    assert!(
        plan.notes[0].contains("94.35 mm in 5 segments, 1.6 min; C moves between 0.00° and 36.87°"),
        "{:?}",
        plan.notes
    );
    assert!(plan.notes[1].contains("up to 0.0033° off"), "{:?}", plan.notes);
    assert!(plan.notes[2].contains("9.2° off on segment"), "{:?}", plan.notes);
}

#[test]
fn the_shipped_weld_is_one_path_on_the_contour_with_c_along_it() {
    let (part, machine) = (part_with("", ""), machine());
    let c = assert_exact(&part, &machine);
    let (low, high) = range(&c);
    assert!(
        low.abs() < 1e-3 && (high - 36.8699).abs() < 1e-3,
        "{low} to {high}"
    );
    let paths = planned(&part, &machine);
    let weld = along(&paths)[0];
    assert_eq!(weld.dwell_before_s, 2.5);
    assert_eq!(weld.limits.velocity, 1.0);
    let plunge = paths.iter().find(|path| path.motion == Motion::Feed).unwrap();
    assert!((plunge.length_mm() - 6.0).abs() < 1e-9);
    assert!((plunge.limits.velocity - 40.0 / 60.0).abs() < 1e-12);
}

/// The sign of the tilt decides whether C is the heading or half a turn from it; upright it is the same.
#[test]
fn either_sign_of_the_tilt_and_none_lean_backwards() {
    let positive = machine_with("tilt = \"negative\"", "tilt = \"positive\"");
    for (machine, from) in [(machine(), 0.0), (positive, 180.0)] {
        for tilt in ["2.5", "5.0", "0.0"] {
            let part = part_with("tilt_deg = 2.5", &format!("tilt_deg = {tilt}"));
            let shift = if from > 0.0 { -180.0 } else { 0.0 };
            let c = assert_exact(&part, &machine);
            assert!((c[0] - shift).abs() < 1e-3, "{}", c[0]);
            // O leans against the heading (mathematics 4.1).
            let paths = planned(&part, &machine);
            let pose = along(&paths)[0].path().at(5.0).unwrap().pose().unwrap();
            let back = f64::to_radians(tilt.parse().unwrap()).sin();
            assert!((pose.normal.x + back).abs() < 1e-9, "{:?}", pose.normal);
        }
    }
}

/// A whole turn fits if it begins at one end of the travel and goes to the other one.
#[test]
fn the_start_of_c_is_chosen_so_that_the_contour_fits() {
    let machine = machine();
    let c = assert_exact(&circle(90.0, "ccw"), &machine);
    assert!((c[0] + 180.0).abs() < 1e-3 && (c[c.len() - 1] - 180.0).abs() < 1e-3);
    let c = assert_exact(&circle(-90.0, "cw"), &machine);
    assert!((c[0] - 180.0).abs() < 1e-3 && (c[c.len() - 1] + 180.0).abs() < 1e-3);
}

/// Where C ends, the pin is lifted, C turned back and the pin plunged again at the same place.
#[test]
fn c_is_turned_back_above_the_plate() {
    let machine = machine();
    let mut part = circle(0.0, "ccw");
    part.rewind = true;
    let c = assert_exact(&part, &machine);
    let (low, high) = range(&c);
    assert!(
        (low + 180.0).abs() < 1e-3 && (high - 180.0).abs() < 1e-3,
        "{low} to {high}"
    );
    let job = part.job(&machine).unwrap();
    let cut = 30.0 * std::f64::consts::FRAC_PI_2;
    assert!((job.passes[0].to - cut).abs() < 1e-6 && job.passes.len() == 2);
    let plan = plan(&part, &machine).unwrap();
    assert!(
        plan.notes[0].contains("between -180.00° and 180.00°"),
        "{:?}",
        plan.notes
    );
    assert!(
        plan.notes[1].contains("lifted after 47.12 mm"),
        "{:?}",
        plan.notes
    );
    // Wherever C turns, the tip is at the safe height.
    let program = &plan.program;
    let turns: Vec<usize> = program.match_indices("G53 G0 B").map(|(at, _)| at).collect();
    assert_eq!(turns.len(), 2);
    for at in turns {
        let before = program[..at]
            .lines()
            .rev()
            .find(|line| line.contains('Z'))
            .unwrap();
        assert!(before.contains("G53 G0 Z200.0"), "{before}");
    }
    // Too little to weld before C ends.
    let mut early = circle(89.0, "ccw");
    early.rewind = true;
    let error = early.job(&machine).map(|_| ()).unwrap_err();
    assert!(matches!(error, StirError::Travel { segment: 1, .. }), "{error}");
}

/// Straight on in two blocks, without any arc.
#[test]
fn lines_alone_are_a_weld_too() {
    let part = part_along(
        "[300.0, 200.0]",
        "{ line_to = [300.0, 230.0] }, { line_to = [300.0, 260.0] }",
    );
    let c = assert_exact(&part, &machine());
    assert!(c.iter().all(|c| (c - 90.0).abs() < 1e-6));
}
