//! The machine file: everything that is true of one machine, in TOML, mm and degrees.

use crate::table::line_of;
use serde::Deserialize;
use shared::io::AXES;
use shared::kinematics::KinematicsConfig;
use shared::motion::{AxisConfig, BeamConfig, GantryConfig, Machine, MotionConfig, MotorConfig};
use shared::parameter::ParameterError;
use shared::tracking::{HeadConfig, SlideConfig, TrackerConfig, TrackingConfig};
use std::path::Path;
use thiserror::Error;

/// A machine, as its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineFile {
    /// Name of the machine, for people.
    pub name: String,
    /// Parameters of the motion board.
    pub motion: MotionConfig,
    /// What follows the seam, if the machine has that.
    pub tracking: Option<TrackingUnit>,
    /// What only the PC needs for planning.
    pub planning: PlanningConfig,
}

/// The tracker board, its slides and cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingUnit {
    /// Parameters of the tracker board.
    pub board: TrackerConfig,
    /// Cameras, for simulated worlds.
    pub cameras: CameraConfig,
}

/// What only the PC needs for planning.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanningConfig {
    /// Acceleration along a feed path \[mm/s²\].
    pub path_acceleration_mm_s2: f64,
    /// Jerk along a feed path \[mm/s³\].
    pub path_jerk_mm_s3: f64,
    /// Rapids use this part of the axes' limits, 0…1.
    pub rapid_fraction: f64,
    /// Height of the tip Z in the world at which it may travel anywhere \[mm\].
    pub safe_height_mm: f64,
    /// Where the axes go after the job (mm, degrees).
    pub park: ByAxis<f64>,
    /// Axes that move to their park position before the others do.
    pub park_first: Vec<AxisName>,
}

/// An axis by its letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[expect(missing_docs, reason = "letters")]
pub enum AxisName {
    X,
    Y,
    Z,
    A,
    B,
    C,
}

impl PlanningConfig {
    /// Where the axes go after the job (mm, degrees); 0 for those that the machine does not have.
    pub fn park_axes(&self) -> [f64; AXES] {
        self.park.into_array().map(Option::unwrap_or_default)
    }
}

/// Something of each axis that the machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "the keys of the file are the names of the axes")]
pub struct ByAxis<T> {
    X: Option<T>,
    Y: Option<T>,
    Z: Option<T>,
    A: Option<T>,
    B: Option<T>,
    C: Option<T>,
}

impl<T> ByAxis<T> {
    /// In the order of [`shared::io::AXIS_NAMES`].
    pub fn into_array(self) -> [Option<T>; AXES] {
        [self.X, self.Y, self.Z, self.A, self.B, self.C]
    }
}

/// Cameras, for simulated worlds; lead and frame period are parameters of the tracker board.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraConfig {
    /// From the strobe to the measurement \[ms\].
    pub processing_ms: f64,
    /// Noise of a measurement, three standard deviations \[mm\].
    pub noise_3sigma_mm: f64,
}

/// Why a machine file cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum MachineError {
    /// The file cannot be read.
    #[error("cannot read machine file {path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not TOML, or a key is missing, unknown or of the wrong type.
    #[error("machine file {path}, line {line}: {message}")]
    Content {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A parameter of a board makes no sense.
    #[error("machine file {path}: {parameter}, which is out of range")]
    Parameter {
        /// The file.
        path: String,
        /// Owner, name and value.
        parameter: ParameterError,
    },
    /// A value makes no sense.
    #[error("machine file {path}: {key} is {value}, but must be {requirement}")]
    Value {
        /// The file.
        path: String,
        /// Dotted name of the key.
        key: String,
        /// What it says.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
}

impl MachineFile {
    /// Reads the file at `path`.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        let name = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&name, &text),
            Err(source) => Err(MachineError::Read { path: name, source }),
        }
    }

    /// Understands `text`; `path` is used in messages only.
    pub fn parse(path: &str, text: &str) -> Result<Self, MachineError> {
        let document: Document = toml::from_str(text).map_err(|error| MachineError::Content {
            path: path.to_owned(),
            line: line_of(text, error.span().map_or(0, |span| span.start)),
            message: error.message().replace('\n', ", "),
        })?;
        document
            .check()
            .map_err(|(key, value, requirement)| MachineError::Value {
                path: path.to_owned(),
                key: key.to_owned(),
                value,
                requirement,
            })?;
        let machine: Self = document.into();
        let parameter = |parameter| MachineError::Parameter {
            path: path.to_owned(),
            parameter,
        };
        // As the boards will build it.
        Machine::build(&machine.motion).map_err(parameter)?;
        if let Some(unit) = &machine.tracking {
            unit.board.build().map_err(parameter)?;
        }
        Ok(machine)
    }
}

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    name: String,
    link_timeout_ms: u32,
    kinematics: KinematicsConfig,
    axes: ByAxis<AxisConfig>,
    motors: Motors,
    gantry: Option<GantryConfig>,
    beams: Sides<BeamConfig>,
    head: Option<HeadConfig>,
    slides: Option<Slides>,
    tracking: Option<TrackingConfig>,
    planning: PlanningConfig,
    cameras: Option<CameraConfig>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "the keys of the file are the names of the motors")]
struct Motors {
    X1: Option<MotorConfig>,
    X2: Option<MotorConfig>,
    Y: Option<MotorConfig>,
    Z: Option<MotorConfig>,
    A: Option<MotorConfig>,
    B: Option<MotorConfig>,
    C: Option<MotorConfig>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "the keys of the file are the names of the slides")]
struct Slides {
    U1: SlideConfig,
    V1: SlideConfig,
    U2: SlideConfig,
    V2: SlideConfig,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sides<T> {
    #[serde(rename = "1")]
    first: Option<T>,
    #[serde(rename = "2")]
    second: Option<T>,
}

impl Document {
    /// Checks what only the PC uses.
    fn check(&self) -> Result<(), (&'static str, f64, &'static str)> {
        let planning = &self.planning;
        let positive = [
            (
                "planning.path_acceleration_mm_s2",
                planning.path_acceleration_mm_s2,
            ),
            ("planning.path_jerk_mm_s3", planning.path_jerk_mm_s3),
        ];
        for (key, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err((key, value, "above 0"));
            }
        }
        let fraction = planning.rapid_fraction;
        if !(fraction > 0.0 && fraction <= 1.0) {
            return Err(("planning.rapid_fraction", fraction, "above 0 and at most 1"));
        }
        if !planning.safe_height_mm.is_finite() {
            return Err((
                "planning.safe_height_mm",
                planning.safe_height_mm,
                "a finite number",
            ));
        }
        if let Some(cameras) = &self.cameras {
            let not_negative = [
                ("cameras.processing_ms", cameras.processing_ms),
                ("cameras.noise_3sigma_mm", cameras.noise_3sigma_mm),
            ];
            for (key, value) in not_negative {
                if !(value.is_finite() && value >= 0.0) {
                    return Err((key, value, "0 or more"));
                }
            }
        }
        Ok(())
    }
}

impl From<Document> for MachineFile {
    fn from(d: Document) -> Self {
        let m = d.motors;
        let tracking = match (d.head, d.slides, d.tracking, d.cameras) {
            (Some(head), Some(slides), Some(tracking), Some(cameras)) => Some(TrackingUnit {
                board: TrackerConfig {
                    head,
                    slides: [slides.U1, slides.V1, slides.U2, slides.V2],
                    tracking,
                },
                cameras,
            }),
            _ => None,
        };
        Self {
            name: d.name,
            motion: MotionConfig {
                kinematics: d.kinematics,
                axes: d.axes.into_array(),
                motors: [m.X1, m.X2, m.Y, m.Z, m.A, m.B, m.C],
                gantry: d.gantry,
                beams: [d.beams.first, d.beams.second],
                link_timeout_ms: d.link_timeout_ms,
            },
            tracking,
            planning: d.planning,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = include_str!("../../machines/dual-beam-gantry.toml");

    fn error_of(text: &str) -> String {
        MachineFile::parse("m.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn the_shipped_machine_has_the_published_travel_and_speeds() {
        let machine = MachineFile::parse("m.toml", SHIPPED).unwrap();
        let travel: Vec<f64> = machine
            .motion
            .axes
            .iter()
            .flatten()
            .map(|a| a.travel_max - a.travel_min)
            .collect();
        assert_eq!(travel, [5000.0, 3000.0, 1000.0, 200.0, 60.0, 180.0]);
        let m_min: Vec<f64> = machine
            .motion
            .axes
            .iter()
            .flatten()
            .map(|a| a.max_velocity * 0.06)
            .collect();
        for (seen, published) in m_min.iter().zip([20.0, 20.0, 10.0, 7.2, 7.2, 7.2]) {
            assert!((seen - published).abs() < 1e-3, "{seen} is not {published}");
        }
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line() {
        let line = 1 + SHIPPED.lines().position(|l| l == "[head]").unwrap();
        let text = SHIPPED.replace("[head]", "[head]\nwobble = 3.0");
        let error = error_of(&text);
        assert!(error.contains(&format!("line {}:", line + 1)), "{error}");
        assert!(error.contains("wobble"), "{error}");
        assert_eq!(error.lines().count(), 1);
    }

    #[test]
    fn a_missing_key_is_named_with_the_line_of_its_table() {
        let line = 1 + SHIPPED.lines().position(|l| l == "[head]").unwrap();
        let error = error_of(&SHIPPED.replace("camera_lead_mm = 10.0", ""));
        assert!(error.contains(&format!("line {line}:")), "{error}");
        assert!(error.contains("camera_lead_mm"), "{error}");
    }

    #[test]
    fn a_value_that_makes_no_sense_is_named() {
        let error = error_of(&SHIPPED.replace("rapid_fraction = 0.5", "rapid_fraction = 1.5"));
        assert_eq!(
            error,
            "machine file m.toml: planning.rapid_fraction is 1.5, but must be above 0 and at most 1"
        );
        let error = error_of(&SHIPPED.replace("gate_mm = 1.0", "gate_mm = -1.0"));
        assert_eq!(
            error,
            "machine file m.toml: gate_mm of tracking is -1, which is out of range"
        );
        let error = error_of(&SHIPPED.replacen("kp = 120.0", "kp = -120.0", 1));
        assert_eq!(
            error,
            "machine file m.toml: kp of X1 is -120, which is out of range"
        );
    }
}
