//! What is changed and not written yet, and what can be done with it.

use super::{Over, ParametersPage};
use crate::screen::{View, access, title, writing};
use crate::station::{Action, Station};
use crate::texts::Text;
use eframe::egui::{Button, Color32, Label, RichText, ScrollArea, Ui};

/// Height of a button \[points\].
const HEIGHT: f32 = 52.0;

impl ParametersPage {
    pub(super) fn changes(&mut self, ui: &mut Ui, view: &View, station: &Station) {
        let words = view.words;
        let Some(parameters) = &self.opened else { return };
        let is_free = station.may(Action::Write, view.now);
        let may_write =
            is_free && parameters.is_changed() && parameters.refused().is_none() && !self.is_stale;
        let may_discard = parameters.is_changed();
        ui.add_space(4.0);
        title(ui, view, words.say(Text::Changes));
        let mut told: Vec<(String, Color32)> = Vec::new();
        if self.is_stale {
            told.push((words.say(Text::StaleFile).to_owned(), view.theme.bad));
        }
        if self.is_other {
            told.push((words.say(Text::OtherMachine).to_owned(), view.theme.doubt));
        }
        if let Some(failed) = &self.failed {
            told.push((failed.clone(), view.theme.bad));
        }
        if let Some(error) = parameters.refused() {
            told.push((words.with(Text::Refused, &[&error.to_string()]), view.theme.bad));
        }
        if !is_free && station.allows(Action::Write) {
            told.push((words.say(Text::WriteAtRest).to_owned(), view.theme.doubt));
        }
        let height = ui.available_height() - HEIGHT - 16.0;
        ScrollArea::vertical()
            .id_salt("changes")
            .max_height(height)
            .min_scrolled_height(height)
            .auto_shrink(false)
            .show(ui, |ui| {
                access::needed(ui, view, station, Action::Write);
                for (text, colour) in told {
                    ui.add(Label::new(RichText::new(text).size(15.0).color(colour)).wrap());
                }
                writing::changes(ui, view, parameters.changes(), parameters.is_changed());
            });
        let mut asked = None;
        ui.horizontal(|ui| {
            let offered: &[(Text, bool)] = if self.is_stale {
                &[(Text::LoadAnew, true)]
            } else {
                &[
                    (Text::Write, may_write),
                    (Text::Discard, may_discard),
                    (Text::Versions, is_free),
                ]
            };
            for (text, enabled) in offered {
                if button(ui, view, *text, *enabled) {
                    asked = Some(*text);
                }
            }
        });
        match asked {
            Some(Text::LoadAnew) => self.load(station),
            Some(Text::Write) => {
                self.is_stale = parameters.is_stale();
                self.over = if self.is_stale { Over::Nothing } else { Over::Write };
            }
            Some(Text::Discard) => self.discard(),
            Some(Text::Versions) => (self.versions, self.over) = (parameters.versions(), Over::Versions),
            _ => {}
        }
    }

    fn discard(&mut self) {
        self.failed = None;
        if let Some(parameters) = &mut self.opened {
            parameters.discard();
        }
        self.choose_again();
    }
}

/// A button for a gloved finger.
fn button(ui: &mut Ui, view: &View, text: Text, enabled: bool) -> bool {
    let button = Button::new(view.words.say(text)).min_size([124.0, HEIGHT].into());
    ui.add_enabled(enabled, button).clicked()
}
