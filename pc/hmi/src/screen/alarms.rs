//! The page of alarms: what is wrong, and all that happened.

use super::View;
use crate::station::Station;
use crate::texts::Text;
use eframe::egui::{Button, RichText, Ui};
use view::screen::alarms::{history, open};

pub(super) fn show(ui: &mut Ui, view: &View, station: &mut Station) {
    open(ui, view, &station.live.journal);
    if station.live.journal.open_alarms().next().is_some() {
        let acknowledge = RichText::new(view.words.say(Text::Acknowledge)).size(18.0);
        let acknowledge = Button::new(acknowledge).min_size([160.0, 56.0].into());
        if ui.add(acknowledge).clicked() {
            station.live.journal.acknowledge();
        }
    }
    history(ui, view, &station.live.journal, station.earlier());
}
