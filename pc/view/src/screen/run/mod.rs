//! The page of the job, as it is only looked at: program, path, cameras, deviations, figures.

mod cameras;
mod deviations;
mod figures;
mod program;
mod way;

use super::curves::Curves;
use super::{View, bare, nothing, title};
use crate::seen::Seen;
pub use cameras::Textures;
pub use deviations::curve;
use eframe::egui::{self, Frame, Ui};

/// Width of the program \[points\].
const PROGRAM: f32 = 262.0;
/// Height of the figures \[points\].
const FIGURES: f32 = 64.0;
/// Part of the height that path and program take, above cameras and deviations.
const UPPER: f32 = 0.53;

/// What the page remembers between two frames.
#[derive(Default)]
pub struct Sight {
    way: way::Standpoint,
    cameras: cameras::Textures,
    deviations: Curves,
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
                        .exact_size((height * 1.5).min(ui.available_width() / 2.0))
                        .resizable(false)
                        .show(ui, |ui| {
                            self.cameras.show(ui, view, seen.live, |ui, picture| {
                                cameras::figures(ui, view, picture);
                            });
                        });
                    deviations::show(ui, view, seen, &mut self.deviations);
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
