//! The page of the job: program, path, cameras, deviations, figures, controls.

mod cameras;
mod controls;
mod deviations;
mod figures;
mod loading;
mod program;
mod way;

use super::{View, bare, nothing, title};

use crate::station::Station;
pub(super) use deviations::line;
use eframe::egui::{self, Frame, Ui};

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
    way: way::Standpoint,
    cameras: cameras::Textures,
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
        bare(egui::Panel::top("figures"))
            .exact_size(FIGURES)
            .show(ui, |ui| figures::show(ui, view, station));
        let tracked = station
            .loaded()
            .is_some_and(|loaded| loaded.machine.tracking.is_some());
        if tracked {
            let height = ui.available_height() * (1.0 - UPPER);
            bare(egui::Panel::bottom("seam"))
                .exact_size(height)
                .show(ui, |ui| {
                    bare(egui::Panel::right("cameras"))
                        .exact_size(height * 1.5)
                        .resizable(false)
                        .show(ui, |ui| {
                            self.cameras.show(ui, view, &station.live);
                        });
                    deviations::show(ui, view, station);
                });
        }
        bare(egui::Panel::left("program"))
            .exact_size(PROGRAM)
            .resizable(false)
            .show(ui, |ui| {
                program::show(ui, view, station);
            });
        Frame::new()
            .inner_margin(8)
            .show(ui, |ui| self.way.show(ui, view, station));
        match self.over {
            Over::Nothing => {}
            Over::Programs => loading::programs(ui, view, station, &mut self.over),
            Over::Start => loading::start(ui, view, station, &mut self.over),
        }
    }
}

/// A frame with rounded corners, as wide as there is room.
fn card(view: &View) -> Frame {
    Frame::new()
        .fill(view.theme.card)
        .corner_radius(6)
        .inner_margin(8)
}
