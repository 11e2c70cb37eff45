//! Versions of the machine file that are kept beside it.

use super::Parameters;
use config::kept;
use config::parameters::changes;
use std::path::{Path, PathBuf};

/// A version of the file that is kept.
#[derive(Debug)]
pub struct Version {
    /// Where it is.
    pub file: PathBuf,
    /// How many values are others in it.
    pub differing: usize,
}

impl Parameters {
    /// Versions that are kept beside the file, newest first.
    pub fn versions(&self) -> Vec<Version> {
        let kept = kept::versions(self.file()).into_iter().rev();
        kept.filter_map(|(_, file)| {
            let text = std::fs::read_to_string(&file).ok()?;
            Some(Version {
                differing: changes(self.text.loaded(), &text).len(),
                file,
            })
        })
        .collect()
    }

    /// Has everything as it is in the version at `file`; what was changed otherwise is discarded. Nothing is written yet.
    ///
    /// # Errors
    /// A sentence: it cannot be read.
    pub fn restore(&mut self, file: &Path) -> anyhow::Result<()> {
        self.take(self.text.read(file)?);
        Ok(())
    }

    /// Where what is in the file now will be kept.
    pub fn next_version(&self) -> Option<PathBuf> {
        self.text.next_version()
    }
}
