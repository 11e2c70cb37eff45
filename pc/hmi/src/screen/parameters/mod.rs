//! The page of parameters: all that the machine file has, changed one by one, written together.

mod changes;
mod detail;
mod dialogs;
mod rows;

use super::{View, bare};
use crate::parameters::{Parameters, Version};
use crate::station::{Action, Station};
use config::parameters::{EditError, Range};
use config::sentence;
use eframe::egui::{self, Label, RichText, Ui};

/// Width of what is beside the list \[points\].
const DETAIL: f32 = 430.0;
/// Height of the list of changes with its buttons \[points\].
const CHANGES: f32 = 300.0;

/// What the page remembers between two frames.
#[derive(Default)]
pub(super) struct ParametersPage {
    opened: Option<Parameters>,
    /// Why there is none, or why it was not written.
    failed: Option<String>,
    /// The file on the disk was another one when that was asked last.
    is_stale: bool,
    /// The loaded program was planned for another file than this one.
    is_other: bool,
    search: String,
    shown: Shown,
    chosen: Option<Chosen>,
    over: Over,
    /// The versions, as they were when they were asked for.
    versions: Vec<Version>,
}

/// Which parameters are listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Shown {
    #[default]
    All,
    Changed,
    OtherThanShipped,
}

/// The parameter that is looked at.
struct Chosen {
    key: String,
    /// What is typed as its value.
    typed: String,
    /// Why that is none.
    error: Option<EditError>,
    /// What it may be, of the changes so far.
    ranges: Vec<Range>,
}

/// What is open over the page; nothing is over Stop while a job runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Over {
    #[default]
    Nothing,
    /// The question before writing.
    Write,
    /// The versions that are kept.
    Versions,
}

impl ParametersPage {
    /// Reads the machine file anew, unless something is changed.
    pub fn open(&mut self, station: &Station) {
        match &self.opened {
            Some(parameters) if parameters.is_changed() => self.is_stale = parameters.is_stale(),
            _ => self.load(station),
        }
    }

    /// Reads the machine file; what was changed is discarded.
    fn load(&mut self, station: &Station) {
        (self.opened, self.failed, self.is_stale) = match Parameters::open(station.machine_file()) {
            Ok(parameters) => (Some(parameters), None, false),
            Err(error) => (None, Some(sentence(error.as_ref())), false),
        };
        let planned = station.loaded().zip(self.opened.as_ref());
        self.is_other = planned.is_some_and(|(loaded, parameters)| !parameters.is_of(&loaded.machine));
        self.choose_again();
    }

    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station, left_handed: bool) {
        if self.opened.is_none() {
            if let Some(failed) = &self.failed {
                ui.add(Label::new(RichText::new(failed).color(view.theme.bad)).wrap());
            }
            return;
        }
        let beside = if left_handed {
            bare(egui::Panel::left("parameter"))
        } else {
            bare(egui::Panel::right("parameter"))
        };
        beside.exact_size(DETAIL).resizable(false).show(ui, |ui| {
            egui::Panel::bottom("changes")
                .frame(egui::Frame::new())
                .exact_size(CHANGES)
                .resizable(false)
                .show(ui, |ui| self.changes(ui, view, station));
            self.detail(ui, view);
        });
        egui::Frame::new()
            .inner_margin(egui::Margin::symmetric(8, 0))
            .show(ui, |ui| self.rows(ui, view));
        if !station.may(Action::Write, view.now) {
            self.over = Over::Nothing;
        }
        match self.over {
            Over::Nothing => {}
            Over::Write => self.ask_to_write(ui, view, station),
            Over::Versions => self.list_versions(ui, view),
        }
    }

    /// Looks at the parameter called `key`.
    fn choose(&mut self, key: &str) {
        let Some(parameters) = &self.opened else { return };
        self.chosen = parameters.parameter(key).map(|parameter| Chosen {
            key: key.to_owned(),
            typed: parameter.value.clone(),
            error: None,
            ranges: parameters.ranges(key),
        });
    }

    /// Looks at the same parameter after the file has changed.
    fn choose_again(&mut self) {
        if let Some(chosen) = self.chosen.take() {
            self.choose(&chosen.key);
        }
    }
}
