//! The page of alarms: what is wrong, and all that happened.

use super::View;
use crate::live::{Entry, Journal, Severity, What};
use crate::texts::{Text, Words};
use eframe::egui::{Button, Frame, Label, RichText, ScrollArea, Ui};

pub(super) fn show(ui: &mut Ui, view: &View, journal: &mut Journal) {
    let words = view.words;
    ui.heading(words.say(Text::Alarms));
    let open: Vec<&Entry> = journal.open_alarms().collect();
    let any = !open.is_empty();
    if !any {
        ui.label(RichText::new(words.say(Text::NoAlarms)).color(view.theme.good));
    }
    for alarm in open {
        Frame::new()
            .stroke((2.0, view.theme.bad))
            .corner_radius(6)
            .inner_margin(10)
            .show(ui, |ui| {
                ui.set_width(ui.available_width());
                let text = RichText::new(said(words, &alarm.what)).size(18.0);
                ui.add(Label::new(text).wrap());
            });
    }
    if any {
        let acknowledge = Button::new(RichText::new(words.say(Text::Acknowledge)).size(18.0));
        if ui.add(acknowledge.min_size([160.0, 56.0].into())).clicked() {
            journal.acknowledge();
        }
    }
    ui.add_space(16.0);
    ui.heading(words.say(Text::History));
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for entry in journal.entries().rev() {
            let colour = match entry.severity {
                Severity::Note => ui.visuals().text_color(),
                Severity::Waits => view.theme.doubt,
                Severity::Alarm => view.theme.bad,
            };
            let seconds = entry.at.as_secs();
            let time = format!(
                "{:02}:{:02}:{:02}",
                seconds / 3600,
                seconds / 60 % 60,
                seconds % 60
            );
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(time).monospace().color(view.theme.faint));
                ui.add(Label::new(RichText::new(said(words, &entry.what)).color(colour)).wrap());
            });
        }
    });
}

/// What happened, in words.
pub(super) fn said(words: Words, what: &What) -> String {
    match what {
        What::Phase(phase) => words.phase(*phase),
        What::Question(question) => words.question(question),
        What::Connected(firmware) => words.with(Text::Connected, &[&firmware.join(", ")]),
        What::Finished => words.say(Text::JobFinished).to_owned(),
        What::MotionFault(fault) => words.fault(fault),
        What::TrackerFault(fault) => words.tracker_fault(fault),
        What::Stopped => words.say(Text::StoppedByOperator).to_owned(),
        What::FileWritten(file, version) => words.with(Text::FileWritten, &[file, version]),
        What::Parameter(change) => words.change(change),
        What::Said(text) => text.clone(),
    }
}
