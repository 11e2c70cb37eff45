//! Judging runs that are made up, so that the figures are known.

use super::*;
use crate::{Judgement, Run};
use evaluate::RunSample;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::AXES;
use std::collections::BTreeMap;

/// Runs the paths of `part` at a speed over s, with an error of the tip by s, and judges that.
fn judged(
    part: &str,
    speed: impl Fn(f64) -> f64,
    error: impl Fn(f64) -> Vector3<f64>,
) -> anyhow::Result<Judgement> {
    let machine = machine();
    let program = plan(part, &machine)?.program;
    let kinematics = machine.motion.kinematics()?;
    let mut paths = BTreeMap::new();
    let mut samples = Vec::new();
    let mut time_us = 0;
    for (id, path) in (7..).zip(feed_paths(&program, &machine)) {
        let curve = path.path();
        let (start, end) = path.weld().unwrap();
        let mut s = 0.0;
        while s < path.length_mm() {
            let pose = curve.at(s).unwrap().pose()?;
            samples.push(RunSample {
                time_us,
                path_id: id,
                s_mm: s,
                speed_mm_s: path.limits.velocity,
                beams: [start <= s && s < end, false],
                axes: [0.0; AXES],
                pose: Pose {
                    position: pose.position + error(s),
                    ..pose
                },
            });
            time_us += 1000;
            s += speed(s) * 1e-3;
        }
        paths.insert(id, path);
    }
    let part: Part = toml::from_str(part)?;
    let directory = shipped("programs");
    let context = PartContext {
        machine: &machine,
        directory: &directory,
        title: "",
    };
    let run = Run {
        machine: &machine,
        kinematics: &kinematics,
        paths: &paths,
        samples: &samples,
        evaluation: &Default::default(),
    };
    part.kind().judge(&context, &run)
}

fn figure(judgement: &Judgement, key: &str) -> f64 {
    let figure = judgement.figures.iter().find(|figure| figure.key == key);
    figure
        .unwrap_or_else(|| panic!("no {key} in {:?}", judgement.figures))
        .value
}

/// Asserts figures by key, value and tolerance.
fn assert_figures(judgement: &Judgement, wanted: &[(&str, f64, f64)]) {
    for (key, value, tolerance) in wanted {
        let seen = figure(judgement, key);
        assert!((seen - value).abs() <= *tolerance, "{key} is {seen}, not {value}");
    }
}

#[test]
fn a_perfect_run_of_the_leaf_has_no_errors() {
    let judgement = judged(&leaf(), |_| 9.588, |_| Vector3::zeros()).unwrap();
    assert_figures(
        &judgement,
        &[
            ("bead_length_mm", 353.95, 0.02),
            ("length_outside_window_percent", 0.0, 0.0),
            ("time_outside_window_percent", 0.0, 0.0),
            // What the spline is off, in speed and place.
            ("speed_fluctuation_max_percent", 0.0, 0.15),
            ("slowest_in_corners_mm_s", 9.588, 0.02),
            ("contour_error_max_mm", 0.0, 2e-3),
        ],
    );
    let [speed, contour] = &judgement.plots[..] else {
        panic!()
    };
    assert_eq!((speed.lines.len(), contour.lines.len()), (2, 1));
    assert_eq!((speed.limits.len(), &contour.limits[..]), (2, &[50.0][..]));
    // Both layers, one after the other on one path length, and nothing drawn between them.
    let line = &contour.lines[0].1;
    let laid: Vec<_> = line
        .split(|point| point.0.is_nan())
        .filter(|part| !part.is_empty())
        .collect();
    assert_eq!(laid.len(), 2);
    assert!(laid.concat().is_sorted_by(|a, b| a.0 <= b.0));
    assert!(laid[1][0].0 > 353.9, "{:?}", laid[1][0]);
}

#[test]
fn too_slow_a_stretch_is_outside_by_length_and_time() {
    // Of 47.12 mm, 10 mm at 2 mm/s and the rest at 8 mm/s: 5 s and 4.64 s.
    let speed = |s: f64| if (20.0..30.0).contains(&s) { 2.0 } else { 8.0 };
    let judgement = judged(QUARTER, speed, |_| Vector3::zeros()).unwrap();
    let (length, fast) = (15.0 * std::f64::consts::PI, 37.12 / 8.0);
    assert_figures(
        &judgement,
        &[
            ("bead_length_mm", length, 0.02),
            ("length_outside_window_percent", 1000.0 / length, 0.1),
            ("time_outside_window_percent", 500.0 / (5.0 + fast), 0.1),
        ],
    );
    assert!(
        judgement
            .figures
            .iter()
            .any(|f| f.limit.is_some_and(|limit| f.value > limit))
    );
    // No sharp corner, no figure of one.
    assert!(!judgement.figures.iter().any(|f| f.key.contains("corner")));
}

#[test]
fn speed_errors_are_those_against_the_programmed_speed() {
    // Programmed are 16 mm/s: 0.875 % slower and faster, 2 mm each.
    let speed = |s: f64| if s % 4.0 < 2.0 { 15.86 } else { 16.14 };
    let judgement = judged(QUARTER, speed, |_| Vector3::zeros()).unwrap();
    assert_figures(
        &judgement,
        &[
            ("speed_fluctuation_max_percent", 0.875, 0.02),
            ("speed_fluctuation_rms_percent", 0.875, 0.05),
            // Less than a hundredth beyond the edge is not outside.
            ("length_outside_window_percent", 0.0, 0.0),
        ],
    );
}

#[test]
fn the_contour_error_is_the_distance_from_the_nurbs_in_any_direction() {
    let judgement = judged(&leaf(), |_| 9.588, |_| Vector3::z() * 0.03).unwrap();
    assert_figures(
        &judgement,
        &[
            ("contour_error_max_mm", 0.03, 1e-4),
            ("contour_error_rms_mm", 0.03, 1e-4),
        ],
    );
    // Along the curve there is no distance: 0.2 mm ahead on the quarter is only on another place of it.
    let ahead = |s: f64| {
        let angle = |s: f64| ((s - 5.0) / 30.0).clamp(0.0, std::f64::consts::FRAC_PI_2);
        let at = |s: f64| Vector3::new(angle(s).cos(), angle(s).sin(), 0.0) * 30.0;
        if s < 5.0 {
            Vector3::zeros()
        } else {
            at(s + 0.2) - at(s)
        }
    };
    let judgement = judged(QUARTER, |_| 10.0, ahead).unwrap();
    assert_figures(&judgement, &[("contour_error_max_mm", 0.0, 1.5e-3)]);
}

#[test]
fn a_run_without_arc_or_of_another_program_is_no_bead() {
    let machine = machine();
    let program = plan(QUARTER, &machine).unwrap().program;
    let paths: BTreeMap<_, _> = (1..).zip(feed_paths(&program, &machine)).collect();
    let judge = |part: &str, samples: &[RunSample]| {
        let kinematics = machine.motion.kinematics().unwrap();
        let run = Run {
            machine: &machine,
            kinematics: &kinematics,
            paths: &paths,
            samples: &samples.to_vec(),
            evaluation: &Default::default(),
        };
        let directory = shipped("programs");
        let context = PartContext {
            machine: &machine,
            directory: &directory,
            title: "",
        };
        let part: Part = toml::from_str(part).unwrap();
        part.kind().judge(&context, &run).unwrap_err().to_string()
    };
    assert!(judge(QUARTER, &[]).contains("arc never burnt"));
    let sample = RunSample {
        time_us: 0,
        path_id: 1,
        s_mm: 10.0,
        speed_mm_s: 8.0,
        beams: [true, false],
        axes: [0.0; AXES],
        pose: paths[&1].path().at(10.0).unwrap().pose().unwrap(),
    };
    assert!(judge(&leaf(), &[sample]).contains("plan the program anew"));
    assert!(judge(QUARTER, &[sample]).contains("too short a time"));
}
