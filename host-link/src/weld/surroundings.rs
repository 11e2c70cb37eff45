//! What is around the machine: the seams as they really are.

use super::{Job, JobError};
use crate::calibration::Calibration;
use crate::camera::{Camera, CameraError, Shelf};
use crate::machine::MachineFile;
use crate::nc::Program;
use crate::path::{PlannedPath, Planner};
use crate::seam::{Deviation, SeamError, check_facing};
use crate::world::{SceneFile, TrueSeams};
use shared::io::{AXES, SIDES};
use shared::protocol::{PathAction, PathEvent};
use std::rc::Rc;

/// What is around the machine.
#[derive(Clone)]
pub struct Surroundings<'a> {
    /// How the true seams deviate from the drawing, if there are any.
    pub seam: Option<Rc<Deviation>>,
    /// The program that is planned from the drawing, where the job runs another one.
    pub drawing: Option<&'a Program>,
    /// How the seams are seen.
    pub cameras: CameraChoice,
    /// Start of all noise.
    pub seed: u64,
}

/// How the seams are seen.
#[derive(Clone, Default)]
pub enum CameraChoice {
    /// By geometry, without pictures.
    #[default]
    Geometric,
    /// In pictures.
    Images(Box<ImageCameras>),
}

/// Cameras that give pictures.
#[derive(Clone)]
pub struct ImageCameras {
    /// What is known of camera 1 and 2.
    pub calibrations: [Calibration; SIDES],
    /// Where their pictures come from.
    pub source: PictureSource,
    /// Where copies of the pictures of a side (0 or 1) go, if anywhere.
    pub kept: Option<(usize, Shelf)>,
}

/// Where pictures come from.
#[derive(Clone)]
pub enum PictureSource {
    /// Rendered, of seams that look like this.
    Rendered(SceneFile),
    /// From real cameras: opens that of a side (0 or 1).
    Real(OpenCamera),
}

/// Opens the camera of a side (0 or 1).
pub type OpenCamera = Rc<dyn Fn(usize) -> Result<Box<dyn Camera>, CameraError>>;

impl Default for Surroundings<'_> {
    fn default() -> Self {
        Self {
            seam: None,
            drawing: None,
            cameras: CameraChoice::default(),
            seed: 1,
        }
    }
}

impl Surroundings<'_> {
    /// The seams as they really are, beside those of the drawing, or else of the job's `own` paths; none on a machine
    /// that follows no seam.
    ///
    /// # Errors
    /// [`JobError::Drawing`], [`JobError::Parameter`].
    pub fn seams(
        &self,
        machine: &MachineFile,
        planner: &Planner,
        own: &[PlannedPath],
    ) -> Result<Option<TrueSeams>, JobError> {
        let Some(unit) = &machine.tracking else {
            return Ok(None);
        };
        let heads = unit.board.head.build()?;
        let Some(deviation) = &self.seam else {
            return Ok(Some(TrueSeams::none(heads)));
        };
        let seams = match self.drawing {
            None => TrueSeams::beside(heads, own, deviation),
            Some(drawing) => {
                let drawn = planner
                    .program(drawing, &machine.planning.park_axes(), None)
                    .map_err(JobError::Drawing)?;
                TrueSeams::beside(heads, &drawn, deviation)
            }
        };
        Ok(Some(seams))
    }
}

/// A job that is planned.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Its paths.
    pub paths: Vec<PlannedPath>,
    /// The seams as they really are, on a machine that can follow one.
    pub seams: Option<TrueSeams>,
}

impl Job<'_> {
    /// Plans `program` from where the axes stand at `from` (mm, degrees), and checks that the machine can do
    /// all of it.
    ///
    /// # Errors
    /// [`JobError::Path`], [`JobError::FromLine`], [`JobError::Seam`] or [`JobError::Drawing`].
    pub fn plan(
        &self,
        program: &Program,
        planner: &Planner,
        from: &[f64; AXES],
    ) -> Result<Planned, JobError> {
        let speed = self
            .speed_m_per_min
            .map(|speed| speed * shared::units::MM_S_PER_M_MIN);
        let paths = planner.program(program, from, speed)?;
        let around = &self.surroundings;
        let seams = around.seams(self.machine, planner, &paths)?;
        match (&seams, &around.seam, around.drawing) {
            (Some(seams), Some(_), Some(_)) => paths
                .iter()
                .filter(|path| path.weld().is_some())
                .try_for_each(|path| check_facing(seams, path, self.machine))?,
            (_, seam, _) => check_seam(&paths, self.machine, seam.as_deref())?,
        }
        let paths = match self.from_line {
            Some(line) => planner.from_line(program, paths, line, from)?,
            None => paths,
        };
        Ok(Planned { paths, seams })
    }
}

/// Whether the machine can follow the seams that the program asks it to: there is a tracker, a seam, and the
/// slides reach it.
pub fn check_seam(
    paths: &[PlannedPath],
    machine: &MachineFile,
    seam: Option<&Deviation>,
) -> Result<(), SeamError> {
    let tracks = |path: &PlannedPath| {
        let on = |event: &PathEvent| event.action == PathAction::Tracking { on: true };
        path.events.iter().any(on)
    };
    let tracked = paths.iter().any(tracks);
    match (&machine.tracking, seam) {
        (None, Some(_)) => Err(SeamError::NoTracking),
        (Some(_), None) if tracked => Err(SeamError::NoSeam),
        (_, None) => Ok(()),
        (Some(_), Some(seam)) => paths
            .iter()
            .filter(|path| path.weld().is_some())
            .try_for_each(|path| seam.check(path, machine)),
    }
}
