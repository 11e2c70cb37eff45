//! The shipped part from its dimensions to the run.

use super::*;
use crate::Judgement;
use cam::path::{PlannedPath, Planner};
use evaluate::RunSample;
use nc::{Options, interpret};
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::trajectory::PathSpace;
use std::collections::BTreeMap;

fn part() -> PartFile {
    PartFile::read(&shipped("programs/saddle-320-80.toml")).unwrap()
}

pub(super) fn paths(program: &str, machine: &MachineFile) -> BTreeMap<u32, PlannedPath> {
    let program = interpret(program, Options::default()).unwrap();
    let planner = Planner::build(machine).unwrap();
    let paths = planner
        .program(&program, &machine.planning.park_axes(), None)
        .unwrap();
    (1..).zip(paths).collect()
}

fn shipped_paths() -> BTreeMap<u32, PlannedPath> {
    let program = std::fs::read_to_string(shipped("programs/saddle-320-80.ngc")).unwrap();
    paths(&program, &machine())
}

/// Samples of a run every ms that holds each path exactly, but for what `off` does to the axes.
fn samples(
    paths: &BTreeMap<u32, PlannedPath>,
    machine: &MachineFile,
    off: impl Fn(&mut [f64; AXES]),
) -> Vec<RunSample> {
    let kinematics = machine.motion.kinematics().unwrap();
    let mut samples = Vec::new();
    let mut time_us = 0;
    for (&path_id, planned) in paths.iter().filter(|(_, path)| path.weld().is_some()) {
        let path = planned.path();
        let (start, end) = planned.weld().unwrap();
        let speed_mm_s = planned.limits.velocity;
        let mut near = [0.0; AXES];
        for tick in 0..(planned.length_mm() / speed_mm_s * 1000.0) as u32 {
            let s_mm = f64::from(tick) * speed_mm_s / 1000.0;
            let pose = path.at(s_mm).unwrap().pose().unwrap();
            near = kinematics.inverse(&pose, &near).unwrap();
            let mut axes = near;
            off(&mut axes);
            time_us += 1000;
            let mut beams = [false; SIDES];
            beams[0] = (start..end).contains(&s_mm);
            let pose: Pose = kinematics.forward(&axes);
            samples.push(RunSample {
                time_us,
                path_id,
                s_mm,
                speed_mm_s,
                beams,
                axes,
                pose,
            });
        }
    }
    samples
}

fn judge(paths: &BTreeMap<u32, PlannedPath>, samples: &[RunSample]) -> anyhow::Result<Judgement> {
    let machine = machine();
    part().judge(&Run {
        machine: &machine,
        kinematics: &machine.motion.kinematics().unwrap(),
        paths,
        samples: &samples.to_vec(),
        evaluation: &Default::default(),
    })
}

fn figure(judgement: &Judgement, key: &str) -> f64 {
    let figure = judgement.figures.iter().find(|figure| figure.key == key);
    figure.unwrap_or_else(|| panic!("no {key}")).value
}

#[test]
fn the_shipped_program_is_the_plan_of_the_shipped_part() {
    let plan = part().plan(&machine(), "saddle-320-80").unwrap();
    let shipped = std::fs::read_to_string(shipped("programs/saddle-320-80.ngc")).unwrap();
    assert_eq!(plan.program, shipped);
    // The figures of the prototype in mathematics 1.3.
    let notes = plan.notes.join("\n");
    for wanted in [
        "seam of 253.09 mm, 11.92 mm high, groove 84.8 to 108.6°, tilt 35.7 to 47.6°",
        "up to 8.86° off the bisector",
    ] {
        assert!(notes.contains(wanted), "{notes}");
    }
}

#[test]
fn the_planned_path_is_on_the_exact_saddle_and_the_bisector() {
    let paths = shipped_paths();
    let judgement = judge(&paths, &samples(&paths, &machine(), |_| {})).unwrap();
    let distance = figure(&judgement, "max_distance_to_saddle_mm");
    assert!(distance < 2e-5, "{distance} mm");
    let angle = figure(&judgement, "max_bisector_error_deg");
    assert!(angle < 1e-5, "{angle}°");
    assert!((figure(&judgement, "max_out_of_plane_deg") - 8.863).abs() < 1e-3);
    // Once around and 5 mm on; the cover is 2 mm further out all around.
    let length = figure(&judgement, "welded_length_mm");
    assert!((length - 528.9).abs() < 0.1, "{length} mm");
    let fluctuation = figure(&judgement, "speed_fluctuation_percent");
    assert!(fluctuation < 0.01, "{fluctuation} %");
}

#[test]
fn the_judge_sees_a_torch_that_is_off() {
    let paths = shipped_paths();
    let off = |axis: usize, by: f64| {
        let samples = samples(&paths, &machine(), |axes| axes[axis] += by * AXIS_UNIT[axis]);
        judge(&paths, &samples).unwrap()
    };
    // Outwards by 20 µm: that is across the seam.
    let distance = figure(&off(0, 0.02), "max_distance_to_saddle_mm");
    assert!((distance - 0.02).abs() < 1e-4, "{distance}");
    // The tilt swings the tip by 60 mm as well, and with it the place of the seam that is nearest.
    let tilted = off(4, 0.05);
    assert!((figure(&tilted, "max_bisector_error_deg") - 0.05).abs() < 0.01);
    let distance = figure(&tilted, "max_distance_to_saddle_mm");
    assert!(distance > 0.04 && distance < 0.053, "{distance}");
}

#[test]
fn a_run_of_another_program_or_without_arc_is_told_so() {
    let mut paths = shipped_paths();
    let none = judge(&paths, &[]).unwrap();
    assert_eq!(none.figures.len(), 1);
    assert_eq!(figure(&none, "welded_length_mm"), 0.0);
    let welds = || paths.iter().filter(|(_, path)| path.weld().is_some());
    let last = *welds().next_back().unwrap().0;
    paths.remove(&last);
    let error = judge(&paths, &[]).unwrap_err().to_string();
    assert_eq!(
        error,
        "the program has 1 welds and the part 2 passes: plan it again"
    );
}

#[test]
fn the_torch_leaves_the_work_before_the_waist_turns_back() {
    let machine = machine();
    let kinematics = machine.motion.kinematics().unwrap();
    let safe = machine.planning.safe_height_mm;
    let seam = prototype(Placement::default());
    let branch = seam.pair().branch_radius();
    let park = machine.planning.park_axes();
    let mut near = std::array::from_fn(|i| park[i] * AXIS_UNIT[i]);
    for (_, planned) in shipped_paths() {
        let path = planned.path();
        for i in 0..=200 {
            let s = planned.length_mm() * f64::from(i) / 200.0;
            let point = path.at(s).unwrap();
            let axes = match planned.space {
                PathSpace::Axes => point.axes().position,
                PathSpace::Tool => kinematics.inverse(&point.pose().unwrap(), &near).unwrap(),
            };
            let tip = kinematics.forward(&axes).position;
            let turning = (axes[5] - near[5]).abs() > 1e-6;
            near = axes;
            assert!(tip.xy().norm() > branch - 1e-3, "inside the branch: {tip}");
            let outside = seam.pair().wall_distances(&seam.pair().to_main(&tip))[1];
            assert!(outside > -1e-3, "inside the main pipe: {tip}");
            if turning && planned.weld().is_none() {
                assert!(tip.z > safe - 1e-6, "turns at {tip}");
            }
        }
    }
}

#[test]
fn a_waist_without_travel_and_a_low_safe_height_are_named() {
    let text = std::fs::read_to_string(shipped("machines/pipe-welder.toml")).unwrap();
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let machine = MachineFile::parse("m.toml", &text.replace(from, to)).unwrap();
        part().plan(&machine, "saddle").unwrap_err().to_string()
    };
    let error = refused("travel_max = 380.0", "travel_max = 370.0");
    assert!(
        error.starts_with("axis C would have to go from -6.0° to 373.2°, but its travel is -20.0…370.0°"),
        "{error}"
    );
    let error = refused("safe_height_mm = 240.0", "safe_height_mm = 165.0");
    assert!(
        error.starts_with("planning.safe_height_mm of the machine is 165, but the main pipe reaches to"),
        "{error}"
    );
    let gantry = MachineFile::read(&shipped("machines/dual-beam-gantry.toml")).unwrap();
    let error = part().plan(&gantry, "saddle").unwrap_err().to_string();
    assert!(
        error.starts_with("machine dual-beam-gantry does not turn about a pipe"),
        "{error}"
    );
}

#[test]
fn other_pipes_are_planned_as_exactly_or_refused_as_too_near_to_tangent() {
    let large = std::fs::read_to_string(shipped("machines/pipe-welder.toml")).unwrap();
    let large = large
        .replace("travel_max = 200.0", "travel_max = 400.0")
        .replace("travel_min = 60.0", "travel_min = -300.0")
        .replace("travel_max = 360.0", "travel_max = 1200.0")
        .replace("safe_height_mm = 240.0", "safe_height_mm = 900.0");
    let machine = MachineFile::parse("large.toml", &large).unwrap();
    // Main, branch, angle, offset, and what is said.
    let pipes = [
        (320.0, 200.0, 60.0, 0.0, Ok("seam of 698.03 mm, 117.58 mm high")),
        (320.0, 60.0, 45.0, -90.0, Ok("seam of 262.89 mm, 85.34 mm high")),
        (320.0, 60.0, 135.0, 60.0, Ok("seam of 241.71 mm, 69.79 mm high")),
        (
            1000.0,
            300.0,
            75.0,
            100.0,
            Ok("seam of 976.39 mm, 113.56 mm high"),
        ),
        (320.0, 318.0, 90.0, 0.0, Ok("seam of 1175.75 mm, 142.14 mm high")),
        (320.0, 319.0, 90.0, 0.0, Err("pass 1: the smooth path through")),
        (
            320.0,
            319.9,
            90.0,
            0.0,
            Err("branch_diameter_mm, offset_mm: the seam bends by 38°"),
        ),
        (
            320.0,
            280.0,
            90.0,
            19.999,
            Err("branch_diameter_mm, offset_mm: the seam bends by 80°"),
        ),
    ];
    for (main, branch, angle, offset, wanted) in pipes {
        let text = format!(
            "[saddle]\nmain_diameter_mm = {main:?}\nbranch_diameter_mm = {branch:?}\nangle_deg = {angle:?}\n\
             offset_mm = {offset:?}\n[[saddle.passes]]\nspeed_mm_s = 5.0\npower_w = 4000.0\n"
        );
        let plan = plan_text(&text, &machine);
        let said = plan.map(|plan| plan.notes.join("; "));
        match (&said, wanted) {
            (Ok(said), Ok(wanted)) | (Err(said), Err(wanted)) => assert!(said.starts_with(wanted), "{said}"),
            _ => panic!("{said:?}, not {wanted:?}"),
        }
    }
}
