//! The page of past jobs: the reports of a folder, one beside another.

use super::{View, bare};
use crate::records::{Judged, Record, folders};
use crate::texts::Text;
use config::sentence;
use eframe::egui::{self, Button, Color32, Grid, Label, RichText, ScrollArea, TextWrapMode, Ui};
use egui_plot::Plot;
use shared::io::{SLIDE_NAMES, SLIDES};
use std::path::{Path, PathBuf};
use view::screen::curves::Curves;
use view::screen::run::curve;

/// Width of the list \[points\].
const LIST: f32 = 280.0;
/// Colour of the job that is compared with.
const OTHER: Color32 = Color32::from_gray(130);
/// Height of a row that is tapped \[points\].
const ROW: f32 = 40.0;

/// What the page has read. The folder is read again when the page is opened, and when a job has ended.
#[derive(Default)]
pub(super) struct WeldsPage {
    folders: Vec<PathBuf>,
    shown: Option<(PathBuf, Result<Record, String>)>,
    compared: Option<(PathBuf, Result<Record, String>)>,
    drawn: Curves,
}

impl WeldsPage {
    /// Looks for reports anew.
    pub fn open(&mut self, reports: &Path) {
        self.folders = folders(reports);
        if self.shown.is_none() {
            self.shown = self.folders.first().map(|newest| read(newest));
        }
    }

    pub fn show(&mut self, ui: &mut Ui, view: &View, reports: &Path) {
        let words = view.words;
        if self.folders.is_empty() {
            let text = words.with(Text::NoWelds, &[&reports.display().to_string()]);
            ui.label(RichText::new(text).color(view.theme.faint));
            return;
        }
        bare(egui::Panel::left("reports"))
            .exact_size(LIST)
            .resizable(false)
            .show(ui, |ui| {
                ui.heading(words.say(Text::Welds));
                list(ui, "shown", &self.folders, &mut self.shown, 0.6);
                ui.label(words.say(Text::Compare));
                list(ui, "compared", &self.folders, &mut self.compared, 1.0);
            });
        let Some((_, shown)) = &self.shown else { return };
        let record = match shown {
            Ok(record) => record,
            Err(error) => {
                ui.add(Label::new(RichText::new(error).color(view.theme.bad)).wrap());
                return;
            }
        };
        let other = self.compared.as_ref().and_then(|(_, read)| read.as_ref().ok());
        heading(ui, view, record);
        deviations(ui, view, record, other, &mut self.drawn);
        figures(ui, view, record, other);
    }
}

fn read(folder: &Path) -> (PathBuf, Result<Record, String>) {
    (
        folder.to_owned(),
        Record::read(folder).map_err(|error| sentence(error.as_ref())),
    )
}

/// Folders to choose from; a second tap takes the choice back. Takes `part` of the height that is left.
fn list(
    ui: &mut Ui,
    id: &str,
    folders: &[PathBuf],
    chosen: &mut Option<(PathBuf, Result<Record, String>)>,
    part: f32,
) {
    let height = ui.available_height() * part - 8.0;
    ScrollArea::vertical()
        .id_salt(id)
        .max_height(height)
        .auto_shrink(false)
        .show(ui, |ui| {
            for folder in folders {
                let name = folder
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned();
                let is_chosen = chosen.as_ref().is_some_and(|(path, _)| path == folder);
                let button = Button::selectable(is_chosen, name).wrap_mode(TextWrapMode::Truncate);
                if ui.add(button.min_size([LIST - 24.0, ROW].into())).clicked() {
                    *chosen = (!is_chosen).then(|| read(folder));
                }
            }
        });
}

fn heading(ui: &mut Ui, view: &View, record: &Record) {
    let words = view.words;
    let (text, colour) = match (record.is_good, record.is_finished) {
        (true, _) => (Text::Finished, view.theme.good),
        (false, true) => (Text::FinishedOutside, view.theme.bad),
        (false, false) => (Text::EndedEarly, view.theme.bad),
    };
    ui.label(RichText::new(words.say(text)).size(20.0).strong().color(colour));
    let [program, machine, boards] = &record.of;
    let duration = words.with(Text::Seconds, &[&format!("{:.1}", record.duration_s)]);
    let of = format!(
        "{program} · {machine} · {boards} · {} {duration}",
        words.say(Text::Duration)
    );
    ui.add(Label::new(RichText::new(of).color(view.theme.faint)).wrap());
    for fault in &record.faults {
        ui.add(Label::new(RichText::new(fault).color(view.theme.bad)).wrap());
    }
}

/// True deviations along the seam; those of the other job grey and beneath.
fn deviations(ui: &mut Ui, view: &View, record: &Record, other: Option<&Record>, drawn: &mut Curves) {
    if record.deviations.bins().next().is_none() {
        return;
    }
    super::title(ui, view, view.words.say(Text::TrueDeviation));
    ui.horizontal(|ui| {
        for (name, colour) in SLIDE_NAMES.into_iter().zip(view.theme.slides) {
            ui.colored_label(colour, name);
        }
        if let Some(other) = other {
            ui.colored_label(OTHER, &other.name);
        }
    });
    let others = other.map(|other| (0..SLIDES).map(|slide| curve(&other.deviations, slide, OTHER)));
    let own = (0..SLIDES).map(|slide| curve(&record.deviations, slide, view.theme.slides[slide]));
    let curves = others.into_iter().flatten().chain(own).collect();
    let plot = Plot::new("true deviations").height(180.0).allow_scroll(false);
    plot.show(ui, |plot| drawn.show(plot, curves));
}

fn figures(ui: &mut Ui, view: &View, record: &Record, other: Option<&Record>) {
    let words = view.words;
    ScrollArea::vertical()
        .id_salt("figures")
        .auto_shrink(false)
        .show(ui, |ui| {
            Grid::new("figures")
                .num_columns(5)
                .striped(true)
                .spacing([18.0, 6.0])
                .show(ui, |ui| {
                    for text in [Text::Figure, Text::Value, Text::MayBe] {
                        ui.label(RichText::new(words.say(text)).color(view.theme.faint));
                    }
                    ui.label(
                        RichText::new(other.map_or("", |other| other.name.as_str())).color(view.theme.faint),
                    );
                    ui.end_row();
                    for figure in &record.figures {
                        let outside = figure.is_outside();
                        let colour = if outside {
                            view.theme.bad
                        } else {
                            ui.visuals().text_color()
                        };
                        ui.label(RichText::new(&figure.text).color(colour));
                        ui.label(RichText::new(number(figure.value, &figure.unit)).color(colour));
                        ui.label(may_be(figure));
                        let same =
                            other.and_then(|other| other.figures.iter().find(|of| of.text == figure.text));
                        ui.label(same.map_or(String::new(), |same| number(same.value, &same.unit)));
                        ui.label(
                            RichText::new(if outside { words.say(Text::Outside) } else { "" })
                                .strong()
                                .color(colour),
                        );
                        ui.end_row();
                    }
                });
        });
}

fn may_be(figure: &Judged) -> String {
    match figure.may_be {
        [None, None] => String::new(),
        [None, Some(most)] => format!("≤ {most}"),
        [Some(least), None] => format!("≥ {least}"),
        [Some(least), Some(most)] => format!("{least} … {most}"),
    }
}

fn number(value: f64, unit: &str) -> String {
    format!("{value:.4} {unit}")
}
