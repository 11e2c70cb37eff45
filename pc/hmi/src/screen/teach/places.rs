//! Places to which the tip is led, and the panel to lead it by.

use super::{Over, TeachPage, button, told};
use crate::screen::{View, jog, title, writing};
use crate::station::{Action, Station};
use crate::teaching::Teaching;
use crate::texts::Text;
use eframe::egui::{Label, RichText, ScrollArea, Ui};

/// What the tip is led by.
pub(super) fn led(ui: &mut Ui, view: &View, station: &mut Station, panel: &mut jog::Panel) {
    panel.show(ui, view, station);
    if station.by_hand().is_none() {
        ui.add(Label::new(view.words.say(Text::HomeFirst)).wrap());
    }
    if let Some(told) = &station.live.told {
        ui.add(Label::new(RichText::new(told).color(view.theme.doubt)).wrap());
    }
}

impl TeachPage {
    /// Places are taken, taken out and planned.
    pub(super) fn places(&mut self, ui: &mut Ui, view: &View, station: &mut Station, rests: bool) {
        let Some(Teaching::Places(places)) = &mut self.teaching else {
            return;
        };
        let ready = station.may(Action::ByHand, view.now);
        let none = places.points().is_empty() || !station.allows(Action::Teach);
        let mut done = None;
        ui.horizontal(|ui| {
            if button(ui, view, Text::Take, ready)
                && let (Some(machine), Some(motion)) = (station.by_hand(), &station.live.motion)
            {
                done = Some(match station.teach(|| places.take(machine, &motion.reference)) {
                    Ok(true) => Ok((Text::Taken, places.points().len().to_string())),
                    Ok(false) => Ok((Text::TakenAlready, String::new())),
                    Err(error) => Err(error),
                });
            }
            if button(ui, view, Text::Undo, !none) {
                let undone = station.teach(|| places.undo());
                done = Some(undone.map(|()| (Text::Undone, String::new())));
            }
        });
        ui.horizontal(|ui| {
            if button(ui, view, Text::PlanProgram, station.by_hand().is_some() && !none)
                && let Some(machine) = station.by_hand()
            {
                done = Some(station.teach(|| places.plan(machine)).map(|program| {
                    let name = writing::name(&program);
                    station.load(program, None);
                    (Text::Planned, name)
                }));
            }
            if button(ui, view, Text::Restart, rests && !none) {
                self.over = Over::Restart;
            }
        });
        if let Some(done) = done {
            self.said = Some(told(done));
        }
        self.say(ui, view);
        let Some(Teaching::Places(places)) = &self.teaching else {
            return;
        };
        let heading = view
            .words
            .with(Text::PlacesIn, &[&writing::name(places.places_file())]);
        title(ui, view, &heading);
        ScrollArea::vertical().stick_to_bottom(true).show(ui, |ui| {
            for (number, point) in (1..).zip(places.points()) {
                let [x, y, z] = point.position_mm;
                let [a, b, c] = point.angles_deg;
                // No angle is -0.
                let [a, b, c] = [a, b, c].map(|angle| (angle * 1e2).round() / 1e2 + 0.0);
                let text = format!("{number:2} {x:8.2} {y:8.2} {z:8.2} {a:7.2} {b:7.2} {c:7.2}");
                ui.label(RichText::new(text).monospace().size(12.0));
            }
        });
    }
}
