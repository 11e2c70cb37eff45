//! The saddle of a branch pipe on a main pipe, for a welder that turns about the branch (mathematics 1).
//!
//! The torch stands on the bisector of the groove, as near as four axes take it there: their tilt realises the
//! part of it in the plane of waist and branch axis, the rest is in the notes of the plan and in the figures of
//! the run.

mod error;
mod fit;
mod judge;
mod least_squares;
pub mod pipes;
mod program;
mod round;
mod seam;
mod taught;
#[cfg(test)]
mod tests;

pub use error::{SaddlePartError, TaughtError};

use crate::limits::SPEED_DIP;
use crate::{Judgement, Kind, Limit, PartContext, Percent, Plan, Run};
use config::in_range;
use fit::Known;
use pipes::PipePair;
use seam::{Offset, Placement, Seam};
use serde::Deserialize;
use shared::kinematics::Kinematics;
use std::path::{Path, PathBuf};

/// Two pipes and how to weld them.
///
/// The frame of the work is that of the branch: Z along its axis, away from the main pipe. By dimensions alone, Z
/// is 0 where that axis passes the main axis, and waist 0 is the side towards which it stands off the main axis.
///
/// Taught points say where the machine is clamped instead, and dimensions that are not given are found from them:
/// from 3 points where it is clamped, from 4 also offset or angle, from 5 both, from 6 the diameter of the main pipe
/// as well; the diameter of the branch shows in every point. A seam that is still uncertain is refused.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saddle {
    /// Outer diameter of the main pipe \[mm\].
    main_diameter_mm: Option<f64>,
    /// Outer diameter of the branch \[mm\].
    branch_diameter_mm: Option<f64>,
    /// Angle between the axes \[°\], 90 for a square branch. Below 90 the seam is lowest and the groove widest
    /// at waist 90°, above 90 at waist 270°.
    angle_deg: Option<f64>,
    /// Distance of the axes \[mm\], towards waist 0.
    offset_mm: Option<f64>,
    /// Points taught with the tip on the seam, in axes of the machine (CSV X_mm,Z_mm,B_deg,C_deg).
    taught: Option<PathBuf>,
    /// Farthest that a taught point may lie off the seam, and most that the seam may be uncertain \[mm\].
    #[serde(default = "default_within")]
    taught_within_mm: f64,
    /// Waist where the passes begin \[°\]; where the machine has most travel to either side, if not given.
    start_deg: Option<f64>,
    /// How far a pass continues past its start \[mm of the seam\].
    #[serde(default = "default_overlap")]
    overlap_mm: f64,
    /// In the order of welding, each once around.
    passes: Vec<Pass>,
    /// What the weld is judged by.
    #[serde(default)]
    limits: SaddleLimits,
}

/// What a run is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SaddleLimits {
    /// Largest distance of the tip from the exact saddle, servo included \[mm\].
    distance_mm: Limit,
    /// Largest angle of the torch with the bisector of the groove, in the plane of the tilt \[°\].
    bisector_deg: Limit,
    /// Most that the speed may fall below the feed with the beam on \[%\].
    speed_dip_percent: Percent,
}

impl Default for SaddleLimits {
    fn default() -> Self {
        Self {
            distance_mm: Limit::new(0.01),
            bisector_deg: Limit::new(0.1),
            speed_dip_percent: SPEED_DIP,
        }
    }
}

/// Once around the branch.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pass {
    /// Tip outwards from the saddle, away from the branch axis \[mm\].
    #[serde(default)]
    radial_mm: f64,
    /// Tip from the saddle along the branch, away from the main pipe \[mm\].
    #[serde(default)]
    axial_mm: f64,
    /// Speed of the tip \[mm/s\].
    speed_mm_s: f64,
    /// Power of the arc \[W\].
    power_w: f64,
}

impl Pass {
    fn offset(&self) -> Offset {
        Offset {
            radial: self.radial_mm,
            axial: self.axial_mm,
        }
    }
}

fn default_overlap() -> f64 {
    5.0
}

fn default_within() -> f64 {
    0.5
}

impl Saddle {
    /// The seam, by the dimensions or by taught points, and what a person should know of it; all keys checked.
    fn seam(&self, directory: &Path, kinematics: &Kinematics) -> anyhow::Result<(Seam, Vec<String>)> {
        let (seam, notes) = match &self.taught {
            Some(file) => {
                let within = self.taught_within_mm;
                in_range("taught_within_mm", within, within > 0.0, "above 0")?;
                taught::seam(&directory.join(file), kinematics, &self.known()?, within)?
            }
            None => (self.seam_of_dimensions()?, Vec::new()),
        };
        self.check(&seam)?;
        Ok((seam, notes))
    }

    fn seam_of_dimensions(&self) -> Result<Seam, SaddlePartError> {
        let need = |key, value: Option<f64>| value.ok_or(SaddlePartError::Missing { key });
        let known = self.known()?;
        let main = need("main_diameter_mm", known.main_radius)?;
        let branch = need("branch_diameter_mm", known.branch_radius)?;
        let angle = need("angle_deg", known.angle)?;
        let offset = need("offset_mm", known.offset)?;
        let pair = PipePair::new(main, branch, angle, offset).map_err(SaddlePartError::of_pipes)?;
        Seam::new(pair, offset, Placement::default())
    }

    /// The dimensions that are given, each for itself checked.
    fn known(&self) -> Result<Known, SaddlePartError> {
        let (main, branch) = (self.main_diameter_mm, self.branch_diameter_mm);
        for (key, value) in [("main_diameter_mm", main), ("branch_diameter_mm", branch)] {
            if let Some(value) = value {
                in_range(key, value, value > 0.0, "above 0")?;
            }
        }
        if let Some(value) = self.angle_deg {
            let ok = value > 0.0 && value < 180.0;
            in_range("angle_deg", value, ok, "above 0 and below 180")?;
        }
        if let Some(value) = self.offset_mm {
            in_range("offset_mm", value, true, "a finite number")?;
        }
        Ok(Known {
            main_radius: main.map(|diameter| diameter / 2.0),
            branch_radius: branch.map(|diameter| diameter / 2.0),
            angle: self.angle_deg.map(f64::to_radians),
            offset: self.offset_mm,
        })
    }

    fn check(&self, seam: &Seam) -> Result<(), SaddlePartError> {
        let branch_radius = seam.pair().branch_radius();
        let short = (0.0..=seam.length() / 4.0).contains(&self.overlap_mm);
        let requirement = "0 or more, and at most a quarter of the seam";
        in_range("overlap_mm", self.overlap_mm, short, requirement)?;
        if let Some(value) = self.start_deg {
            in_range("start_deg", value, true, "a finite number")?;
        }
        if self.passes.is_empty() {
            return Err(SaddlePartError::NoPasses);
        }
        for (index, pass) in self.passes.iter().enumerate() {
            let short_of_axis = branch_radius + pass.radial_mm > 0.0;
            let values = [
                (
                    "radial_mm",
                    pass.radial_mm,
                    short_of_axis,
                    "a number, and not beyond the branch axis",
                ),
                ("axial_mm", pass.axial_mm, true, "a finite number"),
                ("speed_mm_s", pass.speed_mm_s, pass.speed_mm_s > 0.0, "above 0"),
                ("power_w", pass.power_w, pass.power_w >= 0.0, "0 or more"),
            ];
            for (key, value, ok, requirement) in values {
                in_range(format!("{key} of pass {}", index + 1), value, ok, requirement)?;
            }
        }
        Ok(())
    }
}

impl Kind for Saddle {
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan> {
        let (seam, notes) = self.seam(context.directory, &context.machine.motion.kinematics()?)?;
        program::plan(self, &seam, notes, context)
    }

    fn check_judging(&self, context: &PartContext, kinematics: &Kinematics) -> anyhow::Result<()> {
        self.seam(context.directory, kinematics).map(drop)
    }

    fn judge(&self, context: &PartContext, run: &Run) -> anyhow::Result<Judgement> {
        let (seam, _) = self.seam(context.directory, run.kinematics)?;
        judge::judge(self, &seam, run)
    }

    fn speed_dip(&self) -> Option<Percent> {
        Some(self.limits.speed_dip_percent)
    }
}
