//! The page of the screen itself: language, contrast, hand, size; and who may do what.

use super::{View, levels};
use crate::serving::{Server, VIEWERS};
use crate::settings::{Look, SIZES};
use crate::station::Station;
use crate::texts::{Language, Text, Words};
use eframe::egui::{Grid, RichText, Slider, Ui};

pub(super) fn show(
    ui: &mut Ui,
    view: &View,
    look: &mut Look,
    station: &mut Station,
    refused: &mut levels::Refused,
    server: Option<&Server>,
) {
    let words = view.words;
    appearance(ui, view, look);
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
            ]
            .into_iter()
            .chain(served(words, server))
            {
                ui.label(words.say(name));
                ui.label(value);
                ui.end_row();
            }
        });
    ui.add_space(12.0);
    footer(ui, view, Text::Keys);
}

/// What somebody has to know to watch.
fn served(words: Words, server: Option<&Server>) -> Vec<(Text, String)> {
    let Some(server) = server else {
        return vec![(Text::Served, words.say(Text::NotServed).to_owned())];
    };
    let told = server.told();
    let watching = [server.watching(), VIEWERS].map(|count| count.to_string());
    let watching = words.with(Text::ServedTo, &[&watching[0], &watching[1]]);
    vec![
        (Text::Served, watching),
        (Text::ServedAt, told.address.to_string()),
        (Text::ServedToken, told.token.clone()),
        (Text::ServedFingerprint, told.fingerprint.clone()),
    ]
}

/// Language, size and contrast.
pub(super) fn appearance(ui: &mut Ui, view: &View, look: &mut Look) {
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
}

/// Keys, and the version.
pub(super) fn footer(ui: &mut Ui, view: &View, keys: Text) {
    let words = view.words;
    ui.label(RichText::new(words.say(keys)).color(view.theme.faint));
    let version = words.with(Text::Version, &[env!("CARGO_PKG_VERSION")]);
    ui.label(RichText::new(version).color(view.theme.faint));
}
