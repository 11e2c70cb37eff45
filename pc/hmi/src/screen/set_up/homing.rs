//! How far the search for the reference marks is.

use super::title;
use crate::screen::View;
use crate::station::Station;
use crate::texts::Text;
use eframe::egui::{RichText, Ui};
use shared::io::{MOTOR_NAMES, MOTORS, SLIDE_NAMES};
use shared::state::{State, TrackerState};

pub(super) fn show(ui: &mut Ui, view: &View, station: &Station) {
    let (Some(machine), Some(motion)) = (station.by_hand(), &station.live.motion) else {
        return;
    };
    let homing = motion.state == State::Homing;
    let fitted = (0..MOTORS).filter(|motor| machine.is.motion.motors[*motor].is_some());
    let motors = fitted.map(|motor| {
        let bit = 1 << motor;
        let found = if motion.referenced & bit != 0 {
            Found::Yes
        } else if motion.searching & bit != 0 {
            Found::Searches
        } else if homing {
            Found::Waits
        } else {
            Found::No
        };
        (MOTOR_NAMES[motor], found)
    });
    let mut all: Vec<_> = motors.collect();
    if let (Some(tracker), Some(unit)) = (&station.live.tracker, &machine.is.tracking) {
        let fitted = SLIDE_NAMES.into_iter().take(unit.board.slides.len());
        let slides = fitted.enumerate().map(|(slide, name)| {
            let found = match tracker.state {
                _ if tracker.referenced & (1 << slide) != 0 => Found::Yes,
                TrackerState::Homing => Found::Searches,
                _ => Found::No,
            };
            (name, found)
        });
        all.extend(slides);
    }
    if all.iter().all(|(_, found)| *found == Found::Yes) {
        // One line: what is below needs the room.
        let text = format!(
            "{}: {} OK",
            view.words.say(Text::References),
            of(&all, Found::Yes)
        );
        ui.label(RichText::new(text).size(13.0).color(view.theme.good));
        return;
    }
    title(ui, view, view.words.say(Text::References));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 18.0;
        for (name, found) in &all {
            let (mark, colour) = match found {
                Found::Yes => ("OK", view.theme.good),
                Found::Searches => ("…", view.theme.doubt),
                Found::Waits | Found::No => ("–", view.theme.faint),
            };
            ui.label(RichText::new(format!("{name} {mark}")).size(17.0).color(colour));
        }
    });
    let searching = of(&all, Found::Searches);
    let waiting = of(&all, Found::Waits);
    let text = match (searching.is_empty(), waiting.is_empty()) {
        (true, true) => return,
        (true, false) => view.words.say(Text::DrivesComeOn).to_owned(),
        (false, true) => view.words.with(Text::SearchesNow, &[&searching]),
        (false, false) => view.words.with(Text::WaitsForOthers, &[&searching, &waiting]),
    };
    ui.label(RichText::new(text).size(14.0));
}

/// Whether a motor or slide has its reference.
#[derive(Clone, Copy, PartialEq)]
enum Found {
    Yes,
    Searches,
    /// It is not its turn.
    Waits,
    No,
}

fn of(all: &[(&str, Found)], found: Found) -> String {
    let names = all.iter().filter(|(_, is)| *is == found).map(|(name, _)| *name);
    names.collect::<Vec<_>>().join(", ")
}
