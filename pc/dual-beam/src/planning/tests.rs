//! Plans of the shipped seams: the program, where the spots are, and what is refused.

use super::*;
use crate::OtherSeam;
use crate::taught::Deviations;
use crate::{read_main_curve, read_other_curve};
use cam::path::Planner;
use nc::{Options, interpret};
use std::path::Path;

fn shipped(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn machine() -> MachineFile {
    MachineFile::read(&shipped("machines/dual-beam-gantry.toml")).unwrap()
}

fn seams() -> (Vec<SeamPoint>, Vec<Vector3<f64>>) {
    let main = read_main_curve(&shipped("programs/t-seam-400-seam1.csv")).unwrap();
    (
        main,
        read_other_curve(&shipped("programs/t-seam-400-seam2.csv")).unwrap(),
    )
}

fn options() -> PlanOptions {
    PlanOptions {
        title: "t-seam-400".into(),
        speed_m_min: 5.0,
        power_w: [2000.0; 2],
        paper: false,
    }
}

#[test]
fn the_shipped_program_is_the_plan_of_the_shipped_seams() {
    let (main, other) = seams();
    let plan = plan_dual_beam(&main, &other, &machine(), &options()).unwrap();
    let text = std::fs::read_to_string(shipped("programs/t-seam-400.ngc")).unwrap();
    assert!(
        text == plan.program,
        "write it anew: seamwright plan programs/t-seam-400.toml"
    );
}

#[test]
fn on_the_planned_path_both_spots_stay_on_their_seams() {
    let (main, other) = seams();
    let machine = machine();
    for paper in [false, true] {
        let options = PlanOptions { paper, ..options() };
        let plan = plan_dual_beam(&main, &other, &machine, &options).unwrap();
        let program = interpret(&plan.program, Options::default()).unwrap();
        let planner = Planner::build(&machine).unwrap();
        let from = machine.planning.park_axes();
        let paths = planner.program(&program, &from, None).unwrap();
        let weld = paths.iter().find(|path| path.weld().is_some()).unwrap();
        let (start, end) = weld.weld().unwrap();
        assert!((end - start - 400.0).abs() < 0.5 && start > 50.0);

        let heads = machine.tracking.as_ref().unwrap().board.heads().unwrap();
        let first: Vec<Vector3<f64>> = main.iter().map(|p| p.position).collect();
        let seams = [
            SmoothSeam::through(&first).unwrap(),
            SmoothSeam::through(&other).unwrap(),
        ];
        let path = weld.path();
        let mut worst: f64 = 0.0;
        for i in 0..=2000 {
            let point = path.at(start + (end - start) * f64::from(i) / 2000.0).unwrap();
            let pose = point.pose().unwrap();
            for (side, seam) in seams.iter().enumerate() {
                let spot = heads.spot(&pose, side).point(0.0, 0.0, point.v_follow()[side]);
                let near = seam.cut(&spot, &pose.tangent, 5.0, None).unwrap();
                worst = worst.max((near.point - spot).norm());
            }
        }
        assert!(worst < 5e-4, "paper {paper}: a spot is {worst} mm off its seam");
        assert!(plan.max_gap < 1e-9);
    }
}

#[test]
fn what_cannot_be_welded_is_refused_with_its_place() {
    let (main, other) = seams();
    let machine = machine();
    let plan = |main: &[SeamPoint], other: &[Vector3<f64>]| {
        plan_dual_beam(main, other, &machine, &options())
            .map(|_| ())
            .unwrap_err()
    };
    let source = |error: PlanError| match error {
        PlanError::Place { source, s, .. } => (source, s),
        other => panic!("{other}"),
    };
    let mirrored: Vec<Vector3<f64>> = main
        .iter()
        .zip(&other)
        .map(|(p, q)| p.position * 2.0 - q)
        .collect();
    assert_eq!(source(plan(&main, &mirrored)), (LocateError::CrossBefore, 0.0));
    let away: Vec<_> = other.iter().map(|q| q + Vector3::y() * 60.0).collect();
    assert_eq!(source(plan(&main, &away)), (LocateError::TooFar, 0.0));
    let (error, s) = source(plan(&main, &other[..60]));
    assert_eq!(error, LocateError::Miss);
    assert!(
        (310.0..325.0).contains(&s),
        "seam 2 ends at 295 mm and goes on for 20 mm, refused at {s}"
    );
    let slow = PlanOptions {
        speed_m_min: 0.0,
        ..options()
    };
    assert!(matches!(
        plan_dual_beam(&main, &other, &machine, &slow),
        Err(PlanError::Option {
            name: "the speed",
            ..
        })
    ));
}

#[test]
fn the_runs_follow_their_formula() {
    let mut machine = machine();
    // 75·(150/500 + 500/10000) + 3 + 2 + 150·(0.01 + 4·0.005 + 12/50 + 0.1)
    let unit = machine.tracking.clone().unwrap();
    let (run_in, run_out) = run_lengths(&machine, &unit);
    assert!((run_in - 86.75).abs() < 1e-9 && run_out == 40.0);
    // Never at full acceleration: 75·2·√(150/2000) + …
    machine.planning.path_jerk_mm_s3 = 2000.0;
    machine.planning.path_acceleration_mm_s2 = 1000.0;
    let (run_in, run_out) = run_lengths(&machine, &unit);
    let speed_up = 150.0 * (150.0_f64 / 2000.0).sqrt();
    assert!((run_out - speed_up).abs() < 1e-9 && (run_in - speed_up - 60.5).abs() < 1e-9);
}

#[test]
fn the_power_of_beam_2_follows_its_speed_on_the_longer_seam() {
    // Feet of a rib that bends in the plane of a flat skin: seam 2 lies outside.
    let arc = |radius: f64| -> Vec<Vector3<f64>> {
        (0..=60)
            .map(|i| {
                let angle = (f64::from(i) - 30.0).to_radians();
                Vector3::new(1500.0 + radius * angle.sin(), 900.0 + radius * angle.cos(), 100.0)
            })
            .collect()
    };
    let plan = |radius_2: f64| {
        let main: Vec<SeamPoint> = arc(400.0)
            .into_iter()
            .map(|position| SeamPoint {
                position,
                normal: Vector3::z(),
            })
            .collect();
        plan_dual_beam(&main, &arc(radius_2), &machine(), &options()).unwrap()
    };
    let powers = |plan: &DualBeamPlan| -> Vec<f64> {
        let blocks = plan
            .program
            .lines()
            .filter_map(|line| line.split_once("M67 E1 Q"));
        blocks.map(|(_, power)| power.parse().unwrap()).collect()
    };
    // 1 % is left alone, 3 % is not.
    assert_eq!(powers(&plan(404.0)), [2000.0]);
    // At its ends a curve through points is straighter than the arc.
    let scaled = powers(&plan(412.0));
    assert!((2..=3).contains(&scaled.len()), "{scaled:?}");
    assert!((scaled[1] / 2000.0 - 1.03).abs() < 0.005, "{scaled:?}");
}

#[test]
fn on_the_pass_of_the_measuring_heads_the_cameras_are_on_both_seams_and_the_beams_off() {
    let (main, other) = seams();
    let machine = machine();
    let plan = plan_dual_beam(&main, &other, &machine, &options()).unwrap();
    let text = plan.measuring_program(&machine, "measuring", 5.0).unwrap();
    assert!(!text.contains("M62") && !text.contains("M67"), "{text}");
    let program = interpret(&text, Options::default()).unwrap();
    let from = machine.planning.park_axes();
    let paths = Planner::build(&machine)
        .unwrap()
        .program(&program, &from, None)
        .unwrap();
    let pass = paths
        .iter()
        .max_by(|a, b| a.length_mm().total_cmp(&b.length_mm()))
        .unwrap();
    let heads = machine.tracking.as_ref().unwrap().board.heads().unwrap();
    let first: Vec<Vector3<f64>> = main.iter().map(|p| p.position).collect();
    let seams = [
        SmoothSeam::through(&first).unwrap(),
        SmoothSeam::through(&other).unwrap(),
    ];
    let path = pass.knot_path();
    let (begin, end) = (path.start_s().unwrap(), path.end_s().unwrap());
    let lead = heads.camera_lead();
    // The whole seam passes below the cameras.
    let seen = |s: f64| {
        let pose = path.at(s).unwrap().pose().unwrap();
        pose.position + pose.tangent * lead
    };
    let [start, finish] = [plan.points[plan.seam.0], plan.points[plan.seam.1]];
    assert!((seen(begin) - start.pose.position).dot(&start.pose.tangent) < 0.0);
    assert!((seen(end) - finish.pose.position).dot(&finish.pose.tangent) > 0.0);
    let mut worst: f64 = 0.0;
    for i in 0..=1000 {
        let point = path.at(begin + (end - begin) * f64::from(i) / 1000.0).unwrap();
        let pose = point.pose().unwrap();
        for (side, seam) in seams.iter().enumerate() {
            let camera = heads.spot(&pose, side).point(lead, 0.0, point.v_follow()[side]);
            let Ok(near) = seam.cut(&camera, &pose.tangent, 5.0, None) else {
                continue;
            };
            worst = worst.max((near.point - camera).norm());
        }
    }
    assert!(worst < 0.01, "a camera is {worst} mm off its seam");
}

/// Of taught seams that begin and end at plates, each beam is on from the first to the last point of its own seam, wherever the other one is.
#[test]
fn beams_go_on_and_off_where_their_taught_seams_begin_and_end() {
    let machine = machine();
    let along = |y: f64, [from, to]: [f64; 2]| -> Vec<Vector3<f64>> {
        let point = |i: i32| Vector3::new(900.0 + from + (to - from) * f64::from(i) / 12.0, y, 100.0);
        (0..=12).map(point).collect()
    };
    let lead = machine.tracking.as_ref().unwrap().board.head.camera_lead_mm;
    for (second, marked) in [
        ([0.6, 119.2], [true; 4]),
        ([-0.7, 120.9], [true; 4]),
        ([0.6, 120.9], [false, true, true, false]),
        ([0.004, 119.2], [false, false, false, true]),
        ([0.6, 119.2], [false; 4]),
    ] {
        let first = along(898.0, [0.0, 120.0]);
        let normal = Vector3::z();
        let seams = TaughtSeams {
            main: first
                .into_iter()
                .map(|position| SeamPoint { position, normal })
                .collect(),
            other: along(902.0, second),
            fit: [Deviations {
                largest_mm: 0.0,
                line: 0,
                rms_mm: 0.0,
            }; 2],
            marked: Marked {
                begins: [marked[0], marked[1]],
                ends: [marked[2], marked[3]],
            },
        };
        let plan = plan_taught(&seams, &machine, &options()).unwrap();
        let x = |index: usize| plan.points[index].pose.position.x - 900.0;
        let own = |is_marked: bool, place: f64, other: f64| if is_marked { place } else { other };
        let wanted = [
            [0.0, 120.0],
            [own(marked[1], second[0], 0.0), own(marked[3], second[1], 120.0)],
        ];
        for (beam, [on, off]) in wanted.into_iter().enumerate() {
            let (begin, end) = plan.beams[beam];
            assert!(
                (x(begin) - on).abs() < 0.011,
                "{marked:?} {second:?}: {}",
                x(begin)
            );
            assert!((x(end) - off).abs() < 0.011, "{marked:?} {second:?}: {}", x(end));
        }
        let (begin, end) = plan.seam;
        assert!(x(begin) == x(plan.beams[0].0).min(x(plan.beams[1].0)));
        assert!(x(end) == x(plan.beams[0].1).max(x(plan.beams[1].1)));
        // The outputs are switched in this order, where the program is there.
        let words: Vec<&str> = plan.program.lines().filter(|line| line.contains("M6")).collect();
        let count = |word: &str| words.iter().filter(|line| line.contains(word)).count();
        for word in ["M62 P0", "M62 P1", "M63 P0", "M63 P1", "M62 P2", "M63 P2"] {
            assert_eq!(count(word), 1, "{word}: {words:?}");
        }
        // Nothing is to be tracked before the cameras have seen what begins.
        let tracks = x(plan.tracking);
        if marked[0] || marked[1] {
            let begins = own(marked[1], second[0], 0.0).max(own(marked[0], 0.0, f64::MIN));
            assert!((tracks - (begins - lead + 4.5)).abs() < 0.011, "{tracks}");
        } else {
            assert!(tracks < -lead, "{tracks}");
        }
        // What the file says is what the machine does.
        let program = interpret(&plan.program, Options::default()).unwrap();
        let from = machine.planning.park_axes();
        let paths = Planner::build(&machine)
            .unwrap()
            .program(&program, &from, None)
            .unwrap();
        let weld = paths.iter().find_map(|path| path.weld()).unwrap();
        assert!((weld.1 - weld.0 - (x(end) - x(begin))).abs() < 0.001, "{weld:?}");
    }
}
