//! A job before it is run: its paths, and whether the machine can do all of them.

use super::{Job, JobError};
use crate::seam::{Deviation, SeamError, check_facing};
use crate::world::TrueSeams;
use cam::path::{PlannedPath, Planner};
use config::machine::MachineFile;
use nc::Program;
use shared::io::AXES;
use shared::protocol::{PathAction, PathEvent};

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
            (_, seam, _) => match check_seam(&paths, self.machine, seam.as_deref()) {
                // Real cameras see the seam, and nobody has to say where it is.
                Err(SeamError::NoSeam) if around.cameras.real() => {}
                checked => checked?,
            },
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
