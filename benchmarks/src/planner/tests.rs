//! Short lines through the kinematics, as a PC gives them to the board: smoothed.

use super::programs::{PROGRAMS, Program};
use super::{CREDITS, MACHINE, PATIENCE};
use crate::machine::machines;
use crate::machine_files::pack;
use crate::trajectories::TICK;
use curves::smoothing::smooth;
use nalgebra::Vector3;
use shared::io::AXES;
use shared::kinematics::Kinematics;
use shared::trajectory::{BoardPlanner, Element, PlanLimits, Shape};
use std::path::Path;

/// Acceleration along paths of the machine \[mm/s²\].
const ACCELERATION: f64 = 500.0;

/// Where the axes are at every tick until the machine has come to the end of `elements`.
fn run(
    program: &Program,
    elements: &[Element],
    kinematics: &Kinematics,
    limits: &PlanLimits,
) -> Vec<[f64; AXES]> {
    let mut planner = Box::new(BoardPlanner::new());
    let start = program.start(kinematics).expect("a place of the machine");
    planner.start(limits, program.space, 0.0, &start);
    let mut coming = elements.iter();
    let mut axes = vec![start; 3];
    for _ in 0..PATIENCE {
        for element in coming.by_ref().take(CREDITS.min(planner.room())) {
            planner.push(element.clone()).expect("a sound element");
        }
        let output = planner.tick(kinematics).expect("places that the machine reaches");
        axes.push(output.axes.position);
        if coming.len() == 0 && output.at_rest {
            return axes;
        }
    }
    panic!("it does not come to its end");
}

/// Largest derivative of an axis of some `order` by differences.
fn peak(axes: &[[f64; AXES]], axis: usize, order: usize) -> f64 {
    let mut values: Vec<f64> = axes.iter().map(|axes| axes[axis]).collect();
    for _ in 0..order {
        values = values.windows(2).map(|two| (two[1] - two[0]) / TICK).collect();
    }
    values.into_iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// Distance of a point from lines \[mm\].
fn distance(point: &Vector3<f64>, lines: &[Element]) -> f64 {
    let to = |line: &Element| match &line.shape {
        Shape::Line(shape) => {
            let way = shape.end() - shape.start();
            let part = (point - shape.start()).dot(&way) / way.norm_squared();
            (shape.start() + way * part.clamp(0.0, 1.0) - point).norm()
        }
        _ => f64::INFINITY,
    };
    lines.iter().map(to).fold(f64::INFINITY, f64::min)
}

#[test]
fn short_lines_with_a_turning_head_are_faster_when_they_are_smoothed() {
    let file = pack(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines")).expect("shipped files");
    let machine = machines(&file)
        .filter_map(Result::ok)
        .find(|machine| machine.kinematics.name() == MACHINE);
    let (kinematics, limits) = machine.expect("the machine").build().expect("its kinematics");
    let program = PROGRAMS.iter().find(|program| program.name == "short-lines-tool");
    let program = program.expect("the program");
    let lines: Vec<Element> = (0..program.elements)
        .filter_map(|index| program.element(&kinematics, index))
        .collect();
    let smoothed = smooth(
        lines.iter().map(|line| (line.clone(), f64::INFINITY)),
        ACCELERATION,
    );
    let limits = program.limits(&limits);
    let [as_written, smooth] =
        [&lines, &smoothed].map(|elements| run(program, elements, &kinematics, &limits));
    let [written_s, smooth_s] = [&as_written, &smooth].map(|axes| axes.len() as f64 * TICK);
    println!(
        "{written_s} s for {} lines, {smooth_s} s for {} elements",
        lines.len(),
        smoothed.len()
    );
    assert!(
        smooth_s <= 5.0,
        "{smooth_s} s, and {written_s} s as it is written"
    );
    assert!(smoothed.len() < lines.len() / 2, "{} elements", smoothed.len());
    for axis in 0..AXES {
        assert!(
            peak(&smooth, axis, 2) <= 1.01 * limits.acceleration[axis],
            "axis {axis}"
        );
        assert!(peak(&smooth, axis, 3) <= 1.05 * limits.jerk[axis], "axis {axis}");
    }
    for axes in &smooth {
        let off = distance(&kinematics.forward(axes).position, &lines);
        assert!(off <= 0.05, "{off} mm off the lines");
    }
}
