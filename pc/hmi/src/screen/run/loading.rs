//! What opens over the page: the list of programs, and the question before a start.

use super::Over;
use crate::screen::View;
use crate::station::{Action, Station};
use crate::texts::Text;
use eframe::egui::{Button, Color32, Id, Label, Modal, RichText, ScrollArea, Ui};
use std::path::{Path, PathBuf};

/// Endings of programs.
const PROGRAMS: [&str; 4] = ["ngc", "nc", "tap", "mpf"];
/// Size of a button \[points\].
const BUTTON: [f32; 2] = [200.0, 60.0];

/// The list of programs.
pub(super) fn programs(ui: &mut Ui, view: &View, station: &mut Station, over: &mut Over) {
    let words = view.words;
    let modal = Modal::new(Id::unique("programs")).show(ui.ctx(), |ui| {
        ui.set_width(560.0);
        let folder = station.programs.display().to_string();
        ui.heading(words.with(Text::ChooseProgram, &[&folder]));
        let files = programs_in(&station.programs);
        if files.is_empty() {
            ui.label(words.say(Text::NoPrograms));
        }
        ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
            for file in files {
                let name = file
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned();
                let button = Button::new(RichText::new(name).size(18.0)).min_size([540.0, 48.0].into());
                if ui.add(button).clicked() && station.may(Action::Load, view.now) {
                    station.load(file, None);
                    *over = Over::Nothing;
                }
            }
        });
        if ui
            .add(Button::new(words.say(Text::Cancel)).min_size(BUTTON.into()))
            .clicked()
        {
            *over = Over::Nothing;
        }
    });
    if modal.should_close() {
        *over = Over::Nothing;
    }
}

fn programs_in(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let is_program = |file: &PathBuf| {
        let ending = file
            .extension()
            .map(|ending| ending.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| PROGRAMS.contains(&ending.as_str()))
    };
    let mut files: Vec<PathBuf> = files.filter(is_program).collect();
    files.sort();
    files
}

/// The question before a start: what will run, where the machine goes first, and whether the cell is empty.
pub(super) fn start(ui: &mut Ui, view: &View, station: &mut Station, over: &mut Over) {
    let words = view.words;
    let Some(loaded) = station
        .loaded()
        .cloned()
        .filter(|_| station.may(Action::Start, view.now))
    else {
        *over = Over::Nothing;
        return;
    };
    let from = match loaded.drawn.from_line {
        Some(line) => words.with(Text::FromLine, &[&line.to_string()]),
        None => words.say(Text::FromBeginning).to_owned(),
    };
    let modal = Modal::new(Id::unique("start")).show(ui.ctx(), |ui| {
        ui.set_width(600.0);
        ui.heading(words.say(Text::StartTitle));
        ui.add_space(8.0);
        ui.label(
            RichText::new(format!("{}, {from}", loaded.drawn.name))
                .size(19.0)
                .strong(),
        );
        ui.label(format!(
            "{} · {}",
            loaded.machine.name,
            station.place.boards.name()
        ));
        if let Some(place) = loaded.drawn.begins_at() {
            let [x, y, z] = place.pose.position.into();
            let there = format!("X {x:.1}  Y {y:.1}  Z {z:.1} mm");
            ui.label(words.with(Text::FirstMove, &[&there]));
        }
        for notice in loaded.notices.iter().take(4) {
            ui.add(Label::new(RichText::new(notice).small().color(view.theme.faint)).wrap());
        }
        ui.add_space(8.0);
        ui.add(Label::new(RichText::new(words.say(Text::StartWarning)).color(view.theme.doubt)).wrap());
        ui.add_space(12.0);
        ui.horizontal(|ui| {
            let text = RichText::new(words.say(Text::StartNow))
                .size(20.0)
                .color(Color32::BLACK);
            if ui
                .add(Button::new(text).fill(view.theme.good).min_size(BUTTON.into()))
                .clicked()
            {
                station.start(view.now);
                *over = Over::Nothing;
            }
            if ui
                .add(Button::new(words.say(Text::Cancel)).min_size(BUTTON.into()))
                .clicked()
            {
                *over = Over::Nothing;
            }
        });
    });
    if modal.should_close() {
        *over = Over::Nothing;
    }
}
