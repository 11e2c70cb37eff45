//! The question before a file is written, and the changes that are listed in it.

use super::View;
use crate::texts::Text;
use config::parameters::{Change, EditError};
use eframe::egui::{Button, Color32, Id, Label, Modal, RichText, ScrollArea, Ui};
use std::path::Path;

/// Size of a button \[points\].
pub(super) const BUTTON: [f32; 2] = [200.0, 60.0];
/// Width of what opens \[points\].
pub(super) const WIDTH: f32 = 640.0;
/// Height of a list in it \[points\].
pub(super) const LIST: f32 = 300.0;

/// What is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    Nothing,
    Write,
    Cancel,
}

/// Asks whether to write what `list` lists to `file`, of which what is there now, if anything, is kept as `version`.
pub(super) fn ask(
    ui: &Ui,
    view: &View,
    file: &Path,
    version: Option<&Path>,
    list: impl FnOnce(&mut Ui),
) -> Answer {
    let words = view.words;
    let mut answer = Answer::Nothing;
    let modal = Modal::new(Id::unique("write")).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.heading(words.with(Text::WriteTitle, &[&name(file)]));
        ui.add_space(8.0);
        ScrollArea::vertical().max_height(LIST).show(ui, list);
        ui.add_space(8.0);
        then(ui, view, version);
        ui.add_space(12.0);
        ui.horizontal(|ui| {
            let text = RichText::new(words.say(Text::WriteNow))
                .size(20.0)
                .color(Color32::BLACK);
            let button = Button::new(text).fill(view.theme.doubt).min_size(BUTTON.into());
            if ui.add(button).clicked() {
                answer = Answer::Write;
            }
            let cancel = Button::new(words.say(Text::Cancel)).min_size(BUTTON.into());
            if ui.add(cancel).clicked() {
                answer = Answer::Cancel;
            }
        });
    });
    match answer {
        Answer::Nothing if modal.should_close() => Answer::Cancel,
        answer => answer,
    }
}

/// What becomes of what is in the file now, if there is one, and of the program.
pub(super) fn then(ui: &mut Ui, view: &View, version: Option<&Path>) {
    let words = view.words;
    if let Some(version) = version {
        ui.add(Label::new(words.with(Text::WriteKeeps, &[&name(version)])).wrap());
    }
    ui.add(Label::new(words.say(Text::WriteThen)).wrap());
}

/// The changes, a line each; `is_changed` the file may be without any.
pub(super) fn changes(ui: &mut Ui, view: &View, changes: &[Change], is_changed: bool) {
    let words = view.words;
    if changes.is_empty() {
        let none = if is_changed {
            Text::OnlyComments
        } else {
            Text::NoChanges
        };
        ui.label(RichText::new(words.say(none)).color(view.theme.faint));
    }
    for change in changes {
        ui.add(Label::new(words.change(change)).wrap());
    }
}

/// Why what was typed is no value.
pub(super) fn no_value(error: EditError) -> Text {
    match error {
        EditError::NotANumber => Text::NotANumber,
        EditError::NotWhole => Text::NotWhole,
        EditError::NotAValue => Text::NotAValue,
    }
}

/// The name of a file without its folder.
pub(super) fn name(file: &Path) -> String {
    file.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}
