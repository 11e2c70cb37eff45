//! `seamwright teach` for places of the tip: an operator leads the machine there.

use super::boards::{BoardArgs, exit_code};
use super::teach_seam::{SeamArgs, output_of};
use crate::console::outln;
use crate::terminal::Operator;
use anyhow::{Context, anyhow};
use cam::path::{Planner, Tip};
use config::machine::MachineFile;
use job::{LedLesson, Work};
use parts::PartFile;
use shared::io::AXES;
use shared::kinematics::AXIS_UNIT;
use std::path::Path;
use std::process::ExitCode;
use teach::TipFile;

impl SeamArgs {
    /// Teaches the places of `part`.
    pub fn lead(
        &self,
        boards: &BoardArgs,
        (machine, machine_path): (&MachineFile, &Path),
        part: &PartFile,
        output: Option<&Path>,
    ) -> anyhow::Result<ExitCode> {
        self.refuse_cameras()?;
        let seam = part
            .taught_seam()
            .ok_or_else(|| anyhow!("the part has no places to teach"))?;
        let start = self.from.map(|from| axes(machine, &from.tip())).transpose()?;
        let output = output_of(output, part, Some(seam.taught()))?;
        let (file, points, kept) = TipFile::open(&output, self.restart)?;
        if let Some(kept) = kept {
            outln!("the places taught before are in {}", kept.display());
        }
        if !points.is_empty() {
            outln!("{}: continues after place {}", output.display(), points.len());
        }
        let lesson = LedLesson { start, points, file };
        let program = part.path().display().to_string();
        let job = boards.bare_job((machine, machine_path), Work::Lead(&lesson), program);
        let ended = match boards.run(&job, Operator::LeadsByLines { always: true }, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        if ended.error.is_none() {
            outln!("{}: {} places", output.display(), ended.taught.led.len());
        }
        exit_code(ended.error)
    }
}

/// The axes at a tip (mm, degrees).
fn axes(machine: &MachineFile, tip: &Tip) -> anyhow::Result<[f64; AXES]> {
    let planner = Planner::build(machine)?;
    let [a, b, c] = tip.angles_deg.map(f64::to_radians);
    let near = [0.0, 0.0, 0.0, a, b, c];
    let axes = planner.kinematics().inverse(&planner.pose(tip), &near);
    let axes = axes.context("--from: the machine does not reach that place")?;
    Ok(std::array::from_fn(|i| axes[i] / AXIS_UNIT[i]))
}
