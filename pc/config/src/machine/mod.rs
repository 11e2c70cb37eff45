//! The machine file: all parameters of one machine, in TOML, mm and degrees.

mod cameras;
mod check;
mod deviations;
mod document;
mod error;
mod process_io;
mod program;
mod tools;
mod weak_protection;

pub use cameras::{CameraConfig, JointForm};
pub use error::{MachineError, Mistake};
pub use process_io::{InputNames, OutputNames};
pub use program::{
    ArcPlane, FirstMotion, LaserWords, LengthUnit, PassedOver, PathMode, ProbeConfig, ProgramConfig, Rotary,
};
pub use tools::ToolConfig;
pub use weak_protection::WeakProtection;

use crate::probe::ProbeUnit;
use crate::toml_file;
use crate::weld_data::WeldData;
use crate::work_offsets::WorkOffsets;
use document::Document;
use serde::Deserialize;
use shared::config::{DeviationConfig, MotionConfig, TrackerConfig};
use shared::io::{AXES, MOTOR_AXIS};
use shared::motion::Machine;
use std::collections::BTreeMap;
use std::path::Path;

/// What messages call the file.
const WHAT: &str = "machine file";

/// A machine, as its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineFile {
    /// Name of the machine, for people.
    pub name: String,
    /// Parameters of the motion board.
    pub motion: MotionConfig,
    /// Measured deviations of its axes, for the motion board.
    pub deviations: Vec<DeviationConfig>,
    /// What follows the seam, if the machine has that.
    pub tracking: Option<TrackingUnit>,
    /// Names of its process outputs.
    pub outputs: OutputNames,
    /// Names of its process inputs.
    pub inputs: InputNames,
    /// What welds are made with, from a file of its own that belongs to a program; no sets until it was read.
    pub welding: WeldData,
    /// Where the work lies, from a file of its own beside that of the machine; nowhere else until it was read.
    pub work_offsets: WorkOffsets,
    /// What the process asks for, if that is known.
    pub process: Option<ProcessConfig>,
    /// The probe that measures surfaces, if the machine has one.
    pub probe: Option<ProbeUnit>,
    /// What only the PC needs for planning.
    pub planning: PlanningConfig,
    /// What NC programs begin with.
    pub program: ProgramConfig,
    /// Tools by number.
    pub tools: BTreeMap<u32, ToolConfig>,
}

/// The tracker board, its slides and cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingUnit {
    /// Parameters of the tracker board.
    pub board: TrackerConfig,
    /// The two cameras.
    pub cameras: CameraConfig,
}

/// Between which path speeds the process gives what it should.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessConfig {
    /// Lowest \[mm/s\].
    pub min_speed_mm_s: f64,
    /// Highest \[mm/s\].
    pub max_speed_mm_s: f64,
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

    /// Length that a feed path takes to reach `velocity` \[mm/s\] from rest \[mm\].
    pub fn speed_up_length(&self, velocity: f64) -> f64 {
        let (a, j) = (self.path_acceleration_mm_s2, self.path_jerk_mm_s3);
        // Without constant acceleration in between if a is never reached.
        let time = if velocity * j > a * a {
            velocity / a + a / j
        } else {
            2.0 * libm::sqrt(velocity / j)
        };
        velocity / 2.0 * time
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

impl MachineFile {
    /// Reads the file at `path`, and the work offsets beside it.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        Ok(Self {
            work_offsets: WorkOffsets::beside(path)?,
            ..Self::parse(&path.display().to_string(), &toml_file::text(WHAT, path)?)?
        })
    }

    /// Understands `text`; `path` is used in messages only.
    pub fn parse(path: &str, text: &str) -> Result<Self, MachineError> {
        let document: Document = toml_file::parse(WHAT, path, text)?;
        let mistake = |mistake: Mistake| MachineError::Mistake {
            path: path.to_owned(),
            line: toml_file::line_of(text, &mistake.key()),
            mistake,
        };
        let machine: Self = document.try_into().map_err(mistake)?;
        check::machine(&machine).map_err(mistake)?;
        let parameter = |parameter| MachineError::Parameter {
            path: path.to_owned(),
            parameter,
        };
        // As the boards will build it.
        let (mut board, _) = Machine::build(&machine.motion).map_err(parameter)?;
        deviations::check(&machine.deviations, &mut board).map_err(mistake)?;
        if let Some(unit) = &machine.tracking {
            unit.board.build().map_err(parameter)?;
        }
        Ok(machine)
    }

    /// Where homing leaves the axes: at their reference marks (mm, degrees); 0 for those that the machine does not
    /// have.
    pub fn homed_axes(&self) -> [f64; AXES] {
        let mut axes = [0.0; AXES];
        // Of a gantry the first motor is the axis.
        for (motor, axis) in self.motion.motors.iter().zip(MOTOR_AXIS).rev() {
            if let Some(motor) = motor {
                axes[axis] = motor.home.mark_position;
            }
        }
        axes
    }
}

#[cfg(test)]
mod tests;
