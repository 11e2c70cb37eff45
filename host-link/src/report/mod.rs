//! What is left of a job: `report.json` and `log.csv` for programs, plots and a table for people.

mod log;
mod plots;
mod table;

use crate::evaluate::Evaluation;
use serde::Serialize;
use shared::io::{MOTORS, SLIDES};
use shared::units::DEG_PER_RAD;
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
    /// The file of the seam's deviation, as it was named.
    pub seam: String,
    /// The boards that were used.
    pub boards: BoardsUsed,
    /// Where the positions come from that count as true.
    pub truth: Truth,
    /// Programmed speed of the weld.
    pub speed_m_per_min: f64,
    /// Length of path with a beam on.
    pub weld_length_mm: f64,
    /// Largest distance of the true spot from the true seam, beam on.
    pub max_deviation_mm: BySlide,
    /// Root mean square of the same.
    pub rms_deviation_mm: BySlide,
    /// Largest distance of the tip from the programmed path, beam on.
    pub max_contour_error_mm: Option<f64>,
    /// Largest following error on any path; X1 X2 Y Z in mm, A B C in degrees.
    pub max_following_error: ByMotor,
    /// Largest |X1 − X2 − square offset| on any path.
    pub max_gantry_skew_um: f64,
    /// Path ticks with a beam on, and how many of them could not be evaluated.
    pub weld_ticks: WeldTicks,
    /// Control ticks that a board could not serve in time, during the job.
    pub lost_ticks: ByBoard,
    /// Ticks whose telemetry never arrived.
    pub telemetry_gaps: ByBoard,
    /// Measurements of the cameras as the tracker board took them.
    pub measurements: Measurements,
    /// Largest residual of the tracker's relation to the motion clock while welding.
    pub clock_residual_us: Option<f64>,
    /// Largest difference between the tracker's relation to the motion clock and the PC's while welding.
    pub clock_difference_us: Option<f64>,
    /// Faults of the boards and whatever else ended the job early, as sentences.
    pub faults: Vec<String>,
    /// From the first request to the last answer, by the boards' time if they are simulated.
    pub duration_s: f64,
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
    /// Name and firmware of the tracker board.
    pub tracker: String,
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

/// One figure a motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "UPPERCASE")]
#[expect(missing_docs, reason = "the names of the motors say it")]
pub struct ByMotor {
    pub x1: f64,
    pub x2: f64,
    pub y: f64,
    pub z: f64,
    pub a: f64,
    pub b: f64,
    pub c: f64,
}

impl ByMotor {
    /// From mm and rad to mm and degrees.
    pub fn from_mm_rad([x1, x2, y, z, a, b, c]: [f64; MOTORS]) -> Self {
        let [a, b, c] = [a, b, c].map(|angle| angle * DEG_PER_RAD);
        Self {
            x1,
            x2,
            y,
            z,
            a,
            b,
            c,
        }
    }

    /// In the order of [`shared::io::MOTOR_NAMES`].
    fn to_array(self) -> [f64; MOTORS] {
        [self.x1, self.x2, self.y, self.z, self.a, self.b, self.c]
    }
}

/// One count a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "the names of the boards say it")]
pub struct ByBoard {
    pub motion: u32,
    pub tracker: u32,
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

/// Writes `report.json`, `log.csv` and, if anything was welded, the plots into `directory`, which is made if it
/// is missing.
pub fn write(directory: &Path, report: &Report, evaluation: &Evaluation) -> Result<(), ReportError> {
    std::fs::create_dir_all(directory).map_err(|e| ReportError::new(directory, e))?;
    let save = |name: &str, content: String| {
        let path = directory.join(name);
        std::fs::write(&path, content).map_err(|e| ReportError::new(&path, e))
    };
    let json = serde_json::to_string_pretty(report).map_err(|e| ReportError::new(directory, e))?;
    save("report.json", json + "\n")?;
    save("log.csv", log::csv(&evaluation.ticks))?;
    if !evaluation.ticks.is_empty() {
        plots::draw(directory, report, &evaluation.ticks)?;
    }
    Ok(())
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
pub(crate) mod tests {
    use super::*;

    pub(crate) fn report() -> Report {
        Report {
            outcome: Outcome::Finished,
            program: "job.ngc".into(),
            machine: "machine.toml".into(),
            seam: "seam.csv".into(),
            boards: BoardsUsed {
                choice: "simulated".into(),
                motion: "simulation 0.1.0".into(),
                tracker: "simulation 0.1.0".into(),
            },
            truth: Truth::SimulatedMachine,
            speed_m_per_min: 5.0,
            weld_length_mm: 400.0,
            max_deviation_mm: [Some(0.0123), Some(0.011), Some(0.009), None].into(),
            rms_deviation_mm: [Some(0.003), Some(0.002), Some(0.002), None].into(),
            max_contour_error_mm: Some(0.004),
            max_following_error: ByMotor::from_mm_rad([0.01, 0.02, 0.03, 0.04, 0.001, 0.002, 0.003]),
            max_gantry_skew_um: 4.2,
            weld_ticks: WeldTicks {
                recorded: 4800,
                unknown: 0,
            },
            lost_ticks: ByBoard::default(),
            telemetry_gaps: ByBoard::default(),
            measurements: Measurements::default(),
            clock_residual_us: Some(12.0),
            clock_difference_us: None,
            faults: vec!["laser 1 reports a fault; look at the source's own display".into()],
            duration_s: 42.5,
        }
    }

    #[test]
    fn the_json_has_the_fields_that_programs_read() {
        let json = serde_json::to_value(report()).unwrap();
        assert_eq!(json["speed_m_per_min"], 5.0);
        assert_eq!(json["max_deviation_mm"]["u1"], 0.0123);
        assert!(json["max_deviation_mm"]["v2"].is_null());
        assert_eq!(json["rms_deviation_mm"]["v1"], 0.002);
        assert_eq!(json["max_contour_error_mm"], 0.004);
        assert_eq!(json["max_following_error"]["X2"], 0.02);
        let degrees = json["max_following_error"]["C"].as_f64().unwrap();
        assert!((degrees - 0.171_887).abs() < 1e-6);
        assert_eq!(json["max_gantry_skew_um"], 4.2);
        assert_eq!(json["lost_ticks"]["motion"], 0);
        assert_eq!(json["lost_ticks"]["tracker"], 0);
        assert_eq!(json["clock_residual_us"], 12.0);
        assert_eq!(json["faults"].as_array().unwrap().len(), 1);
        assert_eq!(json["duration_s"], 42.5);
        assert_eq!(json["outcome"], "finished");
        assert_eq!(json["truth"], "simulated machine");
    }
}
