//! Both feet of a rib, for the dual-beam head (SPEC 0.5).

use super::{Judgement, Kind, Place, Plan, Run};
use crate::plan::{PlanOptions, plan_dual_beam};
use crate::seam::{read_main_curve, read_other_curve};
use serde::Deserialize;
use std::path::PathBuf;

/// Two seams and how to weld them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TSeam {
    /// Main seam, in the direction of travel (CSV x_mm,y_mm,z_mm,nx,ny,nz with the skin normal).
    seam_1: PathBuf,
    /// Seam on the other side of the rib (CSV x_mm,y_mm,z_mm).
    seam_2: PathBuf,
    /// Speed of the tip \[m/min\].
    speed_m_min: f64,
    /// Power of each beam \[W\].
    power_w: f64,
    /// Cut both seams by the plane across seam 1, as the published method does.
    #[serde(default)]
    paper: bool,
}

impl Kind for TSeam {
    fn plan(&self, place: &Place) -> anyhow::Result<Plan> {
        let main = read_main_curve(&place.directory.join(&self.seam_1))?;
        let other = read_other_curve(&place.directory.join(&self.seam_2))?;
        let options = PlanOptions {
            title: place.title.to_owned(),
            speed_m_min: self.speed_m_min,
            power_w: [self.power_w; 2],
            paper: self.paper,
        };
        let plan = plan_dual_beam(&main, &other, place.machine, &options)?;
        let notes = vec![
            format!("{} points", plan.points.len()),
            format!(
                "beam axes meet within {:.1e} mm; speed on seam 2 differs by up to {:.2} %",
                plan.max_gap,
                100.0 * plan.max_speed_difference
            ),
        ];
        Ok(Plan {
            program: plan.program,
            notes,
        })
    }

    /// The seams as they really are are not the part's: the tracker follows them, and the report has its
    /// figures of every weld.
    fn judge(&self, _place: &Place, _run: &Run) -> anyhow::Result<Judgement> {
        Ok(Judgement::default())
    }
}
