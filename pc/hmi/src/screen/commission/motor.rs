//! What was found of a motor: verdict, figures, curves.

use super::{curves, left_over, say, words};
use crate::commissioning::{Measured, Motor};
use crate::screen::View;
use crate::texts::Text;
use commission::{Found, Margins};
use eframe::egui::{Grid, Label, RichText, Ui};

/// Width of the table of figures \[points\].
const TABLE: f32 = 350.0;
/// Least height of all curves \[points\].
const LEAST: f32 = 400.0;

/// On a page that ends at `bottom`.
pub(super) fn show(ui: &mut Ui, view: &View, motor: &Motor, bottom: f32) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(motor.name()).size(22.0).strong());
        if let Some(measured) = motor.measured() {
            let text = view
                .words
                .with(Text::MeasuredAt, &[&measured.at.replace('T', " ")]);
            ui.label(RichText::new(text).size(14.0).color(view.theme.faint));
        }
    });
    for (text, colour) in words::verdict(view, motor) {
        say(ui, text, colour);
    }
    let Some(measured) = motor.measured() else { return };
    if let Ok(found) = &measured.found {
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(TABLE);
                figures(ui, view, measured, found);
            });
            ui.vertical(|ui| {
                for part in words::parts(view, motor, found) {
                    ui.add(Label::new(RichText::new(part).size(14.0)).wrap());
                }
            });
        });
    }
    let height = left_over(ui, bottom, LEAST);
    curves::show(ui, view, &measured.lines, measured.found.as_ref().ok(), height);
}

fn figures(ui: &mut Ui, view: &View, measured: &Measured, found: &Found) {
    let words = view.words;
    let (before, now) = (&found.of_loop.before, &found.of_loop.margins);
    type Of = fn(&Margins) -> String;
    let rows: [(Text, Of); 4] = [
        (Text::GainMargin, |margins| format!("{:.1}", margins.gain_db)),
        (Text::PhaseMargin, |margins| format!("{:.1}", margins.phase_deg)),
        (Text::Sensitivity, |margins| format!("{:.2}", margins.peak)),
        (Text::Crossover, |margins| format!("{:.1}", margins.crossover_hz)),
    ];
    Grid::new("margins")
        .num_columns(3)
        .spacing([18.0, 2.0])
        .min_row_height(18.0)
        .show(ui, |ui| {
            let mut row = |name: &str, before: String, now: String| {
                ui.label(RichText::new(name).size(14.0));
                ui.label(RichText::new(before).size(14.0).color(view.theme.slides[2]));
                ui.label(RichText::new(now).size(14.0).color(view.theme.slides[0]));
                ui.end_row();
            };
            let heading = |text| words.say(text).to_owned();
            row("", heading(Text::BeforeLoop), heading(Text::NowLoop));
            let kp = [measured.before.kp, found.of_loop.motor.kp].map(|kp| format!("{kp:.1}"));
            let [was, is] = kp;
            row(words.say(Text::LoopGain), was, is);
            for (name, of) in rows {
                let [was, is] = [before, now].map(of);
                row(words.say(name), was, is);
            }
        });
}
