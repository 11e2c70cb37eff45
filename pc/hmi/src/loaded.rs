//! What is loaded: a machine, and a program that was read, planned and predicted for it.

use anyhow::Context;
use cam::along::Along;
use cam::dry_run::{self, DryRun};
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
    /// Line that its run begins at, in place of its beginning.
    pub from_line: Option<u32>,
    /// The program.
    pub program: Program,
    /// Its text, a line each.
    pub lines: Vec<String>,
    /// The part that its run is judged by.
    pub part: Option<PartFile>,
    /// Where the tool is, by the axes.
    pub geometry: MachineGeometry,
    /// How the seams of a simulated machine deviate from the drawing.
    pub seam: Option<(PathBuf, Arc<Deviation>)>,
    /// What the interpreter and the planner say of it.
    pub notices: Vec<String>,
    /// Its run as it is predicted.
    pub predicted: DryRun,
    /// The way of the tip on it.
    pub way: Way,
}

/// Where the tip goes in a program.
#[derive(Debug, Default)]
pub struct Way {
    /// Path length through all that works; see [`Along`].
    pub along: Along,
    /// Places in order.
    pub places: Vec<Place>,
}

/// A place of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position and attitude in the frame of the work.
    pub pose: Pose,
    /// Path length \[mm\], as [`Along`] counts it; `None` on a way to the work.
    pub along_mm: Option<f64>,
    /// Line of the program.
    pub line: u32,
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
        let lines = String::from_utf8_lossy(&text)
            .lines()
            .map(str::to_owned)
            .collect();
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
        Ok(Self {
            machine_file: machine_file.to_owned(),
            program_file: program_file.to_owned(),
            from_line,
            lines,
            part,
            geometry: MachineGeometry::build(&machine.motion)
                .with_context(|| machine_file.display().to_string())?,
            seam: deviation_beside(program_file)?,
            notices,
            predicted,
            way: Way::of(&planner, paths),
            machine,
            program,
        })
    }

    /// The program's name, as people call it.
    pub fn name(&self) -> String {
        let name = self.program_file.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// Largest distance of a spot from its seam that the run is judged by \[mm\], if the machine follows seams.
    pub fn deviation_limit_mm(&self) -> Option<f64> {
        self.machine.tracking.as_ref()?;
        let of_part = self.part.as_ref().and_then(PartFile::t_seam);
        let shipped = SeamLimits::default();
        Some(of_part.map_or(&shipped, TSeam::limits).deviation_mm())
    }

    /// Where its work begins.
    pub fn begins_at(&self) -> Option<&Place> {
        self.way.places.iter().find(|place| place.along_mm.is_some())
    }

    /// Time from `s_mm` of path `id` on to the end, at the programmed feed \[s\]; of all for a path that is none of the program's.
    pub fn remaining_s(&self, id: u32, s_mm: f64) -> f64 {
        let paths = &self.predicted.paths;
        let Some(path) = (id as usize).checked_sub(1).and_then(|index| paths.get(index)) else {
            return self.predicted.duration_s;
        };
        let share = (s_mm / path.length_mm.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        self.predicted.duration_s - path.start_s - share * path.duration_s
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

/// The deviation of the seams beside `program`.
fn deviation_beside(program: &Path) -> anyhow::Result<Option<(PathBuf, Arc<Deviation>)>> {
    let stem = program.file_stem().unwrap_or_default().to_string_lossy();
    let file = program.with_file_name(format!("{stem}-deviation.csv"));
    if !file.exists() {
        return Ok(None);
    }
    let deviation = Arc::new(Deviation::read(&file)?);
    Ok(Some((file, deviation)))
}

impl Way {
    /// Length along all that works, from where the first beam goes on \[mm\].
    pub fn work_mm(&self) -> f64 {
        self.places
            .iter()
            .filter_map(|place| place.along_mm)
            .fold(0.0, f64::max)
    }

    /// Of `paths` in order, as a job numbers them.
    fn of(planner: &Planner, paths: Vec<PlannedPath>) -> Self {
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
        Self { along, places }
    }
}

/// The pose at `s_mm` of a path.
fn pose_at(planner: &Planner, space: PathSpace, course: &Course, s_mm: f64) -> Option<Pose> {
    let point = course.at(s_mm)?;
    match space {
        PathSpace::Tool => point.pose().ok(),
        PathSpace::Axes => Some(planner.kinematics().forward(&point.axes().position)),
    }
}
