//! Places of the tip that are being taught, for a part that is made of them.

use crate::running::Machine;
use anyhow::{Context, bail};
use cam::path::Tip;
use config::kept;
use config::weld_data::WeldData;
use parts::PartFile;
use shared::io::AXES;
use std::path::{Path, PathBuf};
use teach::{TipFile, TipPoint};

/// A part, and its places so far; each is on the disk as soon as it is taken.
#[derive(Debug)]
pub struct Teaching {
    part: PartFile,
    file: TipFile,
    points: Vec<TipPoint>,
}

impl Teaching {
    /// The part in `file`, with the places that it has already.
    ///
    /// # Errors
    /// A sentence: it is no part, or none that is taught by places of the tip.
    pub fn open(file: &Path) -> anyhow::Result<Self> {
        let part = PartFile::read(file)?;
        let Some(seam) = part.taught_seam() else {
            bail!(
                "{}: only a part of places ([seam]) is taught here",
                file.display()
            );
        };
        let places = file.parent().unwrap_or(Path::new("")).join(seam.taught());
        let (file, points, _) = TipFile::open(&places, false)?;
        Ok(Self { part, file, points })
    }

    /// Parts in `folder` that are taught by places.
    pub fn parts_in(folder: &Path) -> Vec<PathBuf> {
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let of_places = |file: &PathBuf| {
            let is_toml = file.extension().is_some_and(|ending| ending == "toml");
            is_toml && PartFile::read(file).is_ok_and(|part| part.taught_seam().is_some())
        };
        let mut files: Vec<PathBuf> = files.map(|entry| entry.path()).filter(of_places).collect();
        files.sort();
        files
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

    /// Plans the program of the part and writes it beside the part file, whose name it has; one that was there is kept as a version.
    ///
    /// # Errors
    /// A sentence: too few places, or what the machine cannot do.
    pub fn plan(&self, machine: &Machine) -> anyhow::Result<PathBuf> {
        let program = self.part().with_extension("ngc");
        let title = program
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let of_part = || format!("part {}", self.part().display());
        // The places that are on the disk now.
        let part = PartFile::read(self.part())?;
        let mut is = machine.is.clone();
        is.welding = WeldData::beside(&program)?;
        let planner = cam::path::Planner::build(&is).with_context(|| machine.file.display().to_string())?;
        let (plan, _) = part.plan_checked(&is, &planner, &title).with_context(of_part)?;
        let cannot = || format!("cannot write {}", program.display());
        if program.exists() {
            let before = std::fs::read_to_string(&program).with_context(cannot)?;
            if before != plan.program {
                kept::keep_version(&program, &before).with_context(cannot)?;
            }
        }
        kept::replace(&program, &plan.program).with_context(cannot)?;
        Ok(program)
    }
}
