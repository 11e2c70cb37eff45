//! Where a camera looks beside its spot: what to burn, and what was found last.

use super::{button, say};
use crate::running::FoundSpot;
use crate::screen::{View, writing};
use crate::station::{Action, Station};
use crate::texts::Text;
use eframe::egui::{Button, Grid, Label, RichText, TextEdit, Ui};
use job::Marking;
use shared::io::SIDES;

/// mm to µm.
const UM: f64 = 1e3;

/// What is typed and tapped.
pub(super) struct Entry {
    side: usize,
    power: String,
    length: String,
    refused: Option<String>,
}

/// What is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Asked {
    Nothing,
    Burn,
    Write,
}

impl Default for Entry {
    fn default() -> Self {
        let marking = Marking::of(0);
        Self {
            side: marking.side,
            power: marking.power_w.to_string(),
            length: marking.length_mm.to_string(),
            refused: None,
        }
    }
}

/// Where a camera was found to look by the last job.
pub(super) fn found(station: &Station) -> Option<&FoundSpot> {
    let outcome = station.commissioned()?.as_ref().ok()?;
    outcome.spot.as_ref()
}

impl Entry {
    /// The marks that are asked for, if they make sense.
    pub fn marking(&self) -> Option<Marking> {
        let number = |text: &str| text.trim().replace(',', ".").parse::<f64>().ok();
        Some(Marking {
            power_w: number(&self.power).filter(|power| power.is_finite() && *power > 0.0)?,
            length_mm: number(&self.length).filter(|length| Marking::LENGTHS_MM.contains(length))?,
            ..Marking::of(self.side)
        })
    }

    /// Why it could not be done; `None` where it could.
    pub fn refused(&mut self, why: Option<String>) {
        self.refused = why;
    }

    /// Whether anything is asked for.
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &Station) -> Asked {
        let words = view.words;
        ui.label(RichText::new(words.say(Text::CameraToSpot)).size(22.0).strong());
        say(ui, words.say(Text::SpotHint), view.theme.faint);
        let mut asked = Asked::Nothing;
        let (makes_sense, program) = (self.marking().is_some(), station.loaded().is_some());
        ui.horizontal_top(|ui| {
            Grid::new("spot")
                .num_columns(2)
                .spacing([12.0, 6.0])
                .show(ui, |ui| {
                    ui.label("");
                    ui.horizontal(|ui| {
                        for side in 0..SIDES {
                            let name = words.with(Text::Camera, &[&(side + 1).to_string()]);
                            let choice =
                                Button::selectable(self.side == side, RichText::new(name).size(18.0));
                            if ui.add(choice.min_size([120.0, 44.0].into())).clicked() {
                                self.side = side;
                            }
                        }
                    });
                    ui.end_row();
                    for (name, typed) in [
                        (Text::MarkPower, &mut self.power),
                        (Text::MarkLength, &mut self.length),
                    ] {
                        let label = ui.label(words.say(name));
                        ui.add(TextEdit::singleline(typed).desired_width(100.0))
                            .labelled_by(label.id);
                        ui.end_row();
                    }
                });
            ui.vertical(|ui| {
                let may = station.may(Action::Commission, view.now) && makes_sense && program;
                // Its text is in its middle.
                ui.horizontal(|ui| {
                    if button(ui, view, Text::Burn, 200.0, may) {
                        asked = Asked::Burn;
                    }
                });
                ui.horizontal(|ui| {
                    let may = station.may(Action::Write, view.now) && found(station).is_some();
                    if button(ui, view, Text::CalibrationWrite, 200.0, may) {
                        asked = Asked::Write;
                    }
                });
                if !makes_sense {
                    let lengths =
                        [Marking::LENGTHS_MM.start(), Marking::LENGTHS_MM.end()].map(f64::to_string);
                    let text = words.with(Text::NotAMark, &[&lengths[0], &lengths[1]]);
                    say(ui, text, view.theme.doubt);
                }
                if !program {
                    say(ui, words.say(Text::NoProgramThere), view.theme.doubt);
                }
                if let Some(refused) = &self.refused {
                    say(ui, refused, view.theme.bad);
                }
            });
        });
        ui.add_space(8.0);
        match found(station) {
            Some(found) => figures(ui, view, found),
            None => say(ui, words.say(Text::NoSpotYet), view.theme.faint),
        }
        asked
    }
}

/// What was found.
fn figures(ui: &mut Ui, view: &View, found: &FoundSpot) {
    let words = view.words;
    let camera = (found.side + 1).to_string();
    ui.label(RichText::new(words.with(Text::Camera, &[&camera])).strong());
    Grid::new("found")
        .num_columns(3)
        .min_row_height(28.0)
        .spacing([16.0, 2.0])
        .show(ui, |ui| {
            for figure in &found.result.found.figures {
                ui.label(figure.text);
                ui.label(RichText::new(&figure.found).monospace());
                ui.label(RichText::new(&figure.beside).color(view.theme.faint));
                ui.end_row();
            }
        });
    let [u, v] = found.result.moved_mm.map(|mm| format!("{:+.1}", UM * mm));
    say(ui, words.with(Text::SpotMoved, &[&u, &v]), view.theme.doubt);
    if !found.is_named {
        let text = words.with(Text::CalibrationUnnamed, &[&writing::name(&found.file)]);
        ui.add(Label::new(RichText::new(text).size(14.0)).wrap());
    }
}
