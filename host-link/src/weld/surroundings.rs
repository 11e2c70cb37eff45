//! What is around the machine: the seams as they really are, and what sees them.

use super::{CameraChoice, JobError};
use crate::seam::Deviation;
use crate::world::TrueSeams;
use cam::path::{PlannedPath, Planner};
use config::machine::MachineFile;
use nc::Program;
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
