//! Saddles by taught points: what a fit finds, and what it refuses.

use super::*;
use crate::saddle::fit::{Fit, fit};
use crate::saddle::least_squares::{Values, height};
use nalgebra::Vector3;
use shared::io::AXES;
use shared::units::wrap;
use vision::render::SplitMix64;

/// Where the machine of these tests is clamped.
const CLAMPED: Placement = Placement {
    turn: 0.35,
    lift: 12.0,
};

/// Points of a seam at `waists` \[°\] as an operator would teach them: each axis off by `noise` \[mm\], the waist by
/// as much at the tip, the tilt by some degrees from the bisector, which does not matter.
fn joints(seam: &Seam, waists: &[f64], noise: f64, seed: u64) -> Vec<[f64; 4]> {
    let mut source = SplitMix64::new(seed);
    let torch = 60.0;
    waists
        .iter()
        .map(|waist| {
            let length = seam.length_at(waist.to_radians()).unwrap();
            let station = seam
                .at_length(length, &Offset::default(), waist.to_radians())
                .unwrap();
            let tilt = station.tilt + 0.1 * source.gauss()[0];
            let mut off = || noise * source.gauss()[0];
            let (x, z, along) = (off(), off(), off());
            [
                station.tip.xy().norm() + torch * tilt.cos() + x,
                station.tip.z + torch * tilt.sin() + z,
                tilt.to_degrees(),
                (station.waist + along / 40.0).to_degrees(),
            ]
        })
        .collect()
}

/// Their tips by the kinematics of the machine.
fn tips(joints: &[[f64; 4]]) -> Vec<Vector3<f64>> {
    let kinematics = machine().motion.kinematics().unwrap();
    let tip = |joints: &[f64; 4]| {
        let [x, z, b, c] = *joints;
        let axes: [f64; AXES] = [x, 0.0, z, 0.0, b.to_radians(), c.to_radians()];
        kinematics.forward(&axes).position
    };
    joints.iter().map(tip).collect()
}

fn all_around(count: u32) -> Vec<f64> {
    (0..count)
        .map(|i| f64::from(i) * 360.0 / f64::from(count))
        .collect()
}

/// Largest distance of the fitted seam from the true one \[mm\].
fn apart(fit: &Fit, truth: &Seam) -> f64 {
    let pair = PipePair::new(fit.main_radius, fit.branch_radius, fit.angle, fit.offset).unwrap();
    let found = Seam::new(pair, fit.offset, fit.placement).unwrap();
    (0..180)
        .map(|i| {
            let s = truth.length() * f64::from(i) / 180.0;
            let tip = truth.at_length(s, &Offset::default(), 0.0).unwrap().tip;
            (found.nearest(&tip, &Offset::default()).unwrap().tip - tip).norm()
        })
        .fold(0.0, f64::max)
}

fn known(main: bool, branch: bool, angle: bool, offset: bool) -> Known {
    Known {
        main_radius: main.then_some(160.0),
        branch_radius: branch.then_some(40.0),
        angle: angle.then_some(85f64.to_radians()),
        offset: offset.then_some(10.0),
    }
}

#[test]
fn the_height_changes_with_every_unknown_as_its_gradient_says() {
    // z₀, θ₀, δ, β, R, r of an oblique pair.
    let values = Values::from([12.0, 0.35, 20.0, 1.1, 160.0, 70.0]);
    for i in 0..24 {
        let waist = 0.1 + f64::from(i) * 0.26;
        let here = height(&values, waist).unwrap();
        for unknown in 0..6 {
            let step = Values::from_fn(|row, _| if row == unknown { 1e-5 } else { 0.0 });
            let [after, before] = [step, -step].map(|step| height(&(values + step), waist).unwrap().value);
            let slope = (after - before) / 2e-5;
            assert!(
                (here.gradient[unknown] - slope).abs() < 1e-6,
                "{unknown}: {} {slope}",
                here.gradient[unknown]
            );
        }
    }
}

#[test]
fn exact_points_give_the_exact_dimensions_by_as_few_points_as_there_are_unknowns() {
    let truth = prototype(CLAMPED);
    let cases = [
        (3, known(true, true, true, true)),
        (3, known(true, false, true, true)),
        (4, known(true, true, false, true)),
        (4, known(true, true, true, false)),
        (5, known(true, false, false, false)),
        (6, known(false, true, false, false)),
        (7, Known::default()),
    ];
    for (count, known) in cases {
        let points = tips(&joints(&truth, &all_around(count), 0.0, 1));
        let fit = fit(&points, &known).unwrap();
        let seen = [
            fit.main_radius - 160.0,
            fit.branch_radius - 40.0,
            fit.angle.to_degrees() - 85.0,
            fit.offset - 10.0,
            wrap(fit.placement.turn - CLAMPED.turn),
            fit.placement.lift - CLAMPED.lift,
        ];
        for error in seen {
            assert!(error.abs() < 1e-6, "{count} points: {seen:?}");
        }
    }
}

#[test]
fn sixteen_points_off_by_a_twentieth_give_the_seam_to_a_twentieth() {
    let truth = prototype(CLAMPED);
    let mut worst = [0.0_f64; 5];
    let mut unsure = 0;
    for seed in 0..40 {
        let points = tips(&joints(&truth, &all_around(16), 0.05, seed));
        let fit = fit(&points, &known(true, true, false, false)).unwrap();
        let errors = [
            apart(&fit, &truth),
            (fit.offset - 10.0).abs(),
            (fit.angle.to_degrees() - 85.0).abs(),
            wrap(fit.placement.turn - CLAMPED.turn).abs().to_degrees(),
            (fit.placement.lift - CLAMPED.lift).abs(),
        ];
        worst = std::array::from_fn(|i| worst[i].max(errors[i]));
        unsure += usize::from((fit.offset - 10.0).abs() > fit.sure[2]);
    }
    println!(
        "16 points, 0.05 mm each axis, worst of 40: seam {:.3} mm, offset {:.3} mm, angle {:.3}°, turn {:.3}°, lift {:.3} mm; offset outside its bounds {unsure} times",
        worst[0], worst[1], worst[2], worst[3], worst[4]
    );
    assert!(worst[0] < 0.08, "{worst:?}");
    assert!(
        worst[1] < 0.6 && worst[2] < 0.2 && worst[3] < 1.5 && worst[4] < 0.06,
        "{worst:?}"
    );
    // Two standard deviations: one in twenty may be outside.
    assert!(unsure <= 6, "{unsure}");
}

#[test]
fn points_that_hold_no_saddle_are_refused_with_the_reason() {
    let truth = prototype(CLAMPED);
    let refusal = |waists: &[f64], known: &Known| {
        let points = tips(&joints(&truth, waists, 0.0, 1));
        fit(&points, known)
            .and_then(|fit| fit.check_sure(0.5))
            .unwrap_err()
            .to_string()
    };
    let all = known(true, true, true, true);
    let error = refusal(&[0.0, 90.0], &all);
    assert!(
        error.starts_with("2 taught points, but 3 are needed at least to find the place of the machine"),
        "{error}"
    );
    let error = refusal(&all_around(4), &known(true, true, false, false));
    assert!(
        error.contains("4 taught points, but 5 are needed") && error.contains("offset_mm and angle_deg"),
        "{error}"
    );
    let error = refusal(&[10.0, 11.0, 12.0, 13.0], &all);
    assert!(
        error.starts_with("the taught points are all at one place"),
        "{error}"
    );
    let error = refusal(&[10.0, 12.0, 15.0, 18.0], &all);
    assert!(error.starts_with("the taught points lie on a line"), "{error}");
    let error = refusal(
        &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0],
        &known(true, true, false, false),
    );
    assert!(
        error.starts_with("the taught points leave the seam open by"),
        "{error}"
    );
    println!("{error}");
    // Up a line of the branch.
    let line: Vec<_> = (0..5)
        .map(|i| Vector3::new(40.0, 0.0, 160.0 + f64::from(i)))
        .collect();
    assert!(fit(&line, &all).unwrap_err().to_string().contains("line"));
}

fn table(joints: &[[f64; 4]]) -> String {
    let rows = joints
        .iter()
        .map(|[x, z, b, c]| format!("{x:.4},{z:.4},{b:.4},{c:.4}\n"));
    format!("X_mm,Z_mm,B_deg,C_deg\n{}", rows.collect::<String>())
}

/// The shipped part with offset and angle to be found from the points in `file`.
fn part_with(file: &Path) -> String {
    text()
        .replace("angle_deg = 85.0", &format!("taught = {:?}", file))
        .replace("offset_mm = 10.0", "")
}

#[test]
fn a_seam_from_taught_points_is_planned_where_the_pipes_truly_are() {
    let truth = prototype(CLAMPED);
    let points = written(&table(&joints(&truth, &all_around(16), 0.05, 5)));
    let plan = plan_text(&part_with(points.path()), &machine()).unwrap();
    let notes = plan.notes.join("\n");
    assert!(notes.starts_with("16 taught points lie within 0."), "{notes}");
    assert!(
        notes.contains("main pipe 320.000 mm as given") && notes.contains("offset "),
        "{notes}"
    );
    let paths = planned::paths(&plan.program, &machine());
    let root = paths.values().find(|path| path.weld().is_some()).unwrap();
    let (start, end) = root.weld().unwrap();
    let path = root.path();
    let furthest = (0..=200)
        .map(|i| {
            let s = start + (end - start) * f64::from(i) / 200.0;
            let pose = path.at(s).unwrap().pose().unwrap();
            truth.deviation(&pose, &Offset::default()).unwrap().distance
        })
        .fold(0.0, f64::max);
    println!("weld from taught points: {furthest:.3} mm from the true seam");
    assert!(furthest < 0.1, "{furthest}");
}

#[test]
fn the_shipped_points_tell_where_the_machine_is_clamped() {
    // As programs/saddle-taught.csv was made.
    let taught = joints(&prototype(CLAMPED), &all_around(16), 0.05, 16);
    let points = std::fs::read_to_string(shipped("programs/saddle-taught.csv")).unwrap();
    assert_eq!(points, table(&taught));
    let part = PartFile::read(&shipped("programs/saddle-taught.toml")).unwrap();
    let plan = part.plan(&machine(), "saddle-taught").unwrap();
    let notes = plan.notes.join("\n");
    println!("{notes}");
    assert!(
        notes.contains("main pipe 320.000 mm as given, branch 80.000 mm as given"),
        "{notes}"
    );
}

#[test]
fn a_point_that_is_off_is_named_with_its_line() {
    let mut taught = joints(&prototype(CLAMPED), &all_around(16), 0.05, 3);
    taught[6][1] += 2.0;
    let points = written(&table(&taught));
    let error = plan_text(&part_with(points.path()), &machine()).unwrap_err();
    assert!(error.starts_with("line 8: this taught point is 1."), "{error}");
    // With as few points as there can be, too: the one that is off is reported before what it leaves open.
    let mut few = joints(&prototype(CLAMPED), &all_around(5), 0.0, 3);
    few[2][0] += 3.0;
    let points = written(&table(&few));
    let error = plan_text(&part_with(points.path()), &machine()).unwrap_err();
    assert!(error.starts_with("line 4: this taught point"), "{error}");
    let points = written("X,Z\n1,2\n");
    let error = plan_text(&part_with(points.path()), &machine()).unwrap_err();
    assert!(
        error.contains("the header must be X_mm,Z_mm,B_deg,C_deg"),
        "{error}"
    );
}
