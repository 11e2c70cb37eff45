//! What is always in sight: state, what the machine does and waits for, and Stop.

use super::View;
use crate::station::Station;
use crate::texts::Text;
use eframe::egui::{Align, Button, Color32, Direction, Layout, RichText, Ui, UiBuilder};
use host_link::Command;
use view::screen::bar::{state, told};

/// Width of Stop \[points\].
const STOP: f32 = 150.0;

pub(super) fn show(ui: &mut Ui, view: &View, station: &mut Station, left_handed: bool) {
    let area = ui.max_rect();
    let (stop, rest) = if left_handed {
        let (stop, rest) = area.split_left_right_at_x(area.left() + STOP);
        (stop, rest.with_min_x(rest.left() + 12.0))
    } else {
        let (rest, stop) = area.split_left_right_at_x(area.right() - STOP);
        (stop, rest.with_max_x(rest.right() - 12.0))
    };
    let centred = Layout::centered_and_justified(Direction::TopDown);
    ui.scope_builder(
        UiBuilder::new().max_rect(stop.shrink(4.0)).layout(centred),
        |ui| stop_button(ui, view, station),
    );
    ui.scope_builder(
        UiBuilder::new()
            .max_rect(rest.shrink(4.0))
            .layout(Layout::left_to_right(Align::Center)),
        |ui| {
            let seen = station.seen();
            state(ui, view, &seen);
            told(ui, view, &seen);
        },
    );
}

/// Never greyed while anything runs, whatever else is lost.
fn stop_button(ui: &mut Ui, view: &View, station: &mut Station) {
    let text = RichText::new(view.words.say(Text::Stop))
        .size(30.0)
        .strong()
        .color(Color32::WHITE);
    let button = Button::new(text).fill(Color32::from_rgb(200, 20, 20));
    if ui
        .add(button)
        .on_hover_text(view.words.say(Text::StopHint))
        .clicked()
    {
        station.send(Command::Stop, view.now);
    }
}
