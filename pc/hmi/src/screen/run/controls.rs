//! What an operator asks of the job. Greyed where it makes no sense, and where the boards are silent.

use super::{Over, title};
use crate::screen::View;
use crate::station::{Action, LARGEST_OVERRIDE, OVERRIDES, Station};
use crate::texts::Text;
use eframe::egui::{Button, Color32, RichText, Slider, Ui};
use host_link::Command;

/// Height of a button \[points\].
const HEIGHT: f32 = 62.0;

pub(super) fn show(ui: &mut Ui, view: &View, station: &mut Station, over: &mut Over) {
    ui.add_space(4.0);
    let may = |station: &Station, action| station.may(action, view.now);
    if large(ui, view, Text::Load, may(station, Action::Load), None) {
        *over = Over::Programs;
    }
    if large(
        ui,
        view,
        Text::Start,
        may(station, Action::Start),
        Some(view.theme.good),
    ) {
        *over = Over::Start;
    }
    ui.add_space(4.0);
    for (text, action, command) in [
        (Text::Hold, Action::Hold, Command::Hold),
        (Text::Resume, Action::Resume, Command::Resume),
        (Text::Back, Action::Back, Command::Back),
    ] {
        let colour = (action == Action::Hold).then_some(view.theme.doubt);
        if large(ui, view, text, may(station, action), colour) {
            station.send(command, view.now);
        }
    }
    let mut single = station.single_block;
    if ui
        .checkbox(&mut single, view.words.say(Text::SingleBlock))
        .changed()
    {
        station.single_block = single;
        station.send(Command::SingleBlock(single), view.now);
    }
    ui.add_space(4.0);
    feed(ui, view, station);
}

/// The feed override.
fn feed(ui: &mut Ui, view: &View, station: &mut Station) {
    let label = title(ui, view, view.words.say(Text::Override)).id;
    ui.add_enabled_ui(station.may(Action::Override, view.now), |ui| {
        let mut percent = station.override_percent;
        ui.spacing_mut().slider_width = 120.0;
        let slider = Slider::new(&mut percent, 0.0..=LARGEST_OVERRIDE)
            .step_by(5.0)
            .suffix(" %");
        if ui.add(slider).labelled_by(label).changed() {
            station.set_override(percent, view.now);
        }
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 3.0;
        ui.horizontal(|ui| {
            for percent in OVERRIDES {
                let text = RichText::new(format!("{percent:.0}")).size(15.0);
                let chosen = station.override_percent == percent;
                if ui
                    .add(Button::selectable(chosen, text).min_size([36.0, 44.0].into()))
                    .clicked()
                {
                    station.set_override(percent, view.now);
                }
            }
        });
    });
}

/// A button for a gloved finger.
fn large(ui: &mut Ui, view: &View, text: Text, enabled: bool, colour: Option<Color32>) -> bool {
    let mut label = RichText::new(view.words.say(text)).size(20.0);
    let mut button = match colour.filter(|_| enabled) {
        Some(colour) => {
            label = label.color(Color32::BLACK);
            Button::new(label).fill(colour)
        }
        None => Button::new(label),
    };
    button = button.min_size([ui.available_width(), HEIGHT].into());
    let placed = ui.vertical_centered_justified(|ui| ui.add_enabled(enabled, button).clicked());
    placed.inner
}
