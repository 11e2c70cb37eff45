//! `seamwright teach` for the seams of a rib: by the cameras.

use super::boards::{BoardArgs, exit_code};
use super::cameras::CameraArgs;
use super::read_program;
use crate::console::outln;
use crate::terminal::Operator;
use anyhow::{Context, anyhow, bail};
use cam::path::Tip;
use clap::Args;
use config::machine::MachineFile;
use job::{Job, LessonOptions, Names, SeamLesson, Work};
use nc::{Options, Program, interpret};
use parts::PartFile;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;
use world::Deviation;
use world::{Surroundings, Workpiece};

/// What only seams are taught with.
#[derive(Debug, Args)]
pub struct SeamArgs {
    /// Seams and places: where the tip goes first; for the cameras one camera lead before the first point, in place of the
    /// beginning of the drawing
    #[arg(long, value_name = "X,Y,Z,A,B,C", allow_hyphen_values = true)]
    pub(super) from: Option<TipPose>,
    /// Seams: the operator jogs the machine, by commands on standard input
    #[arg(long)]
    jog: bool,
    /// Seams and places: start over; the points taught before are kept under another name
    #[arg(long)]
    pub(super) restart: bool,
    /// Seams: how the real ones deviate from the drawing (CSV), for emulated and simulated boards
    #[arg(long, value_name = "DEVIATION")]
    seam: Option<PathBuf>,
    /// Seams: the program planned from the drawing, from which --seam deviates [default: that of the part]
    #[arg(long, value_name = "DRAWING", requires = "seam")]
    seam_of: Option<PathBuf>,
    #[command(flatten)]
    eyes: CameraArgs,
}

/// X Y Z \[mm\] A B C \[deg\] of the tip.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipPose([f64; 6]);

impl FromStr for TipPose {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split(',').map(|number| number.trim().parse::<f64>());
        let numbers: Vec<f64> = numbers
            .collect::<Result<_, _>>()
            .map_err(|_| "must be six finite numbers")?;
        let place: [f64; 6] = numbers
            .try_into()
            .map_err(|_| "must be six numbers: X,Y,Z in mm and A,B,C in degrees")?;
        let finite = place.iter().all(|number| number.is_finite());
        finite.then_some(Self(place)).ok_or("must be six finite numbers")
    }
}

impl TipPose {
    pub(super) fn tip(&self) -> Tip {
        let Self([x, y, z, a, b, c]) = *self;
        Tip {
            position_mm: [x, y, z],
            angles_deg: [a, b, c],
            ..Tip::default()
        }
    }
}

impl SeamArgs {
    /// Refuses what a panel is not taught with.
    pub fn refuse(&self) -> anyhow::Result<()> {
        let told = [(self.from.is_some(), "--from"), (self.restart, "--restart")];
        let told = told.into_iter().find_map(|(told, name)| told.then_some(name));
        match told {
            Some(name) => bail!("{name} is for parts with seams ([t-seam], [seam]), and this part has none"),
            None => self.refuse_cameras(),
        }
    }

    /// Refuses what only the cameras need.
    pub(super) fn refuse_cameras(&self) -> anyhow::Result<()> {
        let seam = self.seam.is_some().then_some("--seam");
        let jog = self.jog.then_some("--jog");
        match seam.or(jog).or(self.eyes.of_pictures()) {
            Some(name) => {
                bail!("{name} is for parts with seams that cameras see ([t-seam]), and this part has none")
            }
            None => Ok(()),
        }
    }

    /// Teaches the seams of `part`.
    pub fn teach(
        &self,
        boards: &BoardArgs,
        (machine, machine_path): (&MachineFile, &Path),
        part: &PartFile,
        output: Option<&Path>,
        seed: u64,
    ) -> anyhow::Result<ExitCode> {
        let seam = part
            .t_seam()
            .ok_or_else(|| anyhow!("the part has no seams to teach"))?;
        let name = |path: &Path| path.display().to_string();
        let deviation = self.seam.as_deref().map(Deviation::read).transpose()?;
        let drawn = self
            .drawn(machine, part)
            .with_context(|| format!("part {}", name(part.path())))?;
        let output = output_of(output, part, seam.taught())?;
        let options = LessonOptions {
            from: self.from.map(|from| from.tip()),
            restart: self.restart,
            by_jog: self.jog,
        };
        let (lesson, notes) = SeamLesson::of(machine, part, &output, &options)?;
        notes.iter().for_each(|note| outln!("{note}"));
        if !lesson.points.is_empty() {
            outln!(
                "{}: continues after point {}",
                output.display(),
                lesson.points.len()
            );
        }
        let cameras = self.eyes.choose(machine, machine_path, &boards.choice)?;
        let keepers = self.eyes.keep(&cameras)?;
        let job = Job {
            machine,
            work: Work::TeachSeam(&lesson),
            part: None,
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings {
                seam: deviation.map(Arc::new),
                drawing: drawn.map(Arc::new),
                cameras,
                seed,
                truth: boards.truth(machine)?,
                work: Workpiece::Seams,
            }
            .into(),
            spooling: Default::default(),
            names: Names {
                program: name(part.path()),
                machine: name(machine_path),
                seam: self.seam.as_deref().map(name),
                boards: boards.name(),
            },
        };
        let ended = match boards.run(&job, Operator::LeadsByLines { always: self.jog }, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        keepers.end();
        match (ended.taught.seam, ended.error) {
            (Some(taught), None) => {
                outln!("{}: {} points", output.display(), taught.points);
                match taught.told() {
                    Ok(told) => told.iter().for_each(|sentence| outln!("  {sentence}")),
                    Err(error) => return exit_code(Some(error)),
                }
                Ok(ExitCode::SUCCESS)
            }
            (_, error) => {
                outln!(
                    "{}: the points taught so far; the same command continues after them",
                    output.display()
                );
                exit_code(error)
            }
        }
    }

    /// The program from which a simulated seam deviates.
    fn drawn(&self, machine: &MachineFile, part: &PartFile) -> anyhow::Result<Option<Program>> {
        match (&self.seam_of, part.drawn(machine)?) {
            (Some(file), _) => Ok(Some(read_program(file, machine, Options::default())?)),
            (None, Some(plan)) => Ok(Some(interpret(&plan.program, Options::default())?)),
            (None, None) if self.seam.is_some() => {
                bail!("the part has no drawing that --seam could deviate from: name its program by --seam-of")
            }
            (None, None) => Ok(None),
        }
    }
}

/// Where the points are written: as given, or where the part file expects them.
pub(super) fn output_of(
    told: Option<&Path>,
    part: &PartFile,
    taught: Option<&Path>,
) -> anyhow::Result<PathBuf> {
    match (told, taught) {
        (Some(told), _) => Ok(told.to_owned()),
        (None, Some(taught)) => Ok(part.path().parent().unwrap_or(Path::new("")).join(taught)),
        (None, None) => bail!("where should the points be written? give --output FILE"),
    }
}
