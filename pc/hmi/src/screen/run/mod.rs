//! The page of the job: program, path, cameras, deviations, figures, controls.

mod controls;
mod loading;

use super::{View, bare, title};
use crate::station::{Action, Station};
use eframe::egui::{self, Ui};
use std::time::Duration;
use view::screen::run::Sight;

/// Width of the controls \[points\].
const CONTROLS: f32 = 216.0;

/// What the page remembers between two frames.
#[derive(Default)]
pub(super) struct RunPage {
    sight: Sight,
    over: Over,
}

/// What is open over the page.
#[derive(Clone, Debug, Default, PartialEq)]
enum Over {
    #[default]
    Nothing,
    /// The list of programs.
    Programs,
    /// The question before a start.
    Start,
}

impl RunPage {
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station, left_handed: bool) {
        let controls = if left_handed {
            bare(egui::Panel::left("controls"))
        } else {
            bare(egui::Panel::right("controls"))
        };
        controls.exact_size(CONTROLS).resizable(false).show(ui, |ui| {
            controls::show(ui, view, station, &mut self.over);
        });
        if let Some(line) = self.sight.show(ui, view, &station.seen()) {
            begin_at(station, line, view.now);
        }
        match self.over {
            Over::Nothing => {}
            Over::Programs => loading::programs(ui, view, station, &mut self.over),
            Over::Start => loading::start(ui, view, station, &mut self.over),
        }
    }
}

/// Has the program begin at `line`, or at its beginning again, where nothing runs.
fn begin_at(station: &mut Station, line: u32, now: Duration) {
    let Some(loaded) = station.loaded().filter(|_| station.may(Action::Start, now)) else {
        return;
    };
    let again = loaded.drawn.from_line == Some(line);
    let program = loaded.program_file.clone();
    station.load(program, (!again).then_some(line));
}
