//! What made-up runs are worth.

use super::*;
use crate::Figure;
use evaluate::RunSample;
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::trajectory::RestToRest;
use std::collections::BTreeMap;

/// Time between two samples \[s\].
const STEP: f64 = 0.01;

/// What a run of the shipped part is worth, judged by `part`.
fn judged(
    part: &Stir,
    dwells: f64,
    disturb: impl Fn(&PlannedPath, f64, &mut RunSample),
) -> anyhow::Result<Vec<Figure>> {
    judged_on(&machine(), [&part_with("", ""), part], dwells, disturb)
}

/// Runs the first of `parts` as planned, but for what `disturb` does to the samples, told the path and s, and with only
/// a part of the dwells; judges it by the second one.
fn judged_on(
    machine: &MachineFile,
    parts: [&Stir; 2],
    dwells: f64,
    disturb: impl Fn(&PlannedPath, f64, &mut RunSample),
) -> anyhow::Result<Vec<Figure>> {
    let kinematics = machine.motion.kinematics().unwrap();
    let planned = planned(parts[0], machine);
    let mut samples = Vec::new();
    let mut axes: [f64; AXES] = machine.planning.park_axes();
    for (axis, unit) in axes.iter_mut().zip(AXIS_UNIT) {
        *axis *= unit;
    }
    let mut time = 100.0;
    let mut spindle = false;
    for (index, plan) in planned.iter().enumerate() {
        time += plan.dwell_before_s * dwells;
        let path = plan.path();
        let profile = RestToRest::new(plan.length_mm(), &plan.limits);
        spindle = (spindle || plan.weld().is_some()) && plan.motion == Motion::Feed;
        for i in 0..=(profile.duration() / STEP) as usize {
            let state = profile.at(i as f64 * STEP);
            let point = path.at(state.s).unwrap();
            axes = match plan.space {
                shared::trajectory::PathSpace::Axes => point.axes().position,
                shared::trajectory::PathSpace::Tool => {
                    kinematics.inverse(&point.pose().unwrap(), &axes).unwrap()
                }
            };
            let mut beams = [false; SIDES];
            beams[SPINDLE] = spindle;
            let mut sample = RunSample {
                time_us: (time * 1e6) as u64,
                path_id: index as u32 + 1,
                s_mm: state.s,
                speed_mm_s: state.v,
                beams,
                axes,
                pose: kinematics.forward(&axes),
            };
            disturb(plan, state.s, &mut sample);
            sample.pose = kinematics.forward(&sample.axes);
            samples.push(sample);
            time += STEP;
        }
    }
    let paths: BTreeMap<u32, PlannedPath> = (1..).zip(planned).collect();
    let run = Run {
        machine,
        kinematics: &kinematics,
        paths: &paths,
        samples: &samples,
        evaluation: &Default::default(),
    };
    let judgement = parts[1].judge(&context(machine), &run)?;
    assert_eq!(judgement.plots.len(), 3);
    for plot in &judgement.plots {
        assert!(plot.lines.iter().all(|(_, points)| points.len() >= 100));
    }
    Ok(judgement.figures)
}

fn value(figures: &[Figure], key: &str) -> f64 {
    let figure = figures.iter().find(|figure| figure.key == key);
    figure.unwrap_or_else(|| panic!("no {key}")).value
}

fn exceeded(figures: &[Figure]) -> Vec<&'static str> {
    let beyond = |figure: &&Figure| figure.limit.is_some_and(|limit| figure.value > limit);
    figures.iter().filter(beyond).map(|figure| figure.key).collect()
}

#[test]
fn a_run_as_planned_keeps_every_limit() {
    let figures = judged(&part_with("", ""), 1.0, |_, _, _| {}).unwrap();
    assert_eq!(exceeded(&figures), Vec::<&str>::new());
    assert!(value(&figures, "max_heading_error_deg") < 0.0034);
    for key in [
        "max_contour_distance_mm",
        "max_error_x_mm",
        "max_error_y_mm",
        "max_tilt_error_deg",
    ] {
        assert!(value(&figures, key) < 1e-5, "{key}: {}", value(&figures, key));
    }
    assert!((value(&figures, "preheat_s") - 2.5).abs() < 0.02);
}

/// C half a turn from the heading, and turned back where it ends.
#[test]
fn a_weld_in_two_passes_with_either_tilt_keeps_every_limit() {
    let positive = machine_with("tilt = \"negative\"", "tilt = \"positive\"");
    for machine in [machine(), positive] {
        let mut part = circle(0.0, "ccw");
        part.rewind = true;
        let figures = judged_on(&machine, [&part, &part], 1.0, |_, _, _| {}).unwrap();
        assert_eq!(exceeded(&figures), Vec::<&str>::new());
        assert!(value(&figures, "max_heading_error_deg") < 0.001);
        assert!(value(&figures, "max_contour_distance_mm") < 1e-5);
    }
}

#[test]
fn an_offset_is_seen_across_the_contour() {
    let figures = judged(&part_with("", ""), 1.0, |_, _, sample| sample.axes[1] += 0.05).unwrap();
    assert!((value(&figures, "mae_y_mm") - 0.05).abs() < 1e-6);
    assert!((value(&figures, "max_contour_distance_mm") - 0.05).abs() < 1e-5);
    assert!(value(&figures, "mae_x_mm") < 1e-5);
    // 0.05 of 215 to 241 mm, and of 26 mm.
    assert!((value(&figures, "mape_y_percent") - 0.022).abs() < 0.001);
    assert!((value(&figures, "nmae_y_percent") - 0.192).abs() < 0.001);
}

/// A tool that is late by 0.2 s: the distance from the contour does not see it, X and Y do.
#[test]
fn timing_is_no_distance_from_the_contour() {
    let late = 0.2;
    let paths = planned(&part_with("", ""), &machine());
    let weld = along(&paths)[0].path();
    let kinematics = machine().motion.kinematics().unwrap();
    let figures = judged(&part_with("", ""), 1.0, |plan, s, sample| {
        if plan.dwell_before_s > 0.0 && s > late {
            let pose = weld.at(s - late).unwrap().pose().unwrap();
            sample.axes = kinematics.inverse(&pose, &sample.axes).unwrap();
        }
    })
    .unwrap();
    assert!((value(&figures, "max_error_x_mm") - late).abs() < 1e-3);
    assert!(value(&figures, "max_contour_distance_mm") < 1e-5);
    assert!(value(&figures, "max_heading_error_deg") < 0.0034);
}

#[test]
fn a_lagging_head_exceeds_the_limit() {
    let figures = judged(&part_with("", ""), 1.0, |_, _, sample| {
        sample.axes[C] *= 0.999;
    })
    .unwrap();
    let seen = value(&figures, "max_heading_error_deg");
    assert!((seen - 0.0369).abs() < 0.0035, "{seen}");
    assert_eq!(exceeded(&figures), ["max_heading_error_deg"]);
    let leaning = judged(&part_with("", ""), 1.0, |_, _, sample| sample.axes[B] += 0.001).unwrap();
    assert!((value(&leaning, "max_tilt_error_deg") - 0.0573).abs() < 1e-4);
}

#[test]
fn a_spindle_that_stops_and_a_short_preheat_are_seen() {
    let stops = judged(&part_with("", ""), 1.0, |plan, s, sample| {
        sample.beams[SPINDLE] &= plan.dwell_before_s == 0.0 || s < 47.0;
    })
    .unwrap();
    assert!((value(&stops, "spindle_off_percent") - 50.0).abs() < 1.0);
    assert_eq!(exceeded(&stops), ["spindle_off_percent"]);
    let short = judged(&part_with("", ""), 0.5, |_, _, _| {}).unwrap();
    assert!((value(&short, "preheat_s") - 1.25).abs() < 0.02);
    assert!((value(&short, "preheat_short_s") - 1.25).abs() < 0.02);
    let never = judged(&part_with("", ""), 1.0, |_, _, sample| {
        sample.beams[SPINDLE] = false
    });
    assert!(never.unwrap_err().to_string().contains("nothing was welded"));
}

#[test]
fn another_program_is_no_run_of_the_part() {
    let longer = part_with("[338.0, 241.0]", "[340.0, 241.0]");
    let error = judged(&longer, 1.0, |_, _, _| {}).unwrap_err().to_string();
    assert!(error.starts_with("the program stirs 94.35"), "{error}");
}
