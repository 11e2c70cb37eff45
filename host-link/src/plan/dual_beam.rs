//! Plans a weld of both feet of a rib with the rigid dual-beam head (SPEC 0.5, 0.6).
//!
//! Seam 1 is divided until its chords are fine enough; at each point the head is located on both seams; the
//! path begins and ends with a straight run along the end tangents, with the attitude of the end.

use super::beams::slide_extension;
use super::cut::SmoothSeam;
use super::locate::{LocateError, Location, SeamPlace, locate, locate_symmetric};
use super::text::{NcText, decimal, tip_words};
use crate::curve::Curve;
use crate::machine::MachineFile;
use crate::seam::SeamPoint;
use nalgebra::Vector3;
use shared::geometry::{Pose, PoseError, SplineError, angle};
use shared::kinematics::KinematicsError;
use shared::parameter::ParameterError;
use shared::units::DEG_PER_RAD;
use thiserror::Error;

/// Largest chord \[mm\], distance of the curve from it \[mm\] and turn over it \[rad\].
const MAX_CHORD: f64 = 8.0;
const CHORD_TOLERANCE: f64 = 0.02;
const MAX_TURN: f64 = 0.03;
/// Shortest piece of seam 1 that is divided \[mm\].
const SHORTEST: f64 = 0.01;
/// Spacing of the points on the runs before and after the seam \[mm\].
const RUN_SPACING: f64 = 8.0;
/// Shortest run before and after the seam \[mm\].
const SHORTEST_RUN: f64 = 40.0;
/// Speed for which the runs are long enough: the fastest the measuring unit allows, 9 m/min \[mm/s\].
const RUN_SPEED: f64 = 150.0;
/// Time the slides get to settle once they are on the seam, before the beams go on \[s\].
const SETTLE: f64 = 0.1;
/// Frames before an estimate counts.
const FRAMES: f64 = 4.0;
/// Seam 2 must lie this near seam 1 \[mm\].
const GAP_MAX: f64 = 40.0;
/// Least height of the safe plane above the tip \[mm\].
const CLEARANCE: f64 = 20.0;

/// Choices of the planner.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOptions {
    /// Name of the job, for the comments of the program.
    pub title: String,
    /// Speed of the tip \[m/min\].
    pub speed_m_min: f64,
    /// Power of beam 1 and 2 \[W\].
    pub power_w: [f64; 2],
    /// Use the plane across seam 1 as the paper does, instead of the one that lies evenly across both.
    pub paper: bool,
}

/// A planned point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedPoint {
    /// The head.
    pub pose: Pose,
    /// Extension of V1 and V2 that keeps the defocus \[mm\].
    pub extension: [f64; 2],
}

/// A planned weld.
#[derive(Clone, Debug, PartialEq)]
pub struct DualBeamPlan {
    /// All points: run-in, seam, run-out.
    pub points: Vec<PlannedPoint>,
    /// Index of the point where tracking goes on.
    pub tracking: usize,
    /// Index of the points where the seam begins and ends.
    pub seam: (usize, usize),
    /// Largest distance of the two beam axes \[mm\].
    pub max_gap: f64,
    /// Largest |speed on seam 2 / speed on seam 1 − 1|.
    pub max_speed_difference: f64,
    /// The NC program.
    pub program: String,
}

/// Why there is no plan. Reads as one sentence.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlanError {
    /// No smooth curve.
    #[error("no smooth curve through the points of seam {seam}: {source}")]
    Curve {
        /// 1 or 2.
        seam: u8,
        /// Why.
        source: SplineError,
    },
    /// A point of seam 1 has no pose.
    #[error("at {s:.1} mm of seam 1 (X{x:.3} Y{y:.3} Z{z:.3}): {source}")]
    Place {
        /// Length along seam 1 \[mm\].
        s: f64,
        /// Place \[mm\].
        x: f64,
        /// Place \[mm\].
        y: f64,
        /// Place \[mm\].
        z: f64,
        /// Why.
        source: LocateError,
    },
    /// The pose is none.
    #[error("at {s:.1} mm of seam 1 the head has no pose: {source}")]
    Pose {
        /// Length along seam 1 \[mm\].
        s: f64,
        /// Why.
        source: PoseError,
    },
    /// The machine cannot take the pose.
    #[error("the machine cannot take a pose of the path: {0}")]
    Kinematics(#[from] KinematicsError),
    /// A machine parameter makes no sense.
    #[error("the machine file cannot be used: {0}")]
    Parameter(#[from] ParameterError),
    /// An option makes no sense.
    #[error("{name} is {value}, but must be above 0")]
    Option {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The safe height is too low.
    #[error(
        "the safe height of {safe_mm:.1} mm is less than {CLEARANCE} mm above the weld, which reaches {top_mm:.1} mm"
    )]
    SafeHeight {
        /// Safe height \[mm\].
        safe_mm: f64,
        /// Highest tip of the path \[mm\].
        top_mm: f64,
    },
}

/// Plans the weld of seam `main`, with skin normals, and seam `other`, both in the direction of travel.
pub fn plan_dual_beam(
    main: &[SeamPoint],
    other: &[Vector3<f64>],
    machine: &MachineFile,
    options: &PlanOptions,
) -> Result<DualBeamPlan, PlanError> {
    let options_above_zero = [
        ("the speed", options.speed_m_min),
        ("the power of beam 1", options.power_w[0]),
        ("the power of beam 2", options.power_w[1]),
    ];
    for (name, value) in options_above_zero {
        if !(value.is_finite() && value > 0.0) {
            return Err(PlanError::Option { name, value });
        }
    }
    let rows: Vec<[f64; 6]> = main
        .iter()
        .map(|p| std::array::from_fn(|i| if i < 3 { p.position[i] } else { p.normal[i - 3] }))
        .collect();
    let first = Curve::by_length(&rows).map_err(|source| PlanError::Curve { seam: 1, source })?;
    let second = SmoothSeam::through(other).map_err(|source| PlanError::Curve { seam: 2, source })?;

    let head = &machine.tracker.head;
    let mut weld = Vec::new();
    let mut max_gap: f64 = 0.0;
    let mut sigma: Option<(f64, f64)> = None;
    let mut max_speed_difference: f64 = 0.0;
    for s in divide(&first) {
        let (place, at) = locate_at(
            &first,
            &second,
            s,
            machine,
            options.paper,
            sigma.map(|(_, sigma2)| sigma2),
        )?;
        max_gap = max_gap.max(at.gap);
        if let Some((s_prev, sigma_prev)) = sigma {
            let ratio = (at.sigma2 - sigma_prev).abs() / (s - s_prev);
            max_speed_difference = max_speed_difference.max((ratio - 1.0).abs());
        }
        sigma = Some((s, at.sigma2));
        if at.distance.iter().any(|distance| *distance < 0.0) {
            return Err(refused(&place, s, LocateError::CrossBefore));
        }
        let pose =
            Pose::new(at.tip, at.tangent, at.normal).map_err(|source| PlanError::Pose { s, source })?;
        weld.push(PlannedPoint {
            pose,
            extension: std::array::from_fn(|k| slide_extension(head.working_distance_mm[k], at.distance[k])),
        });
    }

    let (run_in, run_out) = run_lengths(machine);
    let start = weld[0];
    let end = weld[weld.len() - 1];
    let in_steps = steps(run_in);
    let out_steps = steps(run_out);
    let mut points: Vec<PlannedPoint> = (0..in_steps)
        .map(|i| moved(&start, -run_in * (in_steps - i) as f64 / in_steps as f64))
        .collect();
    let seam = (points.len(), points.len() + weld.len() - 1);
    points.extend(weld);
    points.extend((1..=out_steps).map(|i| moved(&end, run_out * i as f64 / out_steps as f64)));

    // The map of the seam begins where the camera saw it first.
    let tracking = &machine.tracker.tracking;
    let seen = head.camera_lead_mm + tracking.window_mm;
    let step = run_in / in_steps as f64;
    let mut plan = DualBeamPlan {
        points,
        tracking: ((seen / step).ceil() as usize).min(seam.0),
        seam,
        max_gap,
        max_speed_difference,
        program: String::new(),
    };
    plan.program = plan.write(machine, options)?;
    Ok(plan)
}

fn refused(place: &SeamPlace, s: f64, source: LocateError) -> PlanError {
    let [x, y, z] = place.point.into();
    PlanError::Place { s, x, y, z, source }
}

/// The head at length `s` of seam 1: its mean axis stands on the skin normal.
fn locate_at(
    first: &Curve<6>,
    second: &SmoothSeam,
    s: f64,
    machine: &MachineFile,
    paper: bool,
    sigma_prev: Option<f64>,
) -> Result<(SeamPlace, Location), PlanError> {
    let [value, slope, _] = first.at(s);
    let place = SeamPlace {
        point: Vector3::new(value[0], value[1], value[2]),
        tangent: Vector3::new(slope[0], slope[1], slope[2]),
        normal: Vector3::new(value[3], value[4], value[5]),
    };
    let theta2 = machine.tracker.head.included_angle_deg / DEG_PER_RAD;
    let theta1 = -theta2 / 2.0;
    let located = if paper {
        locate(&place, second, theta1, theta2, GAP_MAX, sigma_prev, None)
    } else {
        locate_symmetric(&place, second, theta1, theta2, GAP_MAX, sigma_prev)
    };
    match located {
        Ok(at) => Ok((place, at)),
        Err(source) => Err(refused(&place, s, source)),
    }
}

/// Lengths of seam 1 at which the head is located: pieces are halved until chord, turn and distance from the
/// chord are small enough (SPEC 3.6).
fn divide(curve: &Curve<6>) -> Vec<f64> {
    let position = |s: f64| {
        let [value, slope, _] = curve.at(s);
        let vector = |c: [f64; 6]| Vector3::new(c[0], c[1], c[2]);
        (vector(value), vector(slope))
    };
    let fine = |x: f64, y: f64| {
        let ((a, ta), (b, tb)) = (position(x), position(y));
        let chord = b - a;
        let off = |part: f64| {
            let p = position(x + (y - x) * part).0 - a;
            let along = (p.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
            (p - chord * along).norm()
        };
        chord.norm() <= MAX_CHORD
            && angle(&ta, &tb) <= MAX_TURN
            && [0.25, 0.5, 0.75]
                .into_iter()
                .all(|part| off(part) <= CHORD_TOLERANCE)
    };
    let mut places = vec![0.0];
    let mut open = vec![(0.0, curve.end())];
    while let Some((x, y)) = open.pop() {
        if y - x <= SHORTEST || fine(x, y) {
            places.push(y);
        } else {
            let middle = (x + y) / 2.0;
            open.push((middle, y));
            open.push((x, middle));
        }
    }
    places
}

/// Lengths of the straight runs before and after the seam \[mm\]: at 9 m/min the tip reaches its speed,
/// v/2·(v/a + a/j), the map of the seam fills, w + hold + v·(T_p + 4 T_f), and the slides cross half their
/// travel and settle, v·(travel/2/v_slide + 0.1 s); after the seam it only stops. Both are at least 40 mm.
fn run_lengths(machine: &MachineFile) -> (f64, f64) {
    let (v, a, j) = (
        RUN_SPEED,
        machine.planning.path_acceleration_mm_s2,
        machine.planning.path_jerk_mm_s3,
    );
    // Without constant acceleration in between if a is never reached.
    let time = if v * j > a * a {
        v / a + a / j
    } else {
        2.0 * libm::sqrt(v / j)
    };
    let speed_up = v / 2.0 * time;
    let tracking = &machine.tracker.tracking;
    let frame = f64::from(tracking.frame_period_ms) / 1000.0;
    let reach = machine
        .tracker
        .slides
        .iter()
        .map(|slide| (slide.travel_max_mm - slide.travel_min_mm) / 2.0 / slide.max_velocity_mm_s)
        .fold(0.0, f64::max);
    let wait = machine.cameras.processing_ms / 1000.0 + FRAMES * frame + reach + SETTLE;
    let lock = tracking.window_mm + tracking.hold_mm + v * wait;
    ((speed_up + lock).max(SHORTEST_RUN), speed_up.max(SHORTEST_RUN))
}

fn steps(length: f64) -> usize {
    (length / RUN_SPACING).ceil() as usize
}

/// `point` moved along its tangent.
fn moved(point: &PlannedPoint, along: f64) -> PlannedPoint {
    PlannedPoint {
        pose: Pose {
            position: point.pose.position + point.pose.tangent * along,
            ..point.pose
        },
        ..*point
    }
}

impl DualBeamPlan {
    fn write(&self, machine: &MachineFile, options: &PlanOptions) -> Result<String, PlanError> {
        let kinematics = machine.motion.kinematics.build()?;
        let words = |point: &PlannedPoint| -> Result<(Vector3<f64>, [f64; 3], String), PlanError> {
            let q = kinematics.inverse(&point.pose)?;
            let angles = [q[3], q[4], q[5]].map(|a| a * DEG_PER_RAD);
            let position = point.pose.position;
            let text = tip_words(&position.into(), &angles, &point.extension);
            Ok((position, angles, text))
        };
        let safe = machine.planning.safe_height_mm;
        let top = self
            .points
            .iter()
            .map(|p| p.pose.position.z)
            .fold(f64::NEG_INFINITY, f64::max);
        if safe < top + CLEARANCE {
            let (safe_mm, top_mm) = (safe, top);
            return Err(PlanError::SafeHeight { safe_mm, top_mm });
        }
        let start = &self.points[0];
        let (position, angles, _) = words(start)?;
        let above = tip_words(&[position.x, position.y, safe], &angles, &start.extension);

        let mut nc = NcText::default();
        nc.line("%");
        nc.comment(&options.title);
        nc.comment(&format!(
            "machine {}, {} m/min",
            machine.name, options.speed_m_min
        ));
        nc.comment("X Y Z: tip [mm], A B C: head [deg], V1 V2: slides that keep the defocus [mm]");
        nc.block("G21 G17 G90 G94 G40 G54 G64");
        nc.block("G43.4");
        nc.comment("approach");
        nc.block(&format!("G0 {above}"));
        nc.block(&format!("G0 Z{}", decimal(position.z, 5)));
        nc.block(&format!("M67 E0 Q{}", decimal(options.power_w[0], 1)));
        nc.block(&format!("M67 E1 Q{}", decimal(options.power_w[1], 1)));
        nc.comment("run-in");
        nc.block(&format!("F{}", decimal(options.speed_m_min * 1000.0, 1)));
        for (index, point) in self.points.iter().enumerate().skip(1) {
            // Outputs change at the start of the motion that leaves the point before.
            let left = index - 1;
            if left == self.tracking {
                nc.block("M62 P2");
            }
            if left == self.seam.0 {
                nc.comment("seam");
                nc.block("M62 P0");
                nc.block("M62 P1");
            }
            if left == self.seam.1 {
                nc.comment("run-out");
                nc.block("M63 P0");
                nc.block("M63 P1");
            }
            // The slides stay on the seam until the beams are surely off.
            if left == self.seam.1 + 1 {
                nc.block("M63 P2");
            }
            nc.block(&format!("G1 {}", words(point)?.2));
        }
        nc.comment("retract");
        nc.block(&format!("G0 Z{}", decimal(safe, 5)));
        nc.block("M2");
        nc.line("%");
        Ok(nc.finish())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::{Options, interpret};
    use crate::path::Planner;
    use crate::plan::OtherSeam;
    use crate::seam::{read_main_curve, read_other_curve};
    use std::path::Path;

    fn shipped(name: &str) -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
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
        assert!(text == plan.program, "write it anew: host-link plan dual-beam");
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
            let from = planner.tip(&machine.planning.park.to_array());
            let paths = planner.program(&program, &from, None).unwrap();
            let weld = paths.iter().find(|path| path.weld().is_some()).unwrap();
            let (start, end) = weld.weld().unwrap();
            assert!((end - start - 400.0).abs() < 0.5 && start > 50.0);

            let heads = machine.tracker.head.build().unwrap();
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
        let (run_in, run_out) = run_lengths(&machine);
        assert!((run_in - 86.75).abs() < 1e-9 && run_out == 40.0);
        // Never at full acceleration: 75·2·√(150/2000) + …
        machine.planning.path_jerk_mm_s3 = 2000.0;
        machine.planning.path_acceleration_mm_s2 = 1000.0;
        let (run_in, run_out) = run_lengths(&machine);
        let speed_up = 150.0 * (150.0_f64 / 2000.0).sqrt();
        assert!((run_out - speed_up).abs() < 1e-9 && (run_in - speed_up - 60.5).abs() < 1e-9);
    }
}
