//! The pages for looking, and what all pages have in common.

pub mod alarms;
pub mod bar;
pub mod curves;
pub mod look;
pub mod pages;
pub mod plot;
pub mod run;
pub mod theme;
mod viewer;

pub use pages::Page;
pub use viewer::Viewer;

use crate::look::Look;
use crate::texts::{Text, Words};
use eframe::egui::{self, Response, RichText, Ui};
use std::time::Duration;
use theme::Theme;

/// What a screen that shows something live waits before it is drawn anew: 20 times a second.
pub const FRAME: Duration = Duration::from_millis(50);
/// Height of what is always in sight \[points\].
pub const BAR: f32 = 76.0;
/// Width of the list of pages \[points\].
pub const RAIL: f32 = 124.0;

/// What every page is given.
pub struct View<'a> {
    /// The language.
    pub words: Words,
    /// The colours.
    pub theme: &'a Theme,
    /// The screen's clock.
    pub now: Duration,
    /// What is said where no program is loaded.
    pub no_program: Text,
}

impl<'a> View<'a> {
    /// By the `look` of the screen, which `ui` takes on.
    pub fn of(ui: &Ui, look: &Look, theme: &'a Theme, now: Duration) -> Self {
        theme.apply(ui.ctx());
        ui.ctx().set_zoom_factor(look.zoom);
        Self {
            words: Words(look.language),
            theme,
            now,
            no_program: Text::NoProgram,
        }
    }
}

/// A panel without a ground of its own: where graphics are drawn by software every layer counts.
pub fn bare(panel: egui::Panel) -> egui::Panel {
    panel.frame(egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 2)))
}

/// What may be higher than the panel.
pub fn scroll() -> egui::ScrollArea {
    egui::ScrollArea::vertical().auto_shrink(false)
}

/// A small heading.
pub fn title(ui: &mut Ui, view: &View, text: &str) -> Response {
    ui.label(RichText::new(text).size(14.0).color(view.theme.faint))
}

/// What is said where there is nothing to show.
pub fn nothing(ui: &mut Ui, view: &View, text: Text) {
    ui.centered_and_justified(|ui| {
        ui.label(RichText::new(view.words.say(text)).color(view.theme.faint));
    });
}
