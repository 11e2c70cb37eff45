//! Places to which the tip is led.

use super::plan_beside;
use crate::running::Machine;
use anyhow::Context;
use cam::path::Tip;
use config::kept;
use parts::PartFile;
use shared::io::AXES;
use std::path::{Path, PathBuf};
use teach::{TipFile, TipPoint};

/// A part that is made of places, and those so far; each is on the disk as soon as it is taken.
#[derive(Debug)]
pub struct Places {
    part: PartFile,
    file: TipFile,
    points: Vec<TipPoint>,
}

impl Places {
    /// Those that `part` has in `file` already.
    ///
    /// # Errors
    /// A sentence: their file cannot be read.
    pub(super) fn open(part: PartFile, file: &Path) -> anyhow::Result<Self> {
        let (file, points, _) = TipFile::open(file, false)?;
        Ok(Self { part, file, points })
    }

    /// The part file.
    pub fn part(&self) -> &Path {
        self.part.path()
    }

    /// Where the places are kept.
    pub fn places_file(&self) -> &Path {
        self.file.path()
    }

    /// The places, in order.
    pub fn points(&self) -> &[TipPoint] {
        &self.points
    }

    /// Takes down where the tip is when the axes stand at `axes` (mm, degrees); false if that is where the last place is.
    ///
    /// # Errors
    /// A sentence: the file cannot be written, and the place is not taken.
    pub fn take(&mut self, machine: &Machine, axes: &[f64; AXES]) -> anyhow::Result<bool> {
        let Tip {
            position_mm,
            angles_deg,
            ..
        } = machine.planner.tip(axes);
        let here = TipPoint {
            position_mm,
            angles_deg,
        };
        if self.points.last().is_some_and(|last| last.is_near(&here)) {
            return Ok(false);
        }
        let mut points = self.points.clone();
        points.push(here);
        self.keep(points)?;
        Ok(true)
    }

    /// Takes the last place out again.
    ///
    /// # Errors
    /// A sentence: the file cannot be written, and the place stays.
    pub fn undo(&mut self) -> anyhow::Result<()> {
        let mut points = self.points.clone();
        points.pop();
        self.keep(points)
    }

    /// Begins anew; what was taught is kept as a version of the file.
    ///
    /// # Errors
    /// A sentence: the files cannot be written, and the places stay.
    pub fn restart(&mut self) -> anyhow::Result<()> {
        let file = self.file.path();
        let cannot = || format!("cannot keep {}", file.display());
        let before = std::fs::read_to_string(file).with_context(cannot)?;
        kept::keep_version(file, &before).with_context(cannot)?;
        self.keep(Vec::new())
    }

    fn keep(&mut self, points: Vec<TipPoint>) -> anyhow::Result<()> {
        let file = self.file.path().display();
        self.file
            .keep(&points)
            .with_context(|| format!("cannot write {file}"))?;
        self.points = points;
        Ok(())
    }

    /// Plans the program of the part and writes it beside the part file; see [`plan_beside`].
    ///
    /// # Errors
    /// A sentence: too few places, or what the machine cannot do.
    pub fn plan(&self, machine: &Machine) -> anyhow::Result<PathBuf> {
        // The places that are on the disk now.
        plan_beside(&PartFile::read(self.part())?, machine)
    }
}
