//! A job before it is run: its paths, and whether the machine can do all of them.

use crate::{Job, JobError};
use cam::path::{PlannedPath, Planner, check_constant_speed};
use nc::Program;
use shared::io::AXES;
use shared::units::MM_S_PER_M_MIN;

impl Job<'_> {
    /// The paths of `program` from where the axes stand at `from` (mm, degrees). The machine can do all of them, keeps the feed
    /// where the speed must be constant, and can follow the seams that are around it.
    ///
    /// # Errors
    /// [`JobError::Path`], [`JobError::FromLine`] or [`JobError::Surroundings`].
    pub fn plan(
        &self,
        program: &Program,
        planner: &Planner,
        from: &[f64; AXES],
    ) -> Result<Vec<PlannedPath>, JobError> {
        let speed = self.speed_m_per_min.map(|speed| speed * MM_S_PER_M_MIN);
        let paths = planner.program(program, from, speed)?;
        check_constant_speed(&paths, self.part.is_some())?;
        self.surroundings
            .planned(self.machine, planner, &paths)
            .map_err(JobError::Surroundings)?;
        Ok(match self.from_line {
            Some(line) => planner.from_line(program, paths, line, from)?,
            None => paths,
        })
    }
}
