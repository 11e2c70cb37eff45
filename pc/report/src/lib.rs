//! What is left of a job: `report.json` and `log.csv` for programs, plots and a table for people.

mod circle;
mod draw;
mod dry_run;
mod ended;
mod joint;
mod log;
mod motor;
mod plots;
mod positioning;
mod table;
pub mod unwelded;

pub use circle::write_circle;
pub use dry_run::write_dry_run;
pub use ended::{Ended, ended};
pub use log::{LOG, LogColumns, LogWriter};
pub use motor::write_motor;
pub use positioning::write_positioning;

use crate::unwelded::Unwelded;
use evaluate::{JOINT_QUANTITIES, JointFigures, Load, SpeedShares, Switching};
use job::{ByBoard, CameraFigures, DelayFigures, Recentred};
use parts::Figure;
use serde::{Serialize, Serializer};
use shared::io::{MOTOR_NAMES, MOTORS, SIDES, SLIDES};
use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Contents of `report.json`. Lengths in mm, rotary axes in degrees; a figure that is not known is `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// How the job ended.
    pub outcome: Outcome,
    /// The program, as it was named.
    pub program: String,
    /// The machine file, as it was named.
    pub machine: String,
    /// The file of the part that was made.
    pub part: Option<String>,
    /// Where the limits come from that the run was judged by, if it was.
    pub judged_by: Option<JudgedBy>,
    /// The boards that were used.
    pub boards: BoardsUsed,
    /// Where the positions come from that count as true.
    pub truth: Truth,
    /// Programmed speed of the longest path that works.
    pub speed_m_per_min: f64,
    /// Length of path with a beam on; of all feeds if no beam ever was.
    pub weld_length_mm: f64,
    /// True speed with a beam on, as a share of the programmed feed at the same place, and where that was.
    pub speed: Option<SpeedShares>,
    /// Largest distance of the tip from the programmed path on the same length.
    pub max_contour_error_mm: Option<f64>,
    /// Largest following error on any path; X1 X2 Y Z in mm, A B C in degrees.
    pub max_following_error: ByMotor,
    /// Following error at which the motion board trips at standstill; moving, it allows more.
    pub following_error_trip: ByMotor,
    /// Highest vibration from the search of the reference marks on: root mean square of the following error above 10 Hz.
    pub vibration: ByMotor,
    /// Vibration at which the motion board stops, of motors for which it does.
    pub vibration_limit: ByMotor,
    /// Vibration above which people are warned: half of that, of other motors half of the usual limit.
    pub vibration_warned: ByMotor,
    /// Largest |X1 − X2 − square offset| on any path, where X is a gantry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_gantry_skew_um: Option<f64>,
    /// Path ticks of that length, and how many of them could not be evaluated.
    pub weld_ticks: WeldTicks,
    /// Control ticks that a board could not serve in time, during the job.
    pub lost_ticks: ByBoard,
    /// How exactly gates and outputs were switched in motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub switching: Option<Switching>,
    /// CPU load of the motion board; a simulated one has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<Load>,
    /// Ticks whose telemetry never arrived.
    pub telemetry_gaps: ByBoard,
    /// Datagrams of the boards that the PC did not understand, or had no room for.
    pub dropped_datagrams: u32,
    /// How the seam was followed, where the machine has a tracker.
    #[serde(flatten)]
    pub seam: Option<SeamFigures>,
    /// What the part says of the run, by key.
    #[serde(serialize_with = "by_key")]
    pub figures: Vec<Figure>,
    /// Limits of the part that nothing was known to judge by, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_judged: Vec<String>,
    /// Places where the program has a beam on that were not gone over with it.
    pub unwelded: Vec<Unwelded>,
    /// Time that the paths should take by a dry run, without the dwells between them.
    pub planned_motion_s: f64,
    /// Time that they took by the motion board's clock.
    pub motion_s: f64,
    /// Faults of the boards and whatever else ended the job early, as sentences.
    pub faults: Vec<String>,
    /// From the first request to the last answer, by the boards' time if they are simulated.
    pub duration_s: f64,
}

impl Report {
    /// Figures beyond their limit.
    pub fn exceeded(&self) -> impl Iterator<Item = &Figure> {
        self.figures.iter().filter(|figure| figure.is_exceeded())
    }
}

/// An exceeded figure in words.
pub fn sentence(figure: &Figure) -> String {
    let Figure { text, unit, .. } = figure;
    let most = figure.limit.map(|most| format!("{} {unit}", table::number(most)));
    let least = figure
        .least
        .map(|least| format!("{} {unit} at least", table::number(least)));
    let limits: Vec<String> = most.into_iter().chain(least).collect();
    let at = figure.at_mm.map(|at| format!(" at s = {at:.1} mm"));
    format!(
        "{text} {} {unit}{} (may be {})",
        table::number(figure.value),
        at.unwrap_or_default(),
        limits.join(", ")
    )
}

/// What is outside its limits, if anything is.
pub fn verdict(report: &Report) -> Option<String> {
    let exceeded: Vec<String> = report.exceeded().map(sentence).collect();
    let limits =
        (!exceeded.is_empty()).then(|| format!("the weld is outside its limits: {}", exceeded.join(", ")));
    let left_out = report.unwelded.iter().map(ToString::to_string);
    let told: Vec<String> = limits.into_iter().chain(left_out).collect();
    (!told.is_empty()).then(|| told.join("; "))
}

/// A map from the key of each figure to its value, unit and limit.
fn by_key<S: Serializer>(figures: &[Figure], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(figures.iter().map(|figure| (figure.key, figure)))
}

/// How the seam was followed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeamFigures {
    /// The file of the seam's deviation, as it was named.
    pub seam: Option<String>,
    /// Largest distance of the true spot from the true seam, beam on.
    pub max_deviation_mm: BySlide,
    /// Root mean square of the same.
    pub rms_deviation_mm: BySlide,
    /// Gap and step of the joint along the seam of side 1 and 2, as the cameras saw them.
    pub joint: [JointOfSide; SIDES],
    /// Measurements of the cameras as the tracker board took them.
    pub measurements: Measurements,
    /// What became of the pictures of camera 1 and 2, if there were any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pictures: Option<[CameraFigures; 2]>,
    /// From the strobe of the cameras to the measurement that was sent, by the motion board's clock \[ms\].
    pub strobe_to_measurement_ms: Option<DelayFigures>,
    /// From the arrival of the picture, which is the time when a rendered one was there and due, to the measurement that was
    /// sent \[ms\]; not told by simulated boards, whose time stands still meanwhile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture_to_measurement_ms: Option<DelayFigures>,
    /// Largest residual of the tracker's relation to the motion clock while welding.
    pub clock_residual_us: Option<f64>,
    /// Largest difference between the tracker's relation to the motion clock and the PC's while welding.
    pub clock_difference_us: Option<f64>,
    /// Where the six axes took over from slides that had gone far.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub recentred: Vec<Recentred>,
}

/// The joint along one seam; `None` of what was not seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct JointOfSide {
    /// Width of its gap.
    pub gap_width: Option<JointFigures>,
    /// How much higher its side at larger u lies.
    pub step: Option<JointFigures>,
}

impl From<[Option<JointFigures>; JOINT_QUANTITIES]> for JointOfSide {
    fn from([gap_width, step]: [Option<JointFigures>; JOINT_QUANTITIES]) -> Self {
        Self { gap_width, step }
    }
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// To its end.
    Finished,
    /// Stopped by the operator.
    Interrupted,
    /// Stopped by a fault.
    Failed,
}

/// Where the limits come from that a run was judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JudgedBy {
    /// The part file, and what is shipped for keys that it leaves out.
    Part,
    /// There is no part file: what is shipped for seams that are followed.
    ShippedSeamLimits,
}

/// Where the positions come from that count as true.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Truth {
    /// The simulated machine knows them.
    #[serde(rename = "simulated machine")]
    SimulatedMachine,
    /// What the real machine measures of itself.
    #[serde(rename = "gratings and encoders")]
    GratingsAndEncoders,
}

/// The boards that were used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BoardsUsed {
    /// As on the command line.
    pub choice: String,
    /// Name and firmware of the motion board.
    pub motion: String,
    /// Name and firmware of the tracker board, if it was used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracker: Option<String>,
}

/// One figure a slide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names of the slides say it")]
pub struct BySlide {
    pub u1: Option<f64>,
    pub v1: Option<f64>,
    pub u2: Option<f64>,
    pub v2: Option<f64>,
}

impl From<[Option<f64>; SLIDES]> for BySlide {
    fn from([u1, v1, u2, v2]: [Option<f64>; SLIDES]) -> Self {
        Self { u1, v1, u2, v2 }
    }
}

/// One figure for each motor that the machine has, in the order of [`MOTOR_NAMES`] (mm or degrees).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByMotor(pub [Option<f64>; MOTORS]);

impl ByMotor {
    /// Number, name and figure of each motor that the machine has.
    pub fn fitted(&self) -> impl Iterator<Item = (usize, &'static str, f64)> {
        let named = MOTOR_NAMES.into_iter().zip(self.0).enumerate();
        named.filter_map(|(motor, (name, figure))| Some((motor, name, figure?)))
    }
}

impl Serialize for ByMotor {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.fitted().map(|(_, name, figure)| (name, figure)))
    }
}

/// Path ticks with a beam on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct WeldTicks {
    /// That have telemetry of the motion board.
    pub recorded: u32,
    /// Of these, without a known deviation.
    pub unknown: u32,
}

/// What became of the cameras' measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Measurements {
    /// Used, side 1 and 2.
    pub accepted: [u32; 2],
    /// Rejected as outliers, side 1 and 2.
    pub rejected: [u32; 2],
    /// Too late for the tracker's history.
    pub too_old: u32,
    /// Never made, since nothing was known of the time of the capture.
    pub given_up: u32,
}

/// The report cannot be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {reason}", path.display())]
pub struct ReportError {
    path: PathBuf,
    reason: String,
}

impl ReportError {
    fn new(path: &Path, reason: impl fmt::Display) -> Self {
        Self {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}

/// Writes all of it into `directory`: `report.json`, `log.csv`, `joint.csv`, and the plots.
///
/// # Errors
/// [`ReportError`] with the file.
pub fn write(directory: &Path, ended: &Ended) -> Result<(), ReportError> {
    std::fs::create_dir_all(directory).map_err(|e| ReportError::new(directory, e))?;
    let Ended {
        report, evaluation, ..
    } = ended;
    let file = directory.join("report.json");
    let json = serde_json::to_string_pretty(report).map_err(|e| ReportError::new(directory, e))?;
    std::fs::write(&file, json + "\n").map_err(|e| ReportError::new(&file, e))?;
    let file = directory.join(LOG);
    let samples = ended.record.motion();
    let computed = || evaluation.ticks.check().and(evaluation.joint.points.check());
    let lost = || (samples.check(), computed());
    let known = lost();
    let written = log::write(&file, &ended.columns, samples, &evaluation.ticks);
    written.map_err(|e| ReportError::new(&file, e))?;
    if !evaluation.ticks.is_empty() {
        plots::draw(directory, report, &evaluation.ticks)?;
    }
    joint::write(directory, report, &evaluation.joint.points)?;
    plots::draw_more(directory, report, &ended.plots)?;
    // What was lost before that is among the errors of the job.
    let now = lost();
    if now == known {
        Ok(())
    } else {
        now.0.and(now.1).map_err(|e| ReportError::new(&file, e))
    }
}

/// Checks that a report can be written into `directory`, before anything moves.
pub fn prepare(directory: &Path) -> Result<(), ReportError> {
    std::fs::create_dir_all(directory).map_err(|e| ReportError::new(directory, e))
}

impl fmt::Display for Report {
    /// The table for people.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        table::write(f, self)
    }
}

#[cfg(test)]
pub(crate) mod tests;
