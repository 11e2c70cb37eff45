//! Both feet of a rib, for the dual-beam head (mathematics 0.5).

use crate::{Judgement, Kind, PartContext, Percent, Plan, Run, SeamLimits};
use anyhow::{Context, bail};
use dual_beam::{
    DualBeamPlan, PlanOptions, SeamPoint, TaughtSeams, plan_dual_beam, plan_taught, read_main_curve,
    read_other_curve,
};
use nalgebra::Vector3;
use serde::Deserialize;
use shared::kinematics::Kinematics;
use std::path::{Path, PathBuf};
use teach::seam::{SeamTeaching, read_seam_points};

/// Two seams and how to weld them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TSeam {
    /// Main seam as it is drawn, in the direction of travel (CSV x_mm,y_mm,z_mm,nx,ny,nz with the skin normal).
    seam_1: Option<PathBuf>,
    /// Seam on the other side of the rib as it is drawn (CSV x_mm,y_mm,z_mm).
    seam_2: Option<PathBuf>,
    /// Both seams as `seamwright teach` saw them; the program is planned from them and not from the drawing.
    taught: Option<PathBuf>,
    /// How they are taught.
    #[serde(default)]
    teaching: SeamTeaching,
    /// Speed of the tip \[m/min\].
    speed_m_min: f64,
    /// Power of each beam \[W\].
    power_w: f64,
    /// Cut both seams by the plane across seam 1, as the published method does.
    #[serde(default)]
    paper: bool,
    /// What the weld is judged by.
    #[serde(default)]
    limits: SeamLimits,
}

/// Seam 1 with normals, and seam 2.
type Curves = (Vec<SeamPoint>, Vec<Vector3<f64>>);

impl TSeam {
    /// How the seams are taught.
    pub fn teaching(&self) -> &SeamTeaching {
        &self.teaching
    }

    /// What the weld is judged by.
    pub fn limits(&self) -> &SeamLimits {
        &self.limits
    }

    /// Where the taught seams are, as the part file says.
    pub fn taught(&self) -> Option<&Path> {
        self.taught.as_deref()
    }

    /// Plans from the seams taught in `file`, and not from what the part file names.
    pub fn set_taught(&mut self, file: PathBuf) {
        self.taught = Some(file);
    }

    /// The weld as it is drawn, if the part has a drawing.
    pub fn drawn(&self, context: &PartContext) -> anyhow::Result<Option<DualBeamPlan>> {
        let Some(curves) = self.drawing(context)? else {
            return Ok(None);
        };
        Ok(Some(self.plan_of(&curves, context)?))
    }

    fn drawing(&self, context: &PartContext) -> anyhow::Result<Option<Curves>> {
        Ok(match (&self.seam_1, &self.seam_2) {
            (Some(first), Some(second)) => Some((
                read_main_curve(&context.directory.join(first))?,
                read_other_curve(&context.directory.join(second))?,
            )),
            (None, None) => None,
            _ => bail!("a drawing has two seams: seam_1 and seam_2"),
        })
    }

    /// The weld, and what a person should know of the curves that it is planned from.
    fn planned(&self, context: &PartContext) -> anyhow::Result<(DualBeamPlan, Vec<String>)> {
        if let Some(file) = &self.taught {
            let file = context.directory.join(file);
            let points = read_seam_points(&file)?;
            let seams = TaughtSeams::through(&points, self.teaching.least_quality)
                .with_context(|| file.display().to_string())?;
            return Ok((
                plan_taught(&seams, context.machine, &self.options(context))?,
                seams.notes(),
            ));
        }
        match self.drawing(context)? {
            Some(curves) => Ok((self.plan_of(&curves, context)?, Vec::new())),
            None => bail!("there is nothing to plan from: name seam_1 and seam_2, or taught"),
        }
    }

    fn options(&self, context: &PartContext) -> PlanOptions {
        PlanOptions {
            title: context.title.to_owned(),
            speed_m_min: self.speed_m_min,
            power_w: [self.power_w; 2],
            paper: self.paper,
        }
    }

    fn plan_of(&self, (main, other): &Curves, context: &PartContext) -> anyhow::Result<DualBeamPlan> {
        Ok(plan_dual_beam(
            main,
            other,
            context.machine,
            &self.options(context),
        )?)
    }

    /// Plans the pass of the measuring heads along the whole seam, beams off.
    pub fn plan_measuring(&self, context: &PartContext) -> anyhow::Result<String> {
        let (plan, _) = self.planned(context)?;
        Ok(plan.measuring_program(context.machine, context.title, self.speed_m_min)?)
    }
}

impl Kind for TSeam {
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan> {
        let (plan, mut notes) = self.planned(context)?;
        notes.insert(0, format!("{} points", plan.points.len()));
        notes.push(format!(
            "beam axes meet within {:.1e} mm; speed on seam 2 differs by up to {:.2} %",
            plan.max_gap,
            100.0 * plan.max_speed_difference
        ));
        Ok(Plan {
            program: plan.program,
            notes,
        })
    }

    /// Limits alone.
    fn check_judging(&self, _: &PartContext, _: &Kinematics) -> anyhow::Result<()> {
        Ok(())
    }

    /// The true seams are not part of the part file: they come from the simulated world, or from a
    /// measurement.
    fn judge(&self, _context: &PartContext, run: &Run) -> anyhow::Result<Judgement> {
        Ok(self.limits.judge(run))
    }

    fn speed_dip(&self) -> Option<Percent> {
        Some(self.limits.speed_dip())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PartFile;
    use config::machine::MachineFile;
    use teach::seam::{Head, MeasuredSeam, SeamFile, SeamPoint as TaughtPoint};

    fn shipped(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
    }

    /// Every third point of the shipped seams, as if they had been taught.
    fn taught(file: &Path) {
        let main = read_main_curve(&shipped("programs/t-seam-400-seam1.csv")).unwrap();
        let other = read_other_curve(&shipped("programs/t-seam-400-seam2.csv")).unwrap();
        let head = Head {
            machine: "gantry".into(),
            part: "t-seam-400".into(),
        };
        let mut opened = SeamFile::open(file, &head, false).unwrap();
        let mut before = None;
        for (first, second) in main.iter().zip(&other).step_by(3) {
            let feet = [first.position, *second].map(|position| MeasuredSeam {
                position,
                normal: first.normal.normalize(),
                width_mm: 0.05,
                quality: 0.9,
                scatter_mm: 0.001,
                pictures: 8,
                end: None,
            });
            let point = TaughtPoint::after(before.as_ref(), feet);
            opened.file.add(&point).unwrap();
            before = Some(point);
        }
    }

    #[test]
    fn a_part_is_planned_from_what_was_taught_and_tells_how_far_the_points_are() {
        let machine = MachineFile::read(&shipped("machines/dual-beam-gantry.toml")).unwrap();
        let part = PartFile::read(&shipped("programs/t-seam-400.toml")).unwrap();
        let drawn = part.plan(&machine, "drawn").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("taught.csv");
        taught(&file);
        let part = part.with_taught_seams(&file).unwrap();
        let plan = part.plan(&machine, "taught").unwrap();
        assert!(
            plan.notes[1].starts_with("seam 1: 27 taught points lie within 0.00"),
            "{:?}",
            plan.notes
        );
        assert!(plan.program != drawn.program);
        // The same beginning, to what the file and the smoothing leave of it.
        let word = |program: &str, letter: char| -> f64 {
            let block = program.lines().find(|line| line.contains("G0 X")).unwrap();
            let word = block.split(' ').find(|word| word.starts_with(letter)).unwrap();
            word[1..].parse().unwrap()
        };
        // The head turns a little more evenly than the skin.
        for (letter, near) in [('X', 0.1), ('Y', 0.1), ('A', 0.8), ('B', 0.8), ('C', 0.1)] {
            let (taught, drawn) = (word(&plan.program, letter), word(&drawn.program, letter));
            assert!(
                (taught - drawn).abs() < near,
                "{letter}{taught} and {letter}{drawn}"
            );
        }
    }

    #[test]
    fn without_a_drawing_and_without_points_there_is_nothing_to_plan() {
        let seam: TSeam = toml::from_str("speed_m_min = 5.0\npower_w = 2000.0").unwrap();
        let machine = MachineFile::read(&shipped("machines/dual-beam-gantry.toml")).unwrap();
        let context = PartContext {
            machine: &machine,
            directory: Path::new(""),
            title: "",
        };
        assert!(seam.drawn(&context).unwrap().is_none());
        let error = seam.plan(&context).unwrap_err().to_string();
        assert!(error.contains("name seam_1 and seam_2, or taught"), "{error}");
    }
}
