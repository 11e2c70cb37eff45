//! Tools and weld data: sets, the values of one of them, and a pad to change one.

use super::pad;
use crate::screen::View;
use crate::screen::writing::{self, Answer, BUTTON};
use crate::sets::{EditedSets, Value};
use crate::station::Station;
use crate::station::sets::action;
use crate::texts::Text;
use config::parameters::EditError;
use config::sentence;
use config::sets::Sets;
use eframe::egui::{Button, Color32, Grid, Id, Label, Modal, RichText, ScrollArea, Ui, vec2};

/// Width of the dialog \[points\].
const WIDTH: f32 = 900.0;
/// Size of a set \[points\].
const SET: [f32; 2] = [90.0, 44.0];
/// Size of a value \[points\].
const ROW: [f32; 2] = [220.0, 44.0];
/// Height of the rows of sets, and of that of the values \[points\].
const HEIGHTS: [f32; 2] = [96.0, 400.0];
/// A set as it is written.
const EXAMPLE: &str = "[root]\npower = 3200.0\npre_flow_s = 0.5\nramp_up = { power = 3600.0, over_mm = 6.0 }";

/// What is being set.
pub(super) struct Dialog {
    /// `None` where there is no program that they would be beside.
    sets: Option<EditedSets>,
    kind: Sets,
    /// Name of a set.
    set: String,
    /// Name of a value of it.
    chosen: String,
    typed: String,
    error: Option<EditError>,
    failed: Option<String>,
    /// The question before writing is open.
    asks: bool,
}

/// What was asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    Nothing,
    Save,
    Close,
}

impl Dialog {
    /// What the file says now.
    ///
    /// # Errors
    /// A sentence: it cannot be read.
    pub fn open(kind: Sets, station: &Station) -> Result<Self, String> {
        let sets = station
            .file_of(kind)
            .map(|file| EditedSets::open(kind, &file))
            .transpose();
        let sets = sets.map_err(|error| sentence(error.as_ref()))?;
        let mut dialog = Self {
            sets,
            kind,
            set: String::new(),
            chosen: String::new(),
            typed: String::new(),
            error: None,
            failed: None,
            asks: false,
        };
        dialog.choose_first();
        Ok(dialog)
    }

    /// Whether it stays open.
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station) -> bool {
        if !station.may(action(self.kind), view.now) {
            return false;
        }
        if self.asks {
            return self.ask(ui, view, station);
        }
        let mut asked = Asked::Nothing;
        let modal = Modal::new(Id::unique("sets")).show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            let (title, hint) = match self.kind {
                Sets::Tools => (Text::ToolsTitle, Text::ToolsHint),
                Sets::WeldData => (Text::WeldDataTitle, Text::WeldDataHint),
            };
            ui.heading(view.words.say(title));
            let file = station.file_of(self.kind).unwrap_or_default();
            let hint = view.words.with(hint, &[&writing::name(&file)]);
            ui.add(Label::new(RichText::new(hint).color(view.theme.faint)).wrap());
            ui.add_space(8.0);
            self.sets(ui, view);
            ui.add_space(8.0);
            ui.horizontal_top(|ui| {
                ui.allocate_ui(vec2(WIDTH - pad::WIDTH - 48.0, HEIGHTS[1]), |ui| {
                    ui.vertical(|ui| {
                        self.values(ui, view);
                        ui.add_space(16.0);
                        self.more_or_less(ui, view);
                    });
                });
                ui.add_space(16.0);
                ui.vertical(|ui| self.pad(ui, view));
            });
            ui.add_space(8.0);
            self.told(ui, view);
            ui.horizontal(|ui| asked = self.buttons(ui, view));
        });
        match asked {
            Asked::Save => self.asks = true,
            Asked::Close => return false,
            Asked::Nothing => {}
        }
        !modal.should_close()
    }

    /// The question before writing. Whether the dialog stays open.
    fn ask(&mut self, ui: &Ui, view: &View, station: &mut Station) -> bool {
        let Some(sets) = &mut self.sets else { return false };
        let version = sets.next_version();
        let answer = writing::ask(ui, view, sets.file(), version.as_deref(), |ui| {
            writing::changes(ui, view, sets.changes(), sets.is_changed());
        });
        self.asks = answer == Answer::Nothing;
        if answer != Answer::Write {
            return true;
        }
        let written = station.write_sets(sets, view.now);
        self.failed = written.err().map(|error| match sets.is_stale() {
            true => view.words.say(Text::StaleFile).to_owned(),
            false => sentence(error.as_ref()),
        });
        self.failed.is_some()
    }

    fn choose_first(&mut self) {
        let names = self.sets.iter().flat_map(EditedSets::names);
        let first = names.map(str::to_owned).next().unwrap_or_default();
        self.choose_set(&first);
    }

    fn choose_set(&mut self, name: &str) {
        name.clone_into(&mut self.set);
        let first = self.of_set().into_iter().next();
        self.choose(first.as_ref());
    }

    /// Values of the set that is chosen.
    fn of_set(&self) -> Vec<Value> {
        let is_there = |sets: &&EditedSets| sets.names().any(|name| name == self.set);
        let sets = self.sets.as_ref().filter(is_there);
        sets.map_or_else(Vec::new, |sets| sets.values(&self.set))
    }

    fn choose(&mut self, value: Option<&Value>) {
        (self.typed, self.error) = (String::new(), None);
        self.chosen = value.map_or_else(String::new, |value| value.name.clone());
        // What is no number is changed as it is written.
        if let Some(value) = value.filter(|value| !value.is_number) {
            self.typed.clone_from(&value.value);
        }
    }

    /// The sets to choose from.
    fn sets(&mut self, ui: &mut Ui, view: &View) {
        let Some(sets) = self.sets.as_ref().filter(|sets| sets.names().next().is_some()) else {
            let none = match self.kind {
                Sets::Tools => Text::NoTools,
                Sets::WeldData => Text::NoWeldData,
            };
            ui.add(Label::new(view.words.say(none)).wrap());
            if self.kind == Sets::WeldData {
                ui.label(RichText::new(EXAMPLE).monospace());
            }
            return;
        };
        let mut tapped = None;
        ScrollArea::vertical()
            .id_salt("sets")
            .max_height(HEIGHTS[0])
            .show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    for name in sets.names() {
                        let mark = mark(sets.is_changed_at(name, None));
                        let letter = if self.kind == Sets::Tools { "T" } else { "" };
                        let text = RichText::new(format!("{mark}{letter}{name}")).size(18.0);
                        let button = Button::selectable(self.set == name, text).min_size(SET.into());
                        if ui.add(button).clicked() {
                            tapped = Some(name.to_owned());
                        }
                    }
                });
            });
        if let Some(name) = tapped {
            self.choose_set(&name);
        }
    }

    fn values(&mut self, ui: &mut Ui, view: &View) {
        let Some(sets) = &self.sets else { return };
        let values = self.of_set();
        let missing = sets.missing(&self.set);
        let (mut tapped, mut put_in) = (None, None);
        ScrollArea::vertical()
            .id_salt("values")
            .max_height(HEIGHTS[1])
            .auto_shrink([false, true])
            .show(ui, |ui| {
                Grid::new("values")
                    .num_columns(3)
                    .spacing([12.0, 4.0])
                    .show(ui, |ui| {
                        for value in &values {
                            let name = match &*value.name {
                                "length_mm" => view.words.say(Text::ToolLength),
                                "diameter_mm" => view.words.say(Text::ToolDiameter),
                                name => name,
                            };
                            let label = ui.label(RichText::new(name).size(17.0).strong());
                            let mark = mark(sets.is_changed_at(&self.set, Some(&value.name)));
                            let text = RichText::new(format!("{mark}{}", value.value))
                                .monospace()
                                .size(18.0);
                            let button = Button::selectable(self.chosen == value.name, text)
                                .min_size(ROW.into())
                                .truncate();
                            let button = ui.add_sized(ROW, button).labelled_by(label.id);
                            if button.clicked() {
                                tapped = Some(value.clone());
                            }
                            ui.label(RichText::new(value.unit).size(15.0));
                            ui.end_row();
                        }
                    });
                if missing.is_empty() {
                    return;
                }
                ui.add_space(12.0);
                let hint = RichText::new(view.words.say(Text::NotInSet)).color(view.theme.faint);
                ui.add(Label::new(hint).wrap());
                ui.horizontal_wrapped(|ui| {
                    for key in missing {
                        let text = RichText::new(format!("+ {key}")).size(17.0);
                        if ui.add(Button::new(text).min_size(SET.into())).clicked() {
                            put_in = Some(key);
                        }
                    }
                });
            });
        if tapped.is_some() {
            self.choose(tapped.as_ref());
        }
        if let (Some(key), Some(sets)) = (put_in, &mut self.sets) {
            sets.put_in(&self.set, key);
        }
    }

    fn pad(&mut self, ui: &mut Ui, view: &View) {
        let Some(sets) = &mut self.sets else { return };
        pad::show(ui, view, &mut self.typed, "");
        let typed = self.typed.trim();
        let may = !typed.is_empty() && !self.chosen.is_empty();
        if pad::sets(ui, view, Text::SetToValue, may) {
            // As it is written on paper, unless it is a list.
            let point = match typed.replace(',', ".") {
                number if number.parse::<f64>().is_ok() => number,
                _ => typed.to_owned(),
            };
            self.error = sets.set(&self.set, &self.chosen, &point).err();
            if self.error.is_none() {
                self.typed.clear();
            }
        }
    }

    /// Another set, or one less.
    fn more_or_less(&mut self, ui: &mut Ui, view: &View) {
        let Some(sets) = &mut self.sets else { return };
        let (more, less) = match self.kind {
            Sets::Tools => (Text::NewTool, Text::RemoveTool),
            Sets::WeldData => (Text::NewWeldData, Text::RemoveWeldData),
        };
        let name = self.typed.trim().to_owned();
        let (mut is_added, mut is_removed) = (false, false);
        ui.horizontal(|ui| {
            is_added = pad::sets(ui, view, more, sets.is_new(&name));
            is_removed = pad::sets(ui, view, less, !self.set.is_empty());
        });
        if is_added {
            sets.add(&name, &self.set);
            self.choose_set(&name);
        } else if is_removed {
            sets.remove(&self.set);
            self.choose_first();
        }
    }

    /// What is wrong.
    fn told(&self, ui: &mut Ui, view: &View) {
        let words = view.words;
        let error = self.error.map(|error| words.say(writing::no_value(error)));
        let refused = self.sets.as_ref().and_then(EditedSets::refused);
        let refused = refused.map(|refused| words.with(Text::Refused, &[refused]));
        let told = error
            .map(str::to_owned)
            .into_iter()
            .chain(refused)
            .chain(self.failed.clone());
        for text in told {
            ui.add(Label::new(RichText::new(text).color(view.theme.bad)).wrap());
        }
    }

    fn buttons(&self, ui: &mut Ui, view: &View) -> Asked {
        let text = RichText::new(view.words.say(Text::Write))
            .size(20.0)
            .color(Color32::BLACK);
        let save = Button::new(text).fill(view.theme.good).min_size(BUTTON.into());
        let cancel = Button::new(view.words.say(Text::Cancel)).min_size(BUTTON.into());
        let sets = self.sets.as_ref();
        let may = sets.is_some_and(|sets| sets.is_changed() && sets.refused().is_none());
        let saved = ui.add_enabled(may, save).clicked();
        match (saved, ui.add(cancel).clicked()) {
            (true, _) => Asked::Save,
            (_, true) => Asked::Close,
            _ => Asked::Nothing,
        }
    }
}

fn mark(is_changed: bool) -> &'static str {
    if is_changed { "● " } else { "" }
}
