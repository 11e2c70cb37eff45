//! The text of a file while it is edited: what was there before is kept as a version, and what somebody else has changed
//! meanwhile is not written over.

use anyhow::{Context, bail};
use config::kept;
use std::path::{Path, PathBuf};

/// See the module.
#[derive(Debug)]
pub struct Edited {
    /// What it is, as "machine file".
    what: &'static str,
    file: PathBuf,
    /// As it was loaded.
    loaded: String,
    /// The same with what was changed.
    text: String,
    /// There was none yet.
    is_new: bool,
}

impl Edited {
    /// The file at `file`; `what` it is, is used in messages only.
    ///
    /// # Errors
    /// A sentence: it cannot be read.
    pub fn open(what: &'static str, file: &Path) -> anyhow::Result<Self> {
        // What is written takes the place of the file itself, not of a link to it.
        let file = file.canonicalize().with_context(|| cannot("read", what, file))?;
        let loaded = std::fs::read_to_string(&file).with_context(|| cannot("read", what, &file))?;
        let text = loaded.clone();
        Ok(Self {
            what,
            file,
            loaded,
            text,
            is_new: false,
        })
    }

    /// The same, or an empty text where there is no such file yet.
    ///
    /// # Errors
    /// A sentence: there is one, and it cannot be read.
    pub fn open_or_new(what: &'static str, file: &Path) -> anyhow::Result<Self> {
        // A link to nowhere is no missing file.
        if file.symlink_metadata().is_ok() {
            return Self::open(what, file);
        }
        Ok(Self {
            what,
            file: file.to_owned(),
            loaded: String::new(),
            text: String::new(),
            is_new: true,
        })
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// What messages call the file.
    pub fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// The text as it was loaded.
    pub fn loaded(&self) -> &str {
        &self.loaded
    }

    /// The text with what was changed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Has `text` in place of what was changed.
    pub fn set(&mut self, text: String) {
        self.text = text;
    }

    /// Whether anything is changed; that may be comments alone.
    pub fn is_changed(&self) -> bool {
        self.text != self.loaded
    }

    /// Whether the file on the disk is another one than was loaded.
    pub fn is_stale(&self) -> bool {
        if self.is_new {
            return self.file.symlink_metadata().is_ok();
        }
        std::fs::read_to_string(&self.file).ok().as_ref() != Some(&self.loaded)
    }

    /// Where what is in the file now will be kept; `None` where there is none yet.
    pub fn next_version(&self) -> Option<PathBuf> {
        (!self.is_new).then(|| kept::next_version(&self.file))
    }

    /// The text of another file, such as a version that is kept.
    ///
    /// # Errors
    /// A sentence: it cannot be read.
    pub fn read(&self, file: &Path) -> anyhow::Result<String> {
        std::fs::read_to_string(file).with_context(|| cannot("read", self.what, file))
    }

    /// Writes the text in the place of what was loaded; where that is kept is returned, if there was any.
    ///
    /// # Errors
    /// A sentence: nothing is changed, or the file on the disk was changed or cannot be written.
    pub fn write(&mut self) -> anyhow::Result<Option<PathBuf>> {
        let file = self.file.display();
        if !self.is_changed() {
            bail!("nothing is changed");
        }
        if self.is_stale() {
            bail!("{file} has changed since it was loaded; it is not written over");
        }
        let version = (!self.is_new).then(|| kept::keep_version(&self.file, &self.loaded));
        let version = version
            .transpose()
            .with_context(|| format!("cannot keep a version of {file}"))?;
        kept::replace(&self.file, &self.text).with_context(|| cannot("write", self.what, &self.file))?;
        self.loaded.clone_from(&self.text);
        self.is_new = false;
        Ok(version)
    }
}

fn cannot(verb: &str, what: &str, file: &Path) -> String {
    format!("cannot {verb} {what} {}", file.display())
}
