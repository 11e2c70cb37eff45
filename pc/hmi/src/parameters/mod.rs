//! The machine file while its parameters are changed: changes are collected and checked, and written only when that is asked for.

mod versions;

pub use versions::Version;

use crate::edited::Edited;
use anyhow::bail;
use config::machine::{MachineError, MachineFile};
use config::parameters::{
    Change, EditError, Parameter, Range, Table, changes, is_about, is_same, list, ranges, replace,
    shipped_values,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// See the module.
#[derive(Debug)]
pub struct Parameters {
    text: Edited,
    /// The machine that it is as it was loaded, if it is one.
    machine: Option<MachineFile>,
    /// What is in the text with the changes.
    tables: Vec<Table>,
    changes: Vec<Change>,
    refused: Option<MachineError>,
    weakened: Vec<String>,
    shipped: BTreeMap<String, String>,
}

/// What was written.
#[derive(Debug)]
pub struct Written {
    /// The values.
    pub changes: Vec<Change>,
    /// Where what was there before is kept, if there was any.
    pub version: Option<PathBuf>,
}

impl Parameters {
    /// Those of the machine file at `file`.
    ///
    /// # Errors
    /// A sentence: it cannot be read.
    pub fn open(file: &Path) -> anyhow::Result<Self> {
        let text = Edited::open("machine file", file)?;
        let loaded = text.loaded().to_owned();
        let mut parameters = Self {
            text,
            machine: None,
            tables: Vec::new(),
            changes: Vec::new(),
            refused: None,
            weakened: Vec::new(),
            shipped: shipped_values(&loaded),
        };
        parameters.machine = parameters.as_loaded();
        parameters.take(loaded);
        Ok(parameters)
    }

    /// The file.
    pub fn file(&self) -> &Path {
        self.text.file()
    }

    /// All parameters with the changes, in the order of the file.
    pub fn tables(&self) -> &[Table] {
        &self.tables
    }

    /// The parameter called `key`.
    pub fn parameter(&self, key: &str) -> Option<&Parameter> {
        let mut all = self.tables.iter().flat_map(|table| &table.parameters);
        all.find(|parameter| parameter.key == key)
    }

    /// What is changed since the file was loaded.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// What is changed of the parameter called `key`.
    pub fn change(&self, key: &str) -> Option<&Change> {
        self.changes.iter().find(|change| change.key == key)
    }

    /// Whether anything is changed; that may be comments alone.
    pub fn is_changed(&self) -> bool {
        self.text.is_changed()
    }

    /// Why the file cannot be used with the changes, by its reader.
    pub fn refused(&self) -> Option<&MachineError> {
        self.refused.as_ref()
    }

    /// Whether that is said of `parameter`.
    pub fn is_refused_at(&self, parameter: &Parameter) -> bool {
        self.refused
            .as_ref()
            .is_some_and(|error| is_about(error, parameter))
    }

    /// Protections that the changes make weaker than usual, a sentence each.
    pub fn weakened(&self) -> &[String] {
        &self.weakened
    }

    /// The value that the shipped file of the machine with the same kinematics has.
    pub fn shipped(&self, key: &str) -> Option<&str> {
        self.shipped.get(key).map(String::as_str)
    }

    /// Whether that is another one. What the shipped file has not is no other.
    pub fn is_other_than_shipped(&self, parameter: &Parameter) -> bool {
        let shipped = self.shipped(&parameter.key);
        shipped.is_some_and(|shipped| !is_same(shipped, &parameter.value))
    }

    /// What the parameter called `key` may be, where all others are as they are.
    pub fn ranges(&self, key: &str) -> Vec<Range> {
        self.parameter(key)
            .map_or_else(Vec::new, |parameter| ranges(self.text.text(), parameter))
    }

    /// Has what was typed as the value of the parameter called `key`. Whether the machine can run with it is told by
    /// [`Parameters::refused`].
    ///
    /// # Errors
    /// It is no value of that kind.
    pub fn set(&mut self, key: &str, typed: &str) -> Result<(), EditError> {
        let Some(parameter) = self.parameter(key) else {
            return Ok(());
        };
        // The same number is no change, however it is written.
        let before = self
            .change(key)
            .map_or(Some(&parameter.value), |change| change.old.as_ref());
        let typed = before.map_or(
            typed,
            |before| if is_same(before, typed) { before } else { typed },
        );
        let text = replace(self.text.text(), parameter, typed)?;
        self.take(text);
        Ok(())
    }

    /// Has `text` in place of what was changed. Nothing is written yet.
    pub fn propose(&mut self, text: String) {
        self.take(text);
    }

    /// The parameter called `key` is as it was loaded.
    pub fn take_back(&mut self, key: &str) {
        if let Some(before) = self.change(key).and_then(|change| change.old.clone()) {
            // As it is in the file.
            let _ = self.set(key, &before);
        }
    }

    /// All is as it was loaded.
    pub fn discard(&mut self) {
        self.take(self.text.loaded().to_owned());
    }

    /// Whether the file on the disk is another one than was loaded.
    pub fn is_stale(&self) -> bool {
        self.text.is_stale()
    }

    /// Whether `machine`, which a program was planned for, is that of the file as it was loaded; what is in files of its own is no
    /// matter.
    pub fn is_of(&self, machine: &MachineFile) -> bool {
        self.machine.as_ref().is_some_and(|own| {
            MachineFile {
                welding: machine.welding.clone(),
                work_offsets: machine.work_offsets.clone(),
                ..own.clone()
            } == *machine
        })
    }

    /// Writes the changes: keeps what was there before as a version, and puts the new text in its place.
    ///
    /// # Errors
    /// A sentence: nothing is changed, the machine cannot be run with it, or the file on the disk was changed or cannot be written.
    pub fn write(&mut self) -> anyhow::Result<Written> {
        if let Some(error) = &self.refused {
            bail!("{error}");
        }
        let version = self.text.write()?;
        self.machine = self.as_loaded();
        Ok(Written {
            changes: std::mem::take(&mut self.changes),
            version,
        })
    }

    fn as_loaded(&self) -> Option<MachineFile> {
        MachineFile::parse(&self.text.name(), self.text.loaded()).ok()
    }

    /// Has `text` as what is edited.
    fn take(&mut self, text: String) {
        let read = MachineFile::parse(&self.text.name(), &text);
        let weak = |machine: &MachineFile| -> Vec<String> {
            let protections = machine.weak_protections();
            protections.iter().map(ToString::to_string).collect()
        };
        let before = self.machine.as_ref().map_or_else(Vec::new, weak);
        self.weakened = read.as_ref().map_or_else(|_| Vec::new(), weak);
        self.weakened.retain(|told| !before.contains(told));
        self.refused = read.err();
        self.tables = list(&text);
        self.changes = changes(self.text.loaded(), &text);
        self.text.set(text);
    }
}

#[cfg(test)]
mod tests;
