//! What is wrong, and all that happened.

use super::{View, title};
use crate::live::{Earlier, Journal, Severity};
use crate::texts::Text;
use eframe::egui::{Color32, Frame, Label, RichText, ScrollArea, Ui};

/// Alarms that nobody has taken note of.
pub fn open(ui: &mut Ui, view: &View, journal: &Journal) {
    let words = view.words;
    ui.heading(words.say(Text::Alarms));
    if journal.open_alarms().next().is_none() {
        ui.label(RichText::new(words.say(Text::NoAlarms)).color(view.theme.good));
    }
    for alarm in journal.open_alarms() {
        Frame::new()
            .stroke((2.0, view.theme.bad))
            .corner_radius(6)
            .inner_margin(10)
            .show(ui, |ui| {
                ui.set_width(ui.available_width());
                let text = RichText::new(words.happened(&alarm.what)).size(18.0);
                ui.add(Label::new(text).wrap());
            });
    }
}

/// All that happened, and what is on record of before.
pub fn history(ui: &mut Ui, view: &View, journal: &Journal, earlier: &[Earlier]) {
    let words = view.words;
    ui.add_space(16.0);
    ui.heading(words.say(Text::History));
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for entry in journal.entries().rev() {
            let seconds = entry.at.as_secs();
            let time = format!(
                "{:02}:{:02}:{:02}",
                seconds / 3600,
                seconds / 60 % 60,
                seconds % 60
            );
            let colour = colour(ui, view, entry.severity);
            line(ui, view, &time, &words.happened(&entry.what), colour);
        }
        if !earlier.is_empty() {
            ui.add_space(8.0);
            title(ui, view, words.say(Text::EarlierHistory));
        }
        for entry in earlier.iter().rev() {
            let colour = colour(ui, view, entry.severity);
            // Without the offset of the zone; the file has it.
            let time = entry.time.get(..19).unwrap_or(&entry.time).replace('T', " ");
            line(ui, view, &time, &entry.text, colour);
        }
    });
}

fn line(ui: &mut Ui, view: &View, time: &str, text: &str, colour: Color32) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(time).monospace().color(view.theme.faint));
        ui.add(Label::new(RichText::new(text).color(colour)).wrap());
    });
}

fn colour(ui: &Ui, view: &View, severity: Severity) -> Color32 {
    match severity {
        Severity::Note => ui.visuals().text_color(),
        Severity::Waits => view.theme.doubt,
        Severity::Alarm => view.theme.bad,
    }
}
