//! Tools and weld data while they are changed: changes are collected and checked, and written only when that is asked for.

use crate::edited::Edited;
use crate::parameters::Written;
use anyhow::bail;
use config::parameters::{
    Change, EditError, Kind, Parameter, Table, changes, differing, is_same, list_elements, unit,
};
use config::sentence;
use config::sets::{OF_TOOL, Sets, is_name, with_tool, with_weld_data};
use std::path::{Path, PathBuf};

/// Sets of a file.
#[derive(Debug)]
pub struct EditedSets {
    kind: Sets,
    text: Edited,
    sets: Vec<Table>,
    /// As they were loaded.
    before: Vec<Table>,
    changes: Vec<Change>,
    refused: Option<String>,
}

/// A value of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Its name in the set.
    pub name: String,
    /// As it is written, or 0 where it is left out.
    pub value: String,
    /// Its unit.
    pub unit: &'static str,
    /// Whether it is a number.
    pub is_number: bool,
}

impl EditedSets {
    /// Those of the file at `file`; weld data need not have one yet.
    ///
    /// # Errors
    /// A sentence: it cannot be read, or its reader refuses it.
    pub fn open(kind: Sets, file: &Path) -> anyhow::Result<Self> {
        let text = match kind {
            Sets::Tools => Edited::open(kind.what(), file),
            Sets::WeldData => Edited::open_or_new(kind.what(), file),
        }?;
        let mut sets = Self {
            kind,
            before: kind.list(text.loaded()),
            text,
            sets: Vec::new(),
            changes: Vec::new(),
            refused: None,
        };
        sets.take(sets.text.loaded().to_owned());
        match sets.refused.take() {
            Some(refused) => bail!(refused),
            None => Ok(sets),
        }
    }

    /// What the sets are.
    pub fn kind(&self) -> Sets {
        self.kind
    }

    /// The file.
    pub fn file(&self) -> &Path {
        self.text.file()
    }

    /// Names of the sets.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.sets.iter().map(|set| &*set.name)
    }

    /// The values of the set called `name`.
    pub fn values(&self, name: &str) -> Vec<Value> {
        let written = called(&self.sets, name).map_or(&[][..], |set| &set.parameters);
        match self.kind {
            Sets::WeldData => written.iter().map(value).collect(),
            Sets::Tools => OF_TOOL
                .iter()
                .map(|key| {
                    let there = written.iter().find(|one| one.name == *key);
                    there.map_or_else(|| left_out(key), value)
                })
                .collect(),
        }
    }

    /// Whether the value `name` of `set`, or anything of it, is changed.
    pub fn is_changed_at(&self, set: &str, name: Option<&str>) -> bool {
        let of = |table: &Table| -> Vec<(String, String)> {
            let values = table.parameters.iter();
            let asked = values.filter(|one| name.is_none_or(|name| one.name == name));
            asked.map(|one| (one.name.clone(), one.value.clone())).collect()
        };
        called(&self.sets, set).map(of) != called(&self.before, set).map(of)
    }

    /// What is changed since the file was loaded.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Whether anything is changed.
    pub fn is_changed(&self) -> bool {
        self.text.is_changed()
    }

    /// Why the file cannot be used with the changes, by its reader, as a sentence.
    pub fn refused(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// Whether the file on the disk is another one than was loaded.
    pub fn is_stale(&self) -> bool {
        self.text.is_stale()
    }

    /// Where what is in the file now will be kept; `None` where there is none yet.
    pub fn next_version(&self) -> Option<PathBuf> {
        self.text.next_version()
    }

    /// Has what was typed as the value `name` of `set`. Whether it may be is told by [`EditedSets::refused`].
    ///
    /// # Errors
    /// It is no value of that kind.
    pub fn set(&mut self, set: &str, name: &str, typed: &str) -> Result<(), EditError> {
        let before = called(&self.before, set);
        let before = before.and_then(|set| set.parameters.iter().find(|one| one.name == name));
        // The same number is no change, however it is written.
        let typed = match before {
            Some(before) if is_same(&before.value, typed) => before.value.clone(),
            _ => typed.to_owned(),
        };
        let Some(of) = called(&self.sets, set) else {
            return Ok(());
        };
        let text = self.kind.set(self.text.text(), of, name, &typed)?;
        self.take(text);
        Ok(())
    }

    /// Whether what was `typed` is the name of another set: the number of a tool, or what a program can call.
    pub fn is_new(&self, typed: &str) -> bool {
        let may = match self.kind {
            Sets::Tools => typed
                .parse::<u32>()
                .is_ok_and(|number| number.to_string() == typed && number > 0),
            Sets::WeldData => is_name(typed),
        };
        may && !self.names().any(|name| name == typed)
    }

    /// Another set, if [`EditedSets::is_new`]: a tool of no length and diameter, or weld data as those called `of`.
    pub fn add(&mut self, name: &str, of: &str) {
        if !self.is_new(name) {
            return;
        }
        let text = self.text.text();
        let with = match (self.kind, name.parse()) {
            (Sets::Tools, Ok(number)) => with_tool(text, number),
            _ => with_weld_data(text, name, of),
        };
        self.take(with);
    }

    /// What can be put into the set called `name`.
    pub fn missing(&self, name: &str) -> Vec<&'static str> {
        let set = called(&self.sets, name);
        set.map_or_else(Vec::new, |set| self.kind.missing(set))
    }

    /// Puts `key`, one of [`EditedSets::missing`], into the set called `name`.
    pub fn put_in(&mut self, name: &str, key: &str) {
        if let Some(set) = called(&self.sets, name) {
            self.take(self.kind.put_in(self.text.text(), set, key));
        }
    }

    /// Takes the set called `name` out.
    pub fn remove(&mut self, name: &str) {
        self.take(self.kind.without(self.text.text(), name));
    }

    /// Writes the changes: keeps what was there before as a version, and puts the new text in its place.
    ///
    /// # Errors
    /// A sentence: nothing is changed, the reader refuses it, or the file on the disk was changed or cannot be written.
    pub fn write(&mut self) -> anyhow::Result<Written> {
        if let Some(refused) = &self.refused {
            bail!("{refused}");
        }
        let version = self.text.write()?;
        self.before.clone_from(&self.sets);
        Ok(Written {
            changes: std::mem::take(&mut self.changes),
            version,
        })
    }

    /// Has `text` as what is edited.
    fn take(&mut self, text: String) {
        let checked = self.kind.check(&self.text.name(), &text);
        self.refused = checked.err().map(|error| sentence(error.as_ref()));
        self.sets = self.kind.list(&text);
        let before = self.text.loaded();
        self.changes = match self.kind {
            Sets::Tools => changes(before, &text),
            Sets::WeldData => differing(&list_elements(before), &list_elements(&text)),
        };
        self.text.set(text);
    }
}

fn called<'a>(sets: &'a [Table], name: &str) -> Option<&'a Table> {
    sets.iter().find(|set| set.name == name)
}

fn value(of: &Parameter) -> Value {
    Value {
        name: of.name.clone(),
        value: of.value.clone(),
        unit: of.unit,
        is_number: matches!(of.kind, Kind::Float | Kind::Integer),
    }
}

fn left_out(name: &str) -> Value {
    Value {
        name: name.to_owned(),
        value: "0".to_owned(),
        unit: unit(name),
        is_number: true,
    }
}
