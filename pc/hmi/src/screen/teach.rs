//! The page for teaching: the tip is jogged to the places of a part, and they are taken down.

use super::{View, access, bare, jog, title};
use crate::station::{Action, Station};
use crate::teaching::Teaching;
use crate::texts::Text;
use config::sentence;
use eframe::egui::{self, Button, Id, Label, Modal, RichText, ScrollArea, Ui};
use std::path::Path;

/// Width of part and places \[points\].
const LEFT: f32 = 428.0;
/// Size of a large button \[points\].
const LARGE: [f32; 2] = [196.0, 56.0];

/// What the page remembers between two frames.
#[derive(Default)]
pub(super) struct TeachPage {
    teaching: Option<Teaching>,
    /// What was done last: a text and what is put in, or an error.
    said: Option<Result<(Text, String), String>>,
    over: Over,
}

/// What is open over the page.
#[derive(Clone, Copy, Default, PartialEq)]
enum Over {
    #[default]
    Nothing,
    /// The list of parts.
    Parts,
    /// The question before all places are taken out.
    Restart,
}

impl TeachPage {
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station, panel: &mut jog::Panel) {
        bare(egui::Panel::left("places"))
            .exact_size(LEFT)
            .resizable(false)
            .show(ui, |ui| self.places(ui, view, station));
        egui::Frame::new().inner_margin(8).show(ui, |ui| {
            panel.show(ui, view, station);
            if station.by_hand().is_none() {
                ui.add(Label::new(view.words.say(Text::HomeFirst)).wrap());
            }
            if let Some(told) = &station.live.told {
                ui.add(Label::new(RichText::new(told).color(view.theme.doubt)).wrap());
            }
        });
        match self.over {
            Over::Nothing => {}
            Over::Parts => self.choose(ui, view, station),
            Over::Restart => self.restart(ui, view, station),
        }
    }

    fn places(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        // What opens covers Stop: not where anything moves.
        let rests = !station.is_running() || station.may(Action::ByHand, view.now);
        if button(ui, view, Text::ChoosePart, rests) {
            self.over = Over::Parts;
        }
        let Some(teaching) = &mut self.teaching else {
            ui.add(Label::new(RichText::new(words.say(Text::NoPart)).color(view.theme.faint)).wrap());
            self.say(ui, view);
            return;
        };
        let name = name_of(teaching.part());
        ui.label(RichText::new(name).size(18.0).strong());
        if !station.allows(Action::Teach) {
            let text = RichText::new(access::needs(view, Action::Teach)).color(view.theme.doubt);
            ui.add(Label::new(text).wrap());
        }
        let allowed = station.allows(Action::Teach);
        let ready = station.may(Action::ByHand, view.now);
        let none = teaching.points().is_empty() || !allowed;
        let mut done = None;
        ui.horizontal(|ui| {
            if button(ui, view, Text::Take, ready)
                && let (Some(machine), Some(motion)) = (station.by_hand(), &station.live.motion)
            {
                done = Some(
                    match station.teach(|| teaching.take(machine, &motion.reference)) {
                        Ok(true) => Ok((Text::Taken, teaching.points().len().to_string())),
                        Ok(false) => Ok((Text::TakenAlready, String::new())),
                        Err(error) => Err(error),
                    },
                );
            }
            if button(ui, view, Text::Undo, !none) {
                done = Some(
                    station
                        .teach(|| teaching.undo())
                        .map(|()| (Text::Undone, String::new())),
                );
            }
        });
        ui.horizontal(|ui| {
            if button(ui, view, Text::PlanProgram, station.by_hand().is_some() && !none)
                && let Some(machine) = station.by_hand()
            {
                done = Some(station.teach(|| teaching.plan(machine)).map(|program| {
                    let name = name_of(&program);
                    station.load(program, None);
                    (Text::Planned, name)
                }));
            }
            if button(ui, view, Text::Restart, rests && !none) {
                self.over = Over::Restart;
            }
        });
        if let Some(done) = done {
            self.said = Some(told(done));
        }
        self.say(ui, view);
        let Some(teaching) = &self.teaching else { return };
        title(
            ui,
            view,
            &words.with(Text::PlacesIn, &[&name_of(teaching.places_file())]),
        );
        ScrollArea::vertical().stick_to_bottom(true).show(ui, |ui| {
            for (number, point) in (1..).zip(teaching.points()) {
                let [x, y, z] = point.position_mm;
                let [a, b, c] = point.angles_deg;
                // No angle is -0.
                let [a, b, c] = [a, b, c].map(|angle| (angle * 1e2).round() / 1e2 + 0.0);
                let text = format!("{number:2} {x:8.2} {y:8.2} {z:8.2} {a:7.2} {b:7.2} {c:7.2}");
                ui.label(RichText::new(text).monospace().size(12.0));
            }
        });
    }

    fn say(&self, ui: &mut Ui, view: &View) {
        let (text, colour) = match &self.said {
            None => return,
            Some(Ok((text, put_in))) => (view.words.with(*text, &[put_in]), view.theme.good),
            Some(Err(error)) => (error.clone(), view.theme.bad),
        };
        ui.add(Label::new(RichText::new(text).color(colour)).wrap());
    }

    fn choose(&mut self, ui: &mut Ui, view: &View, station: &Station) {
        let modal = Modal::new(Id::unique("parts")).show(ui.ctx(), |ui| {
            ui.set_width(560.0);
            let folder = station.programs.display().to_string();
            ui.heading(view.words.with(Text::ChoosePartIn, &[&folder]));
            let parts = Teaching::parts_in(&station.programs);
            if parts.is_empty() {
                ui.label(view.words.say(Text::NoParts));
            }
            ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
                for part in parts {
                    let name = name_of(&part);
                    let choice = Button::new(RichText::new(name).size(18.0)).min_size([540.0, 48.0].into());
                    if ui.add(choice).clicked() {
                        match Teaching::open(&part) {
                            Ok(teaching) => (self.teaching, self.said) = (Some(teaching), None),
                            Err(error) => self.said = Some(Err(sentence(error.as_ref()))),
                        }
                        self.over = Over::Nothing;
                    }
                }
            });
            if button(ui, view, Text::Cancel, true) {
                self.over = Over::Nothing;
            }
        });
        if modal.should_close() {
            self.over = Over::Nothing;
        }
    }

    fn restart(&mut self, ui: &mut Ui, view: &View, station: &Station) {
        let words = view.words;
        if !station.allows(Action::Teach) {
            self.over = Over::Nothing;
            return;
        }
        let modal = Modal::new(Id::unique("restart")).show(ui.ctx(), |ui| {
            ui.set_width(480.0);
            ui.heading(words.say(Text::RestartTitle));
            ui.add(Label::new(words.say(Text::RestartKeeps)).wrap());
            ui.horizontal(|ui| {
                if button(ui, view, Text::RestartNow, true) {
                    let teaching = self.teaching.as_mut();
                    let done = teaching.map(|teaching| station.teach(|| teaching.restart()));
                    self.said = done.map(|done| told(done.map(|()| (Text::Undone, String::new()))));
                    self.over = Over::Nothing;
                }
                if button(ui, view, Text::Cancel, true) {
                    self.over = Over::Nothing;
                }
            });
        });
        if modal.should_close() {
            self.over = Over::Nothing;
        }
    }
}

/// What people call a file.
fn name_of(file: &Path) -> String {
    file.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn button(ui: &mut Ui, view: &View, text: Text, enabled: bool) -> bool {
    let label = RichText::new(view.words.say(text)).size(18.0);
    ui.add_enabled(enabled, Button::new(label).min_size(LARGE.into()))
        .clicked()
}

/// An error in words.
fn told(done: anyhow::Result<(Text, String)>) -> Result<(Text, String), String> {
    done.map_err(|error| sentence(error.as_ref()))
}
