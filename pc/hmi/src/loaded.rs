//! What is loaded: a machine, and a program that was read, planned and predicted for it.

use crate::drawn::{Drawn, Listing, PathTime, Place, Way};
use anyhow::Context;
use cam::along::Along;
use cam::dry_run::{self, PathFigures};
use cam::path::{Course, PlannedPath, Planner, check_constant_speed};
use config::machine::MachineFile;
use config::weld_data::WeldData;
use host_link::geometry::MachineGeometry;
use nc::{Options, Program, Setup, interpret_file};
use parts::{PartFile, SeamLimits, TSeam};
use shared::geometry::Pose;
use shared::trajectory::PathSpace;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use world::Deviation;

/// Places of the tip that are kept of a program to draw it.
const DRAWN: usize = 600;

/// A machine file and a program that it can run.
#[derive(Debug)]
pub struct Loaded {
    /// The machine file.
    pub machine: MachineFile,
    /// Where that is.
    pub machine_file: PathBuf,
    /// Where the program is.
    pub program_file: PathBuf,
    /// The program.
    pub program: Arc<Program>,
    /// The same, as it is drawn.
    pub drawn: Drawn,
    /// The part that its run is judged by.
    pub part: Option<PartFile>,
    /// Where the tool is, by the axes.
    pub geometry: MachineGeometry,
    /// How the seams of a simulated machine deviate from the drawing.
    pub seam: Option<(PathBuf, Arc<Deviation>)>,
    /// What the interpreter and the planner say of it.
    pub notices: Vec<String>,
}

impl Loaded {
    /// Reads a program for a machine, plans it from where the machine stands after homing, from `from_line` on if that is told,
    /// and predicts its run.
    /// Part file, weld data and, for simulated machines, the deviation of the seams (`NAME-deviation.csv`) are those beside the
    /// program.
    ///
    /// # Errors
    /// A sentence with the file, the place and the reason.
    pub fn read(machine_file: &Path, program_file: &Path, from_line: Option<u32>) -> anyhow::Result<Self> {
        let mut machine = MachineFile::read(machine_file)?;
        machine.welding = WeldData::beside(program_file)?;
        let name = program_file.display();
        let text = std::fs::read(program_file).with_context(|| format!("cannot read program {name}"))?;
        let listing = Listing::of(&String::from_utf8_lossy(&text));
        let planner = Planner::build(&machine).with_context(|| machine_file.display().to_string())?;
        let program = interpreted(program_file, &machine, &planner)?;
        let part = PartFile::of_program(program_file)?;
        let from = machine.homed_axes();
        let of_program = || format!("program {name}");
        let mut paths = planner.program(&program, &from, None).with_context(of_program)?;
        let judged = part.as_ref().is_some_and(PartFile::keeps_feed);
        check_constant_speed(&paths, judged).with_context(of_program)?;
        if let Some(part) = &part {
            part.check_judging(&machine, planner.kinematics())
                .with_context(|| format!("part {}", part.path().display()))?;
        }
        if let Some(line) = from_line {
            paths = planner
                .from_line(&program, paths, line, &from)
                .with_context(of_program)?;
        }
        let predicted = dry_run::run(&machine, &planner, &paths, 1.0).with_context(of_program)?;
        let said = program
            .notices
            .iter()
            .map(|notice| format!("{}: {}", notice.place, notice.text));
        let notices = said.chain(planner.notices(&program)).collect();
        let drawn = Drawn {
            name: file_name(program_file),
            from_line,
            listing,
            way: way(&planner, paths),
            motion: machine.motion.clone(),
            is_tracked: machine.tracking.is_some(),
            deviation_limit_mm: deviation_limit_mm(&machine, part.as_ref()),
            duration_s: predicted.duration_s,
            paths: predicted.paths.iter().map(path_time).collect(),
        };
        Ok(Self {
            machine_file: machine_file.to_owned(),
            program_file: program_file.to_owned(),
            drawn,
            part,
            geometry: MachineGeometry::build(&machine.motion)
                .with_context(|| machine_file.display().to_string())?,
            seam: deviation_beside(program_file)?,
            notices,
            machine,
            program: Arc::new(program),
        })
    }
}

/// A program's name, as people call it.
fn file_name(program: &Path) -> String {
    program
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Largest distance of a spot from its seam that the run is judged by \[mm\], if the machine follows seams.
fn deviation_limit_mm(machine: &MachineFile, part: Option<&PartFile>) -> Option<f64> {
    machine.tracking.as_ref()?;
    let shipped = SeamLimits::default();
    let of_part = part.and_then(PartFile::t_seam);
    Some(of_part.map_or(&shipped, TSeam::limits).deviation_mm())
}

fn path_time(path: &PathFigures) -> PathTime {
    PathTime {
        start_s: path.start_s,
        duration_s: path.duration_s,
        length_mm: path.length_mm,
    }
}

/// The program in `file`, for a machine that stands at its reference marks.
fn interpreted(file: &Path, machine: &MachineFile, planner: &Planner) -> anyhow::Result<Program> {
    let setup = Setup {
        folders: file.parent().map(Path::to_owned).into_iter().collect(),
        ..planner.setup(&machine.homed_axes())
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    let name = file.display();
    let opened = File::open(file).with_context(|| format!("cannot read program {name}"))?;
    interpret_file(opened, options).with_context(|| format!("program {name}"))
}

/// Where the deviation of the seams of `program` is, if there is one.
pub(crate) fn deviation_file(program: &Path) -> PathBuf {
    let stem = program.file_stem().unwrap_or_default().to_string_lossy();
    program.with_file_name(format!("{stem}-deviation.csv"))
}

/// The deviation of the seams beside `program`.
pub(crate) fn deviation_beside(program: &Path) -> anyhow::Result<Option<(PathBuf, Arc<Deviation>)>> {
    let file = deviation_file(program);
    if !file.exists() {
        return Ok(None);
    }
    let deviation = Arc::new(Deviation::read(&file)?);
    Ok(Some((file, deviation)))
}

/// Where the tip goes on `paths` in order, as a job numbers them.
fn way(planner: &Planner, paths: Vec<PlannedPath>) -> Way {
    let paths: BTreeMap<u32, PlannedPath> = (1..).zip(paths).collect();
    let along = Along::of(&paths);
    let length: f64 = paths.values().map(PlannedPath::length_mm).sum();
    let step = length / DRAWN as f64;
    let mut places = Vec::new();
    for (id, path) in &paths {
        let length = path.length_mm();
        let steps = ((length / step.max(f64::MIN_POSITIVE)).ceil() as usize).clamp(1, DRAWN);
        let course = path.path();
        for index in 0..=steps {
            let s = length * index as f64 / steps as f64;
            places.extend(pose_at(planner, path.space, &course, s).map(|pose| Place {
                pose,
                along_mm: along.at(*id, s),
                line: path.line_at(s),
            }));
        }
    }
    Way { along, places }
}

/// The pose at `s_mm` of a path.
fn pose_at(planner: &Planner, space: PathSpace, course: &Course, s_mm: f64) -> Option<Pose> {
    let point = course.at(s_mm)?;
    match space {
        PathSpace::Tool => point.pose().ok(),
        PathSpace::Axes => Some(planner.kinematics().forward(&point.axes().position)),
    }
}
