//! Plans a weld of both feet of a rib with the rigid dual-beam head (mathematics 0.5, 0.6).
//!
//! Seam 1 is divided until its chords are fine enough; at each point the head is located on both seams; the
//! path begins and ends with a straight run along the end tangents, with the attitude of the end. Where it was taught what a seam
//! begins or ends with, its beam goes on and off there.

mod ends;
mod program;
#[cfg(test)]
mod tests;

use crate::SeamPoint;
use crate::beams::slide_extension;
use crate::cut::SmoothSeam;
use crate::locate::{LocateError, Location, SeamPlace, locate, locate_symmetric};
use crate::taught::{Marked, TaughtSeams};
use cam::curve::Curve;
use cam::path::CAPACITY;
use config::machine::{MachineFile, TrackingUnit};
use curves::SplineError;
use ends::Places;
use nalgebra::Vector3;
use shared::config::HeadConfig;
use shared::geometry::{Pose, PoseError, angle};
use shared::kinematics::KinematicsError;
use shared::parameter::ParameterError;
use shared::units::DEG_PER_RAD;
use teach::seam::{Drawing, MachinePose};
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
    /// Speed on seam 2 over speed on seam 1 on the way here (mathematics 0.5).
    pub speed_ratio: f64,
}

/// A planned weld.
#[derive(Clone, Debug, PartialEq)]
pub struct DualBeamPlan {
    /// All points: run-in, seam, run-out.
    pub points: Vec<PlannedPoint>,
    /// Index of the point where tracking goes on.
    pub tracking: usize,
    /// Index of the points where the seam begins and ends: where the first beam goes on and the last one off.
    pub seam: (usize, usize),
    /// Index of the points where each beam goes on and off: the same unless it is taught where each seam begins and ends.
    pub beams: [(usize, usize); 2],
    /// Largest distance of the two beam axes \[mm\].
    pub max_gap: f64,
    /// Largest |speed on seam 2 / speed on seam 1 − 1|.
    pub max_speed_difference: f64,
    /// The NC program.
    pub program: String,
}

impl DualBeamPlan {
    /// What a lesson has to know of the drawing.
    pub fn drawing(&self) -> Drawing {
        let weld = &self.points[self.seam.0..=self.seam.1];
        let place = |i: usize| (weld[i].pose.position, weld[i].pose.tangent);
        let chords = weld
            .windows(2)
            .map(|pair| (pair[1].pose.position - pair[0].pose.position).norm());
        Drawing {
            begin: place(0),
            end: place(weld.len() - 1),
            length_mm: chords.sum(),
        }
    }

    /// The stance in which cameras that look `lead_mm` ahead see the beginning of the weld.
    pub fn stance_before(&self, lead_mm: f64) -> MachinePose {
        let first = self.points[self.seam.0];
        let pose = first.pose;
        MachinePose {
            pose: Pose {
                position: pose.position - pose.tangent * lead_mm,
                ..pose
            },
            slides_mm: [0.0, first.extension[0], 0.0, first.extension[1]],
        }
    }
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
    /// The pose is not valid.
    #[error("at {s:.1} mm of seam 1 no pose of the head is possible: {source}")]
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
    /// The machine has no head, slides, tracking and cameras.
    #[error(
        "the machine file has no tables head, slides, tracking and cameras: it has no second beam to plan for"
    )]
    NoTracking,
    /// More points than a path has.
    #[error(
        "seam 1 takes more than {CAPACITY} points up to {s:.1} of its {length:.1} mm: it is too long, or bends too often \
         for one path; look for a point that is not on it"
    )]
    TooManyPoints {
        /// Length along seam 1 \[mm\].
        s: f64,
        /// All of it \[mm\].
        length: f64,
    },
    /// Runs before and after the seam that are longer than a path.
    #[error(
        "the machine takes {run_mm:.0} mm to speed up and to find the seam; a path of {CAPACITY} points is too short for \
         that: correct planning, tracking and slides of the machine file"
    )]
    LongRun {
        /// How long \[mm\].
        run_mm: f64,
    },
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
    plan(main, other, Marked::default(), machine, options)
}

/// Plans the weld of taught seams. Where one was seen to begin or to end, its beam goes on or off there, and tracking goes on once
/// the cameras have seen what begins.
pub fn plan_taught(
    seams: &TaughtSeams,
    machine: &MachineFile,
    options: &PlanOptions,
) -> Result<DualBeamPlan, PlanError> {
    plan(&seams.main, &seams.other, seams.marked, machine, options)
}

fn plan(
    main: &[SeamPoint],
    other: &[Vector3<f64>],
    marked: Marked,
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

    let unit = machine.tracking.as_ref().ok_or(PlanError::NoTracking)?;
    let head = &unit.board.head;
    let mut weld = Vec::new();
    let mut max_gap: f64 = 0.0;
    let mut sigma: Option<(f64, f64)> = None;
    let mut max_speed_difference: f64 = 0.0;
    let locate = |s: f64, sigma: Option<f64>| locate_at(&first, &second, s, head, options.paper, sigma);
    let sigma_at = |s: f64| Ok::<f64, PlanError>(locate(s, None)?.1.sigma2);
    let own = Places::of(marked, [first.end(), second.length()], sigma_at)?;
    let places = own.within(divide(&first)?);
    for &s in &places {
        let (place, at) = locate(s, sigma.map(|(_, sigma2)| sigma2))?;
        max_gap = max_gap.max(at.gap);
        let speed_ratio = sigma.map_or(1.0, |(s_prev, sigma_prev)| {
            (at.sigma2 - sigma_prev).abs() / (s - s_prev)
        });
        max_speed_difference = max_speed_difference.max((speed_ratio - 1.0).abs());
        sigma = Some((s, at.sigma2));
        if at.distance.iter().any(|distance| *distance < 0.0) {
            return Err(refused(&place, s, LocateError::CrossBefore));
        }
        let pose =
            Pose::new(at.tip, at.tangent, at.normal).map_err(|source| PlanError::Pose { s, source })?;
        weld.push(PlannedPoint {
            pose,
            extension: std::array::from_fn(|k| slide_extension(head.working_distance_mm[k], at.distance[k])),
            speed_ratio,
        });
    }

    let (run_in, run_out) = run_lengths(machine, unit);
    if let Some(run_mm) = [run_in, run_out]
        .into_iter()
        .find(|run| run / RUN_SPACING > CAPACITY as f64)
    {
        return Err(PlanError::LongRun { run_mm });
    }
    let start = weld[0];
    let end = weld[weld.len() - 1];
    let in_steps = steps(run_in);
    let out_steps = steps(run_out);
    let mut line: Vec<(f64, PlannedPoint)> = (0..in_steps)
        .map(|i| -run_in * (in_steps - i) as f64 / in_steps as f64)
        .map(|s| (s, moved(&start, s)))
        .collect();
    line.extend(places.into_iter().zip(weld));
    let after = (1..=out_steps).map(|i| run_out * i as f64 / out_steps as f64);
    line.extend(after.map(|s| (first.end() + s, moved(&end, s))));

    // The map of the seam begins where the camera saw it first.
    let tracking = &unit.board.tracking;
    let seen = head.camera_lead_mm + tracking.window_mm;
    let step = run_in / in_steps as f64;
    let tracks = match own.first_seen(head.camera_lead_mm, sight(unit)) {
        Some(tracks) => tracks,
        None => step * (seen / step).ceil() - run_in,
    };
    own.insert(&mut line, tracks, |s| {
        if s < 0.0 {
            moved(&start, s)
        } else {
            moved(&end, s - first.end())
        }
    });
    let index = |at: f64| {
        let far = |k: &usize| (line[*k].0 - at).abs();
        let nearest = (0..line.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.unwrap_or_default()
    };
    let beams = own.beams.map(|[on, off]| (index(on), index(off)));
    let seam = (beams[0].0.min(beams[1].0), beams[0].1.max(beams[1].1));
    let mut plan = DualBeamPlan {
        tracking: index(tracks).min(seam.0),
        seam,
        beams,
        points: line.into_iter().map(|(_, point)| point).collect(),
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
    head: &HeadConfig,
    paper: bool,
    sigma_prev: Option<f64>,
) -> Result<(SeamPlace, Location), PlanError> {
    let [value, slope, _] = first.at(s);
    let place = SeamPlace {
        point: Vector3::new(value[0], value[1], value[2]),
        tangent: Vector3::new(slope[0], slope[1], slope[2]),
        normal: Vector3::new(value[3], value[4], value[5]),
    };
    let theta2 = head.included_angle_deg / DEG_PER_RAD;
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
/// chord are small enough (mathematics 3.6).
fn divide(curve: &Curve<6>) -> Result<Vec<f64>, PlanError> {
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
            if places.len() > CAPACITY {
                return Err(PlanError::TooManyPoints {
                    s: y,
                    length: curve.end(),
                });
            }
        } else {
            let middle = (x + y) / 2.0;
            open.push((middle, y));
            open.push((x, middle));
        }
    }
    Ok(places)
}

/// Lengths of the straight runs before and after the seam \[mm\]: at 9 m/min the tip reaches its speed,
/// v/2·(v/a + a/j), the map of the seam fills, w + hold + v·(T_p + 4 T_f), and the slides cross half their
/// travel and settle, v·(travel/2/v_slide + 0.1 s); after the seam it only stops. Both are at least 40 mm.
fn run_lengths(machine: &MachineFile, unit: &TrackingUnit) -> (f64, f64) {
    let speed_up = machine.planning.speed_up_length(RUN_SPEED);
    let tracking = &unit.board.tracking;
    let reach = unit
        .board
        .slides
        .iter()
        .map(|slide| (slide.travel_max_mm - slide.travel_min_mm) / 2.0 / slide.max_velocity_mm_s)
        .fold(0.0, f64::max);
    let wait = sight(unit) / RUN_SPEED + reach + SETTLE;
    let lock = tracking.window_mm + tracking.hold_mm + RUN_SPEED * wait;
    ((speed_up + lock).max(SHORTEST_RUN), speed_up.max(SHORTEST_RUN))
}

/// What a camera passes from the seam's first picture until it is known where the seam is \[mm\].
fn sight(unit: &TrackingUnit) -> f64 {
    let frame = f64::from(unit.board.tracking.frame_period_ms) / 1000.0;
    RUN_SPEED * (unit.cameras.processing_ms / 1000.0 + FRAMES * frame)
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
