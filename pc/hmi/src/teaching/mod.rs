//! Parts that are being taught: places of the tip by hand, seams by the cameras.

mod places;
mod seams;

pub use places::Places;
pub use seams::Seams;

use crate::running::Machine;
use anyhow::{Context, bail};
use config::kept;
use config::weld_data::WeldData;
use parts::PartFile;
use std::path::{Path, PathBuf};

/// A part that is being taught.
#[derive(Debug)]
pub enum Teaching {
    /// By leading the tip to places.
    Places(Places),
    /// By the cameras.
    Seams(Seams),
}

impl Teaching {
    /// The part in `file`, with what was taught of it already.
    ///
    /// # Errors
    /// A sentence: it is no part, or none that is taught here.
    pub fn open(file: &Path) -> anyhow::Result<Self> {
        let part = PartFile::read(file)?;
        if let Some(seam) = part.taught_seam() {
            let file = beside(part.path(), seam.taught());
            return Places::open(part, &file).map(Self::Places);
        }
        if part.t_seam().is_some() {
            return Seams::open(part).map(Self::Seams);
        }
        bail!(
            "{}: only parts of places ([seam]) and of seams that cameras see ([t-seam]) are taught here",
            file.display()
        );
    }

    /// Parts in `folder` that are taught here.
    pub fn parts_in(folder: &Path) -> Vec<PathBuf> {
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let is_taught = |file: &PathBuf| {
            let is_toml = file.extension().is_some_and(|ending| ending == "toml");
            is_toml
                && PartFile::read(file)
                    .is_ok_and(|part| part.taught_seam().is_some() || part.t_seam().is_some())
        };
        let mut files: Vec<PathBuf> = files.map(|entry| entry.path()).filter(is_taught).collect();
        files.sort();
        files
    }
}

/// What the part in `part` calls `name`, beside it.
fn beside(part: &Path, name: &Path) -> PathBuf {
    part.parent().unwrap_or(Path::new("")).join(name)
}

/// Plans the program of `part` and writes it beside the part file, whose name it has; one that was there is kept as a version.
///
/// # Errors
/// A sentence: what the machine cannot do, or what cannot be written.
fn plan_beside(part: &PartFile, machine: &Machine) -> anyhow::Result<PathBuf> {
    let program = part.path().with_extension("ngc");
    let title = program
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let of_part = || format!("part {}", part.path().display());
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
