//! The page of the screen itself: language, contrast, hand, size; and who may do what.

use super::{View, levels, qr};
use crate::serving::{Server, VIEWERS};
use crate::station::Station;
use crate::texts::{Text, Words};
use eframe::egui::{Grid, Ui};
use view::look::Look;
use view::screen::look::{appearance, footer};

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
    ui.horizontal(|ui| {
        ui.checkbox(&mut look.left_handed, words.say(Text::LeftHanded));
        ui.add_space(24.0);
        ui.checkbox(&mut look.keys_on_screen, words.say(Text::KeysOnScreen));
    });
    ui.add_space(12.0);
    levels::show(ui, view, station, refused);
    ui.add_space(12.0);
    let link = server.and_then(|server| server.told().link());
    ui.horizontal_top(|ui| {
        about(ui, words, station, server);
        if let Some(link) = link {
            qr::show(ui, &link);
        }
    });
    ui.add_space(12.0);
    footer(ui, view, Text::Keys);
}

/// What the screen commands, and who watches.
fn about(ui: &mut Ui, words: Words, station: &Station, server: Option<&Server>) {
    let rows = [
        (Text::Machine, station.machine_file().display().to_string()),
        (
            Text::Boards,
            format!("{}, {}", station.place.boards.name(), station.place.plant),
        ),
    ];
    Grid::new("station")
        .num_columns(2)
        .spacing([24.0, 8.0])
        .show(ui, |ui| {
            for (name, value) in rows.into_iter().chain(served(words, server)) {
                ui.label(words.say(name));
                ui.label(value);
                ui.end_row();
            }
        });
}

/// What somebody has to know to watch.
fn served(words: Words, server: Option<&Server>) -> Vec<(Text, String)> {
    let Some(server) = server else {
        return vec![(Text::Served, words.say(Text::NotServed).to_owned())];
    };
    let told = server.told();
    let watching = [server.watching(), VIEWERS].map(|count| count.to_string());
    let watching = words.with(Text::ServedTo, &[&watching[0], &watching[1]]);
    let link = told
        .link()
        .unwrap_or_else(|| words.say(Text::NoPageServed).to_owned());
    vec![
        (Text::Served, watching),
        (Text::ServedAt, told.address.to_string()),
        (Text::ServedToken, told.token.clone()),
        (Text::ServedPage, link),
        (Text::ServedFingerprint, told.fingerprint.clone()),
    ]
}
