//! The page of the screen itself: language, contrast, hand, size.

use super::View;
use crate::station::Station;
use crate::texts::{Language, Text};
use eframe::egui::{Grid, RichText, Slider, Ui};

/// How the screen looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The language.
    pub language: Language,
    /// Black, white and few colours.
    pub high_contrast: bool,
    /// Stop and controls on the left.
    pub left_handed: bool,
    /// Size of everything; 1 is for a panel of 1280 × 800.
    pub zoom: f32,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            language: Language::default(),
            high_contrast: false,
            left_handed: false,
            zoom: 1.0,
        }
    }
}

pub(super) fn show(ui: &mut Ui, view: &View, look: &mut Look, station: &Station) {
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
            ui.add(Slider::new(&mut look.zoom, 0.75..=2.5).step_by(0.05))
                .labelled_by(label.id);
            ui.end_row();
        });
    ui.add_space(8.0);
    ui.checkbox(&mut look.high_contrast, words.say(Text::Contrast));
    ui.checkbox(&mut look.left_handed, words.say(Text::LeftHanded));
    ui.add_space(24.0);
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
    ui.add_space(24.0);
    ui.label(RichText::new(words.say(Text::Keys)).color(view.theme.faint));
    let version = words.with(Text::Version, &[env!("CARGO_PKG_VERSION")]);
    ui.label(RichText::new(version).color(view.theme.faint));
}
