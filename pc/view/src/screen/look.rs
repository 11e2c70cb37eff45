//! Of the page of the screen itself: language, size, contrast; keys and version.

use super::View;
use crate::look::{Look, SIZES};
use crate::texts::{Language, Text};
use eframe::egui::{Grid, RichText, Slider, Ui};

/// Language, size and contrast.
pub fn appearance(ui: &mut Ui, view: &View, look: &mut Look) {
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
pub fn footer(ui: &mut Ui, view: &View, keys: Text) {
    let words = view.words;
    ui.label(RichText::new(words.say(keys)).color(view.theme.faint));
    let version = words.with(Text::Version, &[env!("CARGO_PKG_VERSION")]);
    ui.label(RichText::new(version).color(view.theme.faint));
}
