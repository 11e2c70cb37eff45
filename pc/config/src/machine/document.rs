//! The machine file as it is written.

use super::deviations;
use super::process_io;
use super::tools::{self, ToolConfig};
use super::{
    ByAxis, CameraConfig, MachineFile, Mistake, PlanningConfig, ProcessConfig, ProgramConfig, TrackingUnit,
};
use crate::probe::ProbeUnit;
use crate::weld_data::WeldData;
use crate::work_offsets::WorkOffsets;
use serde::Deserialize;
use shared::config::{BeamConfig, HeadConfig, MotionConfig, SlideConfig, TrackerConfig, TrackingConfig};
use shared::control::{GantryConfig, MotorConfig};
use shared::kinematics::{AxisConfig, KinematicsConfig};
use std::collections::BTreeMap;

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    name: String,
    link_timeout_ms: u32,
    #[serde(default = "usual_enable_ms")]
    drive_enable_ms: u32,
    kinematics: KinematicsConfig,
    axes: ByAxis<AxisConfig>,
    motors: Motors,
    gantry: Option<GantryConfig>,
    #[serde(default)]
    deviations: deviations::Tables,
    beams: Sides<BeamConfig>,
    #[serde(default)]
    outputs: BTreeMap<String, process_io::Output>,
    #[serde(default)]
    analog_outputs: BTreeMap<String, process_io::Analog>,
    #[serde(default)]
    inputs: BTreeMap<String, process_io::Input>,
    head: Option<HeadConfig>,
    slides: Option<Slides>,
    tracking: Option<TrackingConfig>,
    planning: PlanningConfig,
    cameras: Option<CameraConfig>,
    process: Option<ProcessConfig>,
    probe: Option<ProbeUnit>,
    #[serde(default)]
    program: ProgramConfig,
    #[serde(default)]
    tools: BTreeMap<String, ToolConfig>,
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
    U2: Option<SlideConfig>,
    V2: Option<SlideConfig>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sides<T> {
    #[serde(rename = "1")]
    first: Option<T>,
    #[serde(rename = "2")]
    second: Option<T>,
}

impl Slides {
    /// Those of one side or of both.
    fn into_list(self) -> Result<Vec<SlideConfig>, Mistake> {
        let missing = |table| Mistake::TrackerIncomplete { table };
        let second = match (self.U2, self.V2) {
            (None, None) => None,
            (Some(u), Some(v)) => Some([u, v]),
            (None, Some(_)) => return Err(missing("slides.U2")),
            (Some(_), None) => return Err(missing("slides.V2")),
        };
        let first = [self.U1, self.V1].into_iter();
        Ok(first.chain(second.into_iter().flatten()).collect())
    }
}

impl TryFrom<Document> for MachineFile {
    type Error = Mistake;

    fn try_from(d: Document) -> Result<Self, Mistake> {
        let m = d.motors;
        let beams = [d.beams.first, d.beams.second];
        let tables = process_io::Tables {
            outputs: d.outputs,
            analog: d.analog_outputs,
            inputs: d.inputs,
        };
        let (process, outputs, inputs) = tables.build(&beams)?;
        let motion = MotionConfig {
            kinematics: d.kinematics,
            axes: d.axes.into_array(),
            motors: [m.X1, m.X2, m.Y, m.Z, m.A, m.B, m.C],
            gantry: d.gantry,
            beams,
            process,
            link_timeout_ms: d.link_timeout_ms,
            drive_enable_ms: d.drive_enable_ms,
        };
        Ok(Self {
            name: d.name,
            deviations: deviations::build(&d.deviations, &motion)?,
            motion,
            tracking: tracking_unit(d.drive_enable_ms, d.head, d.slides, d.tracking, d.cameras)?,
            outputs,
            inputs,
            welding: WeldData::default(),
            work_offsets: WorkOffsets::default(),
            process: d.process,
            probe: d.probe,
            planning: d.planning,
            program: d.program,
            tools: tools::by_number(d.tools)?,
        })
    }
}

/// Servo drives with holding brakes take about so long \[ms\].
fn usual_enable_ms() -> u32 {
    200
}

/// All tables of a tracker, or none.
fn tracking_unit(
    drive_enable_ms: u32,
    head: Option<HeadConfig>,
    slides: Option<Slides>,
    tracking: Option<TrackingConfig>,
    cameras: Option<CameraConfig>,
) -> Result<Option<TrackingUnit>, Mistake> {
    if head.is_none() && slides.is_none() && tracking.is_none() && cameras.is_none() {
        return Ok(None);
    }
    let missing = |table| Mistake::TrackerIncomplete { table };
    let slides = slides.ok_or(missing("slides"))?;
    Ok(Some(TrackingUnit {
        board: TrackerConfig {
            head: head.ok_or(missing("head"))?,
            slides: slides.into_list()?.into_iter().collect(),
            tracking: tracking.ok_or(missing("tracking"))?,
            drive_enable_ms,
        },
        cameras: cameras.ok_or(missing("cameras"))?,
    }))
}
