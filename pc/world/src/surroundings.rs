//! The surroundings of a simulated machine: its true seams, cameras and probe.

use crate::deviation::{check_facing, check_seam};
use crate::rendered::RenderedPictures;
use crate::{
    Deviation, GeometricCameras, SceneFile, SeamError, SharedSeams, SimulatedProbe, TrueMachine, TrueSeams,
};
use cam::path::{PathError, PlannedPath, Planner};
use camera::OpenCamera;
use config::machine::{MachineFile, TrackingUnit};
use evaluate::SeamTruth;
use host_link::geometry::MachineGeometry;
use job::{ImageCameras, Images, ImagesError, RangingProbe, SeamCameras, SurroundingsError};
use nc::Program;
use parts::PartFile;
use shared::config::MotionConfig;
use shared::parameter::ParameterError;
use shared::tracking::frames::Heads;
use std::sync::{Arc, Mutex, PoisonError};
use thiserror::Error;

/// The uncertainty that geometric cameras report, in standard deviations of their noise.
const SIGMAS: f64 = 3.0;

/// What is around a machine.
#[derive(Clone)]
pub struct Surroundings {
    /// How the true seams deviate from the drawing, if there are any.
    pub seam: Option<Arc<Deviation>>,
    /// The program that is planned from the drawing, where the job runs another one.
    pub drawing: Option<Arc<Program>>,
    /// How the seams are seen.
    pub cameras: CameraChoice,
    /// Start of all noise.
    pub seed: u64,
    /// How a simulated machine is.
    pub truth: TrueMachine,
    /// What lies before rendered cameras.
    pub work: Workpiece,
}

/// What lies before rendered cameras.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Workpiece {
    /// Work with seams.
    #[default]
    Seams,
    /// A bare plate where the seams would be, on which beams leave marks.
    BarePlate,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self {
            seam: None,
            drawing: None,
            cameras: CameraChoice::default(),
            seed: 1,
            truth: TrueMachine::default(),
            work: Workpiece::default(),
        }
    }
}

/// How the seams are seen.
#[derive(Clone, Default)]
pub enum CameraChoice {
    /// By geometry, without pictures.
    #[default]
    Geometric,
    /// In pictures.
    Images(Box<ImageCameras>, PictureChoice),
}

/// Where pictures come from.
#[derive(Clone)]
pub enum PictureChoice {
    /// They are rendered.
    Rendered(Box<SceneFile>),
    /// From real cameras, which see real seams.
    Real(OpenCamera),
}

impl CameraChoice {
    /// Whether the cameras are real and see real seams.
    pub fn real(&self) -> bool {
        matches!(self, Self::Images(_, PictureChoice::Real(_)))
    }
}

/// The program of the drawing, to which the seam belongs, cannot be planned.
#[derive(Debug, Error)]
#[error("the program of the drawing, to which the seam belongs, cannot be planned: {0}")]
pub struct DrawingError(#[source] pub PathError);

/// [`Surroundings`] of one job.
pub struct World {
    settings: Surroundings,
    /// From when the cameras are open.
    seams: Mutex<Option<SharedSeams>>,
}

impl From<Surroundings> for Arc<dyn job::Surroundings> {
    fn from(settings: Surroundings) -> Self {
        Arc::new(World {
            settings,
            seams: Mutex::default(),
        })
    }
}

impl World {
    fn shared(&self) -> Option<SharedSeams> {
        self.seams.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The seams as they really are, beside those of the drawing, or else of the job's `own` paths; none on a machine
    /// that follows no seam.
    fn seams(
        &self,
        machine: &MachineFile,
        planner: &Planner,
        own: &[PlannedPath],
    ) -> Result<Option<TrueSeams>, SurroundingsError> {
        let Some(unit) = &machine.tracking else {
            return Ok(None);
        };
        let heads = unit.board.heads()?;
        let Some(deviation) = &self.settings.seam else {
            return Ok(Some(TrueSeams::none(heads)));
        };
        let seams = match &self.settings.drawing {
            None => TrueSeams::beside(heads, own, deviation),
            Some(drawing) => {
                let drawn = planner
                    .program(drawing, &machine.planning.park_axes(), None)
                    .map_err(DrawingError)?;
                TrueSeams::beside(heads, &drawn, deviation)
            }
        };
        Ok(Some(seams))
    }
}

impl job::Surroundings for World {
    fn geometry(&self, motion: &MotionConfig) -> Result<MachineGeometry, ParameterError> {
        self.settings.truth.geometry(motion)
    }

    fn cameras(&self, unit: &TrackingUnit, heads: Heads) -> Result<Box<dyn SeamCameras>, ImagesError> {
        let seams = SharedSeams::new(TrueSeams::none(heads));
        *self.seams.lock().unwrap_or_else(PoisonError::into_inner) = Some(seams.clone());
        let Surroundings { seed, work, .. } = self.settings;
        let mounts = self.settings.truth.mounts;
        Ok(match &self.settings.cameras {
            CameraChoice::Geometric => Box::new(GeometricCameras::new(
                (unit.cameras.processing_ms * 1e3) as u64,
                unit.cameras.noise_3sigma_mm / SIGMAS,
                mounts,
                seed,
                seams,
            )),
            CameraChoice::Images(images, PictureChoice::Rendered(scene)) => {
                let source = RenderedPictures::new(scene, &unit.cameras, &heads, mounts, seed, seams, work);
                Box::new(Images::begin(images, Box::new(source), unit, heads)?)
            }
            CameraChoice::Images(images, PictureChoice::Real(open)) => {
                Box::new(Images::begin(images, Box::new(open.clone()), unit, heads)?)
            }
        })
    }

    fn planned(
        &self,
        machine: &MachineFile,
        planner: &Planner,
        paths: &[PlannedPath],
    ) -> Result<(), SurroundingsError> {
        let seams = self.seams(machine, planner, paths)?;
        match (&seams, &self.settings.seam, &self.settings.drawing) {
            (Some(seams), Some(_), Some(_)) => paths
                .iter()
                .filter(|path| path.weld().is_some())
                .try_for_each(|path| check_facing(seams, path, machine))?,
            (_, seam, _) => match check_seam(paths, machine, seam.as_deref()) {
                // Real cameras see the seam; its deviation need not be given.
                Err(SeamError::NoSeam) if self.settings.cameras.real() => {}
                checked => checked?,
            },
        }
        if let (Some(shared), Some(seams)) = (self.shared(), seams) {
            shared.set(seams);
        }
        Ok(())
    }

    fn probe(&self, machine: &MachineFile, part: &PartFile) -> Option<Box<dyn RangingProbe>> {
        let surface = part.untaught()?.simulated_surface()?.clone();
        let unit = machine.probe.as_ref()?;
        let output = unit.build().ok()?;
        let probe = SimulatedProbe::new(surface, output, unit, self.settings.seed);
        Some(Box::new(probe))
    }

    fn truth(&self) -> Option<Arc<dyn SeamTruth + Send + Sync>> {
        let seams = self.shared()?.get().clone();
        (!seams.is_empty()).then(|| Arc::new(seams) as _)
    }
}
