//! The page of the job: program, path, cameras, deviations, figures, controls.

mod cameras;
mod controls;
mod deviations;
mod figures;
mod loading;
mod program;
mod way;

use super::{View, bare, nothing, title};

use crate::seen::Seen;
use crate::station::{Action, Station};
pub(super) use deviations::line;
use eframe::egui::{self, Frame, Ui};
use std::time::Duration;

/// Width of the controls \[points\].
const CONTROLS: f32 = 216.0;
/// Width of the program \[points\].
const PROGRAM: f32 = 262.0;
/// Height of the figures \[points\].
const FIGURES: f32 = 64.0;
/// Part of the height that path and program take, above cameras and deviations.
const UPPER: f32 = 0.53;

/// What the page remembers between two frames.
#[derive(Default)]
pub(super) struct RunPage {
    sight: Sight,
    over: Over,
}

/// The same, of what is only looked at.
#[derive(Default)]
pub(super) struct Sight {
    way: way::Standpoint,
    cameras: cameras::Textures,
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

impl Sight {
    /// Shows everything but the controls; a line of the program that is tapped, from 1.
    pub fn show(&mut self, ui: &mut Ui, view: &View, seen: &Seen) -> Option<u32> {
        bare(egui::Panel::top("figures"))
            .exact_size(FIGURES)
            .show(ui, |ui| figures::show(ui, view, seen));
        if seen.program.is_some_and(|(drawn, _)| drawn.is_tracked) {
            let height = ui.available_height() * (1.0 - UPPER);
            bare(egui::Panel::bottom("seam"))
                .exact_size(height)
                .show(ui, |ui| {
                    bare(egui::Panel::right("cameras"))
                        .exact_size(height * 1.5)
                        .resizable(false)
                        .show(ui, |ui| {
                            self.cameras.show(ui, view, seen.live);
                        });
                    deviations::show(ui, view, seen);
                });
        }
        let tapped = bare(egui::Panel::left("program"))
            .exact_size(PROGRAM)
            .resizable(false)
            .show(ui, |ui| program::show(ui, view, seen))
            .inner;
        Frame::new()
            .inner_margin(8)
            .show(ui, |ui| self.way.show(ui, view, seen));
        tapped
    }
}

/// A frame with rounded corners, as wide as there is room.
fn card(view: &View) -> Frame {
    Frame::new()
        .fill(view.theme.card)
        .corner_radius(6)
        .inner_margin(8)
}
