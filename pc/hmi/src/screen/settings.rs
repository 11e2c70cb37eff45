//! The page of the screen itself: language, contrast, hand, size; and who may do what.

use super::{View, levels};
use crate::settings::{Look, SIZES};
use crate::station::Station;
use crate::texts::{Language, Text};
use eframe::egui::{Grid, RichText, Slider, Ui};

pub(super) fn show(
    ui: &mut Ui,
    view: &View,
    look: &mut Look,
    station: &mut Station,
    refused: &mut levels::Refused,
) {
    let words = view.words;
    ui.heading(words.say(Text::Settings));
    ui.add_space(12.0);
    Grid::new("look")
        .num_columns(2)
        .spacing([24.0, 16.0])
        .show(ui, |ui| {
            ui.label(words.say(Text::LanguageChoice));
            ui.horizontal(|ui| {
                for language in Language::ALL {
                    let name = RichText::new(language.name()).size(18.0);
                    ui.selectable_value(&mut look.language, language, name);
                }
            });
            ui.end_row();
            let label = ui.label(words.say(Text::Size));
            ui.add(Slider::new(&mut look.zoom, SIZES).step_by(0.05))
                .labelled_by(label.id);
            ui.end_row();
        });
    ui.add_space(8.0);
    ui.checkbox(&mut look.high_contrast, words.say(Text::Contrast));
    ui.checkbox(&mut look.left_handed, words.say(Text::LeftHanded));
    ui.add_space(12.0);
    levels::show(ui, view, station, refused);
    ui.add_space(12.0);
    Grid::new("station")
        .num_columns(2)
        .spacing([24.0, 8.0])
        .show(ui, |ui| {
            for (name, value) in [
                (Text::Machine, station.machine_file().display().to_string()),
                (
                    Text::Boards,
                    format!("{}, {}", station.place.boards.name(), station.place.plant),
                ),
            ] {
                ui.label(words.say(name));
                ui.label(value);
                ui.end_row();
            }
        });
    ui.add_space(12.0);
    ui.label(RichText::new(words.say(Text::Keys)).color(view.theme.faint));
    let version = words.with(Text::Version, &[env!("CARGO_PKG_VERSION")]);
    ui.label(RichText::new(version).color(view.theme.faint));
}
