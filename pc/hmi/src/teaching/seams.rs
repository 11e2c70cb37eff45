//! Seams that the cameras are taught.

use super::{beside, plan_beside};
use crate::loaded::deviation_beside;
use crate::running::{Lesson, Machine};
use anyhow::Context;
use config::kept;
use job::{LessonOptions, SeamLesson};
use nc::{Options, interpret};
use parts::PartFile;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use teach::seam::read_seam_points;

/// A part with seams that cameras see, and how far they were taught.
#[derive(Debug)]
pub struct Seams {
    part: PartFile,
    file: PathBuf,
    points: usize,
}

impl Seams {
    /// How far those of `part` were taught. Their points are where the part file has them, else in `NAME-taught.csv` beside it.
    ///
    /// # Errors
    /// A sentence: their file cannot be read.
    pub(super) fn open(part: PartFile) -> anyhow::Result<Self> {
        let told = part.t_seam().and_then(|seam| seam.taught());
        let file = match told {
            Some(told) => beside(part.path(), told),
            None => {
                let stem = part.path().file_stem().unwrap_or_default().to_string_lossy();
                part.path().with_file_name(format!("{stem}-taught.csv"))
            }
        };
        let mut seams = Self {
            part,
            file,
            points: 0,
        };
        seams.count()?;
        Ok(seams)
    }

    /// The part file.
    pub fn part(&self) -> &Path {
        self.part.path()
    }

    /// Where the points are kept.
    pub fn points_file(&self) -> &Path {
        &self.file
    }

    /// How many points were taught.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Counts the points on the disk.
    ///
    /// # Errors
    /// A sentence: they cannot be read.
    pub fn count(&mut self) -> anyhow::Result<()> {
        self.points = match self.file.exists() {
            true => read_seam_points(&self.file)?.len(),
            false => 0,
        };
        Ok(())
    }

    /// Begins anew; what was taught is kept as a version of the file.
    ///
    /// # Errors
    /// A sentence: the files cannot be written, and the points stay.
    pub fn restart(&mut self) -> anyhow::Result<()> {
        let cannot = || format!("cannot keep {}", self.file.display());
        let before = fs::read_to_string(&self.file).with_context(cannot)?;
        kept::keep_version(&self.file, &before).with_context(cannot)?;
        fs::remove_file(&self.file).with_context(cannot)?;
        self.count()
    }

    /// The lesson that goes on behind the last point.
    ///
    /// # Errors
    /// A sentence: what the machine or the part lacks for it.
    pub fn lesson(&self, machine: Arc<Machine>) -> anyhow::Result<Lesson> {
        let drawn = self.part.drawn(&machine.is)?;
        let drawn = drawn.map(|plan| interpret(&plan.program, Options::default()));
        let seam = deviation_beside(&self.part().with_extension("ngc"))?;
        let (lesson, _) = SeamLesson::of(&machine.is, &self.part, &self.file, &LessonOptions::default())?;
        Ok(Lesson {
            lesson,
            drawn: drawn.transpose()?.map(Arc::new),
            seam: seam.map(|(_, seam)| seam),
            machine,
        })
    }

    /// Plans the program of the part from the points and writes it beside the part file, as [`Places::plan`](super::Places::plan) does.
    ///
    /// # Errors
    /// A sentence: too few points, or what the machine cannot do.
    pub fn plan(&self, machine: &Machine) -> anyhow::Result<PathBuf> {
        let part = PartFile::read(self.part())?.with_taught_seams(&self.file)?;
        plan_beside(&part, machine)
    }
}
