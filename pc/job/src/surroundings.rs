//! The surroundings of a machine (cameras, probe, true seams) as a job uses them.

use crate::cameras::SeamCameras;
use crate::images::ImagesError;
use crate::teaching::RangingProbe;
use cam::path::{PlannedPath, Planner};
use config::machine::{MachineFile, TrackingUnit};
use evaluate::SeamTruth;
use host_link::geometry::MachineGeometry;
use parts::PartFile;
use shared::config::MotionConfig;
use shared::parameter::ParameterError;
use shared::tracking::frames::Heads;
use std::error::Error;
use std::sync::Arc;

/// What is around a machine: what sees its seams, and in a simulated world the seams themselves.
pub trait Surroundings: Send + Sync {
    /// The geometry of the machine, also as it truly is where that is known.
    ///
    /// # Errors
    /// [`ParameterError`].
    fn geometry(&self, motion: &MotionConfig) -> Result<MachineGeometry, ParameterError> {
        MachineGeometry::build(motion)
    }

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

    /// Where the seams truly are, for the evaluation of the run; `None` where that is unknown.
    fn truth(&self) -> Option<Arc<dyn SeamTruth + Send + Sync>>;
}

/// Why a machine cannot follow what is around it.
pub type SurroundingsError = Box<dyn Error + Send + Sync>;
