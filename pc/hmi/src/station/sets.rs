//! Tools and weld data as they are written at the screen.

use super::{Action, Station};
use crate::sets::EditedSets;
use anyhow::bail;
use config::sets::Sets;
use config::weld_data::FILE;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What writing them is.
pub fn action(kind: Sets) -> Action {
    match kind {
        Sets::Tools => Action::Tools,
        Sets::WeldData => Action::WeldData,
    }
}

impl Station {
    /// The file of tools, or of the weld data of the program; `None` where there is no program.
    pub fn file_of(&self, kind: Sets) -> Option<PathBuf> {
        match kind {
            Sets::Tools => Some(self.machine_file().to_owned()),
            Sets::WeldData => self.program_file().map(|program| program.with_file_name(FILE)),
        }
    }

    /// The program that is loaded, or else that was to be.
    fn program_file(&self) -> Option<&Path> {
        let loaded = self.loaded.as_ref().map(|loaded| &loaded.program_file);
        loaded.or(self.asked.as_ref()).map(PathBuf::as_path)
    }

    /// Writes what is changed, if that may be, has it on record, and reads the program anew.
    ///
    /// # Errors
    /// A sentence: why it is not written.
    pub fn write_sets(&mut self, sets: &mut EditedSets, now: Duration) -> anyhow::Result<()> {
        let action = action(sets.kind());
        self.check(action)?;
        if !self.may(action, now) {
            bail!(
                "{} is only written where the machine is at rest",
                sets.kind().what()
            );
        }
        let written = sets.write()?;
        self.told_written(now, sets.file(), &written);
        Ok(())
    }
}
