//! What is around a machine, as far as a job has to do with it.

use crate::cameras::{PictureSource, SeamCameras};
use crate::images::{ImageCameras, Images, ImagesError};
use crate::teaching::RangingProbe;
use cam::path::{PlannedPath, Planner};
use camera::{Camera, CameraError, OpenCamera};
use config::machine::{MachineFile, TrackingUnit};
use evaluate::SeamTruth;
use parts::PartFile;
use shared::tracking::frames::Heads;
use std::error::Error;
use std::sync::Arc;

/// What is around a machine: what sees its seams, and in a simulated world the seams themselves.
pub trait Surroundings: Send + Sync {
    /// Opens what sees the seams of a machine that follows some.
    ///
    /// # Errors
    /// [`ImagesError`].
    fn cameras(&self, unit: &TrackingUnit, heads: Heads) -> Result<Box<dyn SeamCameras>, ImagesError>;

    /// The job is about to run `paths`; none of them where it teaches. A simulated world puts its seams beside them.
    ///
    /// # Errors
    /// [`SurroundingsError`] where the machine cannot follow the seams that the paths ask it to.
    fn planned(
        &self,
        machine: &MachineFile,
        planner: &Planner,
        paths: &[PlannedPath],
    ) -> Result<(), SurroundingsError>;

    /// The ranging probe in front of a part to teach; `None` if there is nothing to measure.
    fn probe(&self, machine: &MachineFile, part: &PartFile) -> Option<Box<dyn RangingProbe>>;

    /// Where the seams truly are, for whoever judges the run afterwards; `None` where nobody knows.
    fn truth(&self) -> Option<Arc<dyn SeamTruth + Send + Sync>>;
}

/// Why a machine cannot follow what is around it.
pub type SurroundingsError = Box<dyn Error + Send + Sync>;

/// A real machine: real cameras, if it has some, and nobody who knows the truth.
#[derive(Clone)]
pub struct RealSurroundings {
    /// The cameras of a machine that follows seams, and what opens them.
    pub cameras: Option<(ImageCameras, OpenCamera)>,
}

impl Surroundings for RealSurroundings {
    fn cameras(&self, unit: &TrackingUnit, heads: Heads) -> Result<Box<dyn SeamCameras>, ImagesError> {
        let Some((cameras, open)) = &self.cameras else {
            return Err(ImagesError {
                side: 0,
                source: CameraError::NotTold.into(),
            });
        };
        let source = Box::new(RealCameras(open.clone()));
        Ok(Box::new(Images::begin(cameras, source, unit, heads)?))
    }

    fn planned(&self, _: &MachineFile, _: &Planner, _: &[PlannedPath]) -> Result<(), SurroundingsError> {
        Ok(())
    }

    fn probe(&self, _: &MachineFile, _: &PartFile) -> Option<Box<dyn RangingProbe>> {
        None
    }

    fn truth(&self) -> Option<Arc<dyn SeamTruth + Send + Sync>> {
        None
    }
}

/// Cameras that are opened as the machine file names them.
struct RealCameras(OpenCamera);

impl PictureSource for RealCameras {
    fn open(&mut self, side: usize) -> Result<Box<dyn Camera>, CameraError> {
        (self.0)(side)
    }
}
