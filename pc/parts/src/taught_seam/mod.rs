//! A seam through places that were taught with the tip, welded in passes with weld data: on any machine.

mod error;
mod judge;
mod program;
#[cfg(test)]
mod tests;

use crate::{Judgement, Kind, Limit, PartContext, Percent, Plan, Run};
use config::in_range;
use config::machine::MachineFile;
use error::TaughtSeamError;
use serde::Deserialize;
use shared::geometry::Pose;
use shared::kinematics::Kinematics;
use std::path::{Path, PathBuf};
use teach::{TipPoint, read_tip_points};

/// Taught places and how the seam through them is welded.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaughtSeam {
    /// File of the places, as `seamwright teach` writes it.
    taught: PathBuf,
    /// The seam is straight from place to place, and its corners are rounded within this \[mm\]; without it, it is one
    /// smooth curve through them.
    corner_mm: Option<f64>,
    /// The tip comes from this far, along the tool, and goes back there after each pass \[mm\].
    approach_mm: f64,
    /// The welds, one after the other.
    passes: Vec<Pass>,
    /// What the weld is judged by.
    #[serde(default)]
    limits: TaughtSeamLimits,
}

/// A weld along the seam.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pass {
    /// Its set of the weld data.
    weld: String,
    /// Speed along the seam \[mm/min\].
    mm_min: f64,
    /// From the last place to the first one.
    #[serde(default)]
    back: bool,
}

/// What a run is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct TaughtSeamLimits {
    /// Every pass begins and ends as near to the ends of the seam, along it \[mm\].
    ends_mm: Limit,
    /// The tip is as near to the programmed path, weave included \[mm\]; and `corner_mm` more where corners are
    /// rounded.
    contour_mm: Limit,
    /// Most that the speed may fall below the feed with the beam on \[%\]; not judged if it is not said, as a weave is slower
    /// at its sides.
    speed_dip_percent: Option<Percent>,
}

impl Default for TaughtSeamLimits {
    fn default() -> Self {
        Self {
            ends_mm: Limit::new(1.0),
            contour_mm: Limit::new(0.05),
            speed_dip_percent: None,
        }
    }
}

impl Kind for TaughtSeam {
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan> {
        let points = self.points(context.directory)?;
        self.check()?;
        Ok(program::plan(self, &points, context)?)
    }

    fn check_judging(&self, context: &PartContext, _: &Kinematics) -> anyhow::Result<()> {
        Ok(self.points(context.directory).map(drop)?)
    }

    fn judge(&self, context: &PartContext, run: &Run) -> anyhow::Result<Judgement> {
        let points = self.points(context.directory)?;
        judge::judge(&points, &self.limits, self.corner_mm.unwrap_or(0.0), run)
    }

    fn speed_dip(&self) -> Option<Percent> {
        self.limits.speed_dip_percent
    }
}

impl TaughtSeam {
    /// File of the taught places, relative to the part file.
    pub fn taught(&self) -> &Path {
        &self.taught
    }

    fn points(&self, directory: &Path) -> Result<Vec<TipPoint>, TaughtSeamError> {
        let file = directory.join(&self.taught);
        if !file.exists() {
            let file = file.display().to_string();
            return Err(TaughtSeamError::Untaught { file });
        }
        Ok(read_tip_points(&file)?)
    }

    fn check(&self) -> Result<(), TaughtSeamError> {
        in_range("approach_mm", self.approach_mm, self.approach_mm > 0.0, "above 0")?;
        if let Some(corner) = self.corner_mm {
            in_range("corner_mm", corner, corner > 0.0, "above 0")?;
        }
        if self.passes.is_empty() {
            return Err(TaughtSeamError::NoPass);
        }
        for pass in &self.passes {
            in_range("passes.mm_min", pass.mm_min, pass.mm_min > 0.0, "above 0")?;
            // It becomes a word of the program.
            let letter = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
            if pass.weld.is_empty() || !pass.weld.chars().all(letter) {
                let name = pass.weld.clone();
                return Err(TaughtSeamError::Name { name });
            }
        }
        Ok(())
    }
}

impl Pass {
    /// The surface lies so far below the taught places where a pin is to travel above it first \[mm\].
    fn clearance(&self, machine: &MachineFile) -> f64 {
        let set = machine.welding.sets.get(&self.weld);
        let stir = set.and_then(|set| set.stir);
        stir.map_or(0.0, |stir| stir.clearance_mm)
    }
}

/// `pose`, drawn back along the tool by so much \[mm\].
fn drawn_back(pose: &Pose, by: f64) -> Pose {
    Pose {
        position: pose.position + pose.normal * by,
        ..*pose
    }
}
