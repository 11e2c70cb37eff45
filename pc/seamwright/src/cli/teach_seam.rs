//! `seamwright teach` for the seams of a rib: by the cameras.

use super::boards::{BoardArgs, exit_code};
use super::cameras::CameraArgs;
use super::read_program;
use crate::console::outln;
use crate::terminal::Operator;
use anyhow::{Context, anyhow, bail};
use cam::path::{Planner, Tip};
use clap::Args;
use config::machine::MachineFile;
use dual_beam::DualBeamPlan;
use job::{Job, JobError, Names, SeamLesson, TaughtSeam, Work};
use nc::{Options, Program, interpret};
use parts::PartFile;
use shared::io::{SIDES, SLIDES};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::{Arc, Mutex};
use teach::seam::{Cameras, Drawing, Ended, Head, MachinePose, SeamEnd, SeamFile};
use world::Deviation;
use world::{Surroundings, Workpiece};

/// A seam that ends more than this before its drawing does was lost \[mm\].
const ENDS_EARLY: f64 = 5.0;

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

/// What the part and its drawing say.
struct Lesson {
    start: MachinePose,
    drawing: Option<Drawing>,
    cameras: Cameras,
    /// The program of the drawing, to which a simulated seam belongs.
    drawn: Option<Program>,
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
        let prepared = self
            .prepare(machine, part)
            .with_context(|| format!("part {}", name(part.path())))?;
        let deviation = self.seam.as_deref().map(Deviation::read).transpose()?;
        let output = output_of(output, part, seam.taught())?;
        let head = Head {
            machine: machine.name.clone(),
            part: part
                .path()
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
        };
        let opened = SeamFile::open(&output, &head, self.restart)?;
        opened.notes.iter().for_each(|note| outln!("{note}"));
        if !opened.points.is_empty() {
            outln!(
                "{}: continues after point {}",
                output.display(),
                opened.points.len()
            );
        }
        let lesson = SeamLesson {
            start: prepared.start,
            drawing: prepared.drawing,
            config: *seam.teaching(),
            cameras: prepared.cameras,
            points: opened.points,
            file: Mutex::new(opened.file),
            head,
            by_jog: self.jog,
        };
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
                drawing: prepared.drawn.map(Arc::new),
                cameras,
                seed,
                mounts: boards.mounts(machine)?,
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
            (Some(taught), None) => tell(&output, &taught),
            (_, error) => {
                outln!(
                    "{}: the points taught so far; the same command continues after them",
                    output.display()
                );
                exit_code(error)
            }
        }
    }

    fn prepare(&self, machine: &MachineFile, part: &PartFile) -> anyhow::Result<Lesson> {
        let unit = machine.tracking.as_ref();
        let unit = unit.context("the machine has no cameras to teach a seam with")?;
        anyhow::ensure!(
            unit.board.sides().len() == SIDES,
            "the machine has one camera, and a seam is taught with two"
        );
        let cameras = Cameras::of(unit)?;
        let drawn = part.drawn(machine)?;
        let (start, drawing) = self.start(machine, drawn.as_ref(), &cameras)?;
        let program = match (&self.seam_of, drawn) {
            (Some(file), _) => Some(read_program(file, machine, Options::default())?),
            (None, Some(plan)) => Some(interpret(&plan.program, Options::default())?),
            (None, None) if self.seam.is_some() => {
                bail!("the part has no drawing that --seam could deviate from: name its program by --seam-of")
            }
            (None, None) => None,
        };
        Ok(Lesson {
            start,
            drawing,
            cameras,
            drawn: program,
        })
    }

    fn start(
        &self,
        machine: &MachineFile,
        drawn: Option<&DualBeamPlan>,
        cameras: &Cameras,
    ) -> anyhow::Result<(MachinePose, Option<Drawing>)> {
        let drawing = drawn.map(DualBeamPlan::drawing);
        let start = match (self.from, drawn) {
            (Some(from), _) => MachinePose {
                pose: Planner::build(machine)?.pose(&from.tip()),
                slides_mm: [0.0; SLIDES],
            },
            (None, Some(plan)) => plan.stance_before(cameras.heads.camera_lead()),
            (None, None) => {
                bail!("the part has no drawing, so the start is unknown: give it with --from")
            }
        };
        Ok((start, drawing))
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

/// Tells how a lesson ended.
fn tell(output: &Path, taught: &TaughtSeam) -> anyhow::Result<ExitCode> {
    outln!("{}: {} points", output.display(), taught.points);
    if let Some((ends, after)) = taught.begins {
        outln!(
            "  the seam begins {after:.2} mm after its drawing does: {}",
            ends_of(&ends, "begins").unwrap_or_default()
        );
    }
    match taught.ended {
        Ended::Drawn => outln!("  the seam is taught as far as it is drawn"),
        Ended::Operator => outln!("  ended by the operator; the same command continues after the last point"),
        Ended::SeamEnds {
            s_mm,
            missing_mm,
            seen,
            ends,
        } => match (ends_of(&ends, "ends"), missing_mm) {
            (Some(how), Some(missing)) => {
                outln!(
                    "  the seam ends {s_mm:.2} mm from its beginning, {missing:.2} mm before its drawing does: {how}"
                );
            }
            (Some(how), None) => outln!("  the seam ends {s_mm:.2} mm from its beginning: {how}"),
            (None, Some(missing)) if missing > ENDS_EARLY => {
                let side = match seen {
                    [true, false] => "on side 2 only",
                    [false, true] => "on side 1 only",
                    _ => "on both sides",
                };
                return exit_code(Some(JobError::Teach(format!(
                    "the seam is lost {s_mm:.1} mm from its beginning, {side}, {missing:.1} mm before its drawing ends: \
                     if it does not end there, check what covers it and whether the light works; the same command continues \
                     after the last point"
                ))));
            }
            _ => outln!("  the seam ends {s_mm:.1} mm from its beginning"),
        },
    }
    Ok(ExitCode::SUCCESS)
}

/// What is seen to begin or end the seam of each side; none if nothing is.
fn ends_of(ends: &[Option<SeamEnd>; SIDES], verb: &str) -> Option<String> {
    let said = |end: SeamEnd, sides: &str| match end {
        SeamEnd::Plate => format!("a plate {verb} there on {sides}"),
        SeamEnd::Tack => format!("the gap is closed there on {sides}, as by a tack"),
    };
    match *ends {
        [None, None] => None,
        [Some(first), Some(second)] if first == second => Some(said(first, "both sides")),
        [Some(first), Some(second)] => Some(format!("{}, {}", said(first, "side 1"), said(second, "side 2"))),
        [Some(end), None] => Some(said(end, "side 1")),
        [None, Some(end)] => Some(said(end, "side 2")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_each_side_is_said() {
        let (plate, tack) = (Some(SeamEnd::Plate), Some(SeamEnd::Tack));
        for (ends, said) in [
            ([plate, plate], "a plate ends there on both sides"),
            (
                [plate, tack],
                "a plate ends there on side 1, the gap is closed there on side 2, as by a tack",
            ),
            ([None, tack], "the gap is closed there on side 2, as by a tack"),
        ] {
            assert_eq!(ends_of(&ends, "ends").as_deref(), Some(said));
        }
        assert_eq!(ends_of(&[None; SIDES], "ends"), None);
    }
}
