//! What opens over the page: the question before writing, and the versions that are kept.

use super::{Over, ParametersPage};
use crate::screen::View;
use crate::screen::writing::{self, Answer, BUTTON, LIST, WIDTH, name};
use crate::station::Station;
use crate::texts::Text;
use config::sentence;
use eframe::egui::{Button, Id, Label, Modal, RichText, ScrollArea, Ui};
use std::path::Path;

impl ParametersPage {
    /// The question before writing: what will be another value, and what becomes weaker by it.
    pub(super) fn ask_to_write(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let Some(parameters) = &self.opened else { return };
        let version = parameters.next_version();
        let answer = writing::ask(ui, view, parameters.file(), version.as_deref(), |ui| {
            writing::changes(ui, view, parameters.changes(), parameters.is_changed());
            for weakened in parameters.weakened() {
                let text = view.words.with(Text::Weakened, &[weakened]);
                ui.add(Label::new(RichText::new(text).color(view.theme.doubt)).wrap());
            }
        });
        if answer == Answer::Write {
            self.write(view, station);
        }
        if answer != Answer::Nothing {
            self.over = Over::Nothing;
        }
    }

    fn write(&mut self, view: &View, station: &mut Station) {
        let Some(parameters) = &mut self.opened else {
            return;
        };
        self.failed = station
            .write(parameters, view.now)
            .err()
            .map(|error| sentence(error.as_ref()));
        self.is_stale = parameters.is_stale();
        // A program that was loaded is planned anew.
        self.is_other &= self.failed.is_some();
        self.choose_again();
    }

    /// The versions that are kept; one is looked at as changes.
    pub(super) fn list_versions(&mut self, ui: &mut Ui, view: &View) {
        let words = view.words;
        let Some(parameters) = &self.opened else { return };
        let is_free = !parameters.is_changed();
        let (mut tapped, mut cancel) = (None, false);
        let modal = Modal::new(Id::unique("versions")).show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.heading(words.with(Text::VersionsOf, &[&name(parameters.file())]));
            ui.add(Label::new(RichText::new(words.say(Text::VersionsHint)).color(view.theme.faint)).wrap());
            if !is_free {
                let text = RichText::new(words.say(Text::ChangesFirst)).color(view.theme.doubt);
                ui.add(Label::new(text).wrap());
            }
            if self.versions.is_empty() {
                ui.label(words.say(Text::NoVersions));
            }
            ScrollArea::vertical().max_height(LIST).show(ui, |ui| {
                for version in &self.versions {
                    let differing = version.differing.to_string();
                    let text = words.with(Text::VersionDiffers, &[&name(&version.file), &differing]);
                    let button = Button::new(text).min_size([WIDTH - 20.0, 48.0].into());
                    if ui.add_enabled(is_free, button).clicked() {
                        tapped = Some(version.file.clone());
                    }
                }
            });
            cancel = ui
                .add(Button::new(words.say(Text::Cancel)).min_size(BUTTON.into()))
                .clicked();
        });
        if let Some(version) = &tapped {
            self.restore(version);
        }
        if tapped.is_some() || cancel || modal.should_close() {
            self.over = Over::Nothing;
        }
    }

    fn restore(&mut self, version: &Path) {
        if let Some(parameters) = &mut self.opened {
            let restored = parameters.restore(version);
            self.failed = restored.err().map(|error| sentence(error.as_ref()));
        }
        self.choose_again();
    }
}
