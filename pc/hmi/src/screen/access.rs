//! The pad for PINs, and where access is asked for.

use super::View;
use crate::access::{Level, Refusal};
use crate::station::{Action, Station};
use crate::texts::{Text, Words};
use eframe::egui::{self, Button, Event, Grid, Key, Label, RichText, Ui};

/// Size of a key \[points\].
const KEY: [f32; 2] = [116.0, 84.0];
/// Digits that are taken, though fewer make a PIN.
const MOST: usize = 8;

/// A PIN that is being typed. It is in the place of a page, so that Stop stays in sight.
pub(super) struct Pad {
    purpose: Purpose,
    typed: String,
    /// A new one, typed once.
    once: Option<String>,
    refused: Option<Text>,
}

/// What a PIN is typed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To be let in.
    Enter,
    /// To be that of a level.
    Set(Level),
}

/// What was tapped or typed.
enum Tapped {
    Digit(char),
    Delete,
    Enter,
    Cancel,
}

impl Pad {
    pub fn new(purpose: Purpose) -> Self {
        Self {
            purpose,
            typed: String::new(),
            once: None,
            refused: None,
        }
    }

    /// Whether it is done with.
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station) -> bool {
        let words = view.words;
        let wait = station.access().wait(view.now);
        let wait = wait.filter(|_| self.purpose == Purpose::Enter);
        let mut tapped = typed(ui);
        ui.vertical_centered(|ui| {
            ui.add_space(16.0);
            ui.heading(match (self.purpose, &self.once) {
                (Purpose::Enter, _) => words.say(Text::EnterPin).to_owned(),
                (Purpose::Set(level), None) => words.with(Text::NewPin, &[words.level(level)]),
                (Purpose::Set(_), Some(_)) => words.say(Text::PinAgain).to_owned(),
            });
            let (told, colour) = if let Some(wait) = wait {
                let seconds = wait.as_secs() + 1;
                (
                    words.with(Text::WaitForPin, &[&seconds.to_string()]),
                    view.theme.bad,
                )
            } else {
                let hint = Some(Text::NewPinHint).filter(|_| self.purpose != Purpose::Enter);
                let colour = if self.refused.is_some() {
                    view.theme.bad
                } else {
                    view.theme.faint
                };
                let told = self.refused.or(hint).map_or("", |text| words.say(text));
                (told.to_owned(), colour)
            };
            ui.label(RichText::new(told).color(colour));
            // As many as are typed, not which.
            let dots = "●".repeat(self.typed.len());
            ui.add(Label::new(RichText::new(format!("{dots} ")).size(34.0)));
            let width = 3.0 * KEY[0] + 2.0 * 12.0;
            let size = egui::vec2(width, 0.0);
            ui.allocate_ui_with_layout(size, egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.add_enabled_ui(wait.is_none(), |ui| tapped.extend(keys(ui, words)));
                ui.add_space(4.0);
                let cancel = RichText::new(words.say(Text::Cancel)).size(20.0);
                let cancel = Button::new(cancel).min_size([width, 60.0].into());
                let placed = ui.vertical_centered_justified(|ui| ui.add(cancel).clicked());
                if placed.inner {
                    tapped.push(Tapped::Cancel);
                }
            });
        });
        tapped.into_iter().any(|tapped| self.take(&tapped, view, station))
    }

    /// Whether it is done with.
    fn take(&mut self, tapped: &Tapped, view: &View, station: &mut Station) -> bool {
        match tapped {
            Tapped::Cancel => return true,
            Tapped::Digit(digit) if self.typed.len() < MOST => {
                self.typed.push(*digit);
                self.refused = None;
            }
            Tapped::Digit(_) => {}
            Tapped::Delete => {
                self.typed.pop();
            }
            Tapped::Enter if self.typed.is_empty() => {}
            Tapped::Enter => {
                let typed = std::mem::take(&mut self.typed);
                return self.enter(typed, view, station);
            }
        }
        false
    }

    fn enter(&mut self, typed: String, view: &View, station: &mut Station) -> bool {
        let level = match self.purpose {
            Purpose::Enter => {
                self.refused = station.enter(&typed, view.now).err().map(said);
                return self.refused.is_none();
            }
            Purpose::Set(level) => level,
        };
        match self.once.take() {
            None => self.once = Some(typed),
            Some(once) if once != typed => self.refused = Some(Text::PinsDiffer),
            Some(_) => {
                let set = station.set_pin(level, Some(&typed), view.now);
                self.refused = set.err().map(said);
                return self.refused.is_none();
            }
        }
        false
    }
}

/// The keys of the pad.
fn keys(ui: &mut Ui, words: Words) -> Option<Tapped> {
    let mut tapped = None;
    Grid::new("pad").spacing([12.0, 12.0]).show(ui, |ui| {
        let mut key = |ui: &mut Ui, text: &str, size: f32, means: Tapped| {
            let button = Button::new(RichText::new(text).size(size)).min_size(KEY.into());
            if ui.add(button).clicked() {
                tapped = Some(means);
            }
        };
        for row in ["123", "456", "789"] {
            for digit in row.chars() {
                key(ui, &digit.to_string(), 30.0, Tapped::Digit(digit));
            }
            ui.end_row();
        }
        key(ui, words.say(Text::DeleteDigit), 20.0, Tapped::Delete);
        key(ui, "0", 30.0, Tapped::Digit('0'));
        key(ui, words.say(Text::EnterDigits), 20.0, Tapped::Enter);
    });
    tapped
}

/// The same, typed. Enter and Space are those of a key of the pad that has the focus.
fn typed(ui: &Ui) -> Vec<Tapped> {
    let focused = ui.ctx().memory(|memory| memory.focused().is_some());
    let mut tapped = Vec::new();
    ui.input(|input| {
        for event in &input.events {
            match event {
                Event::Text(text) => {
                    let digits = text.chars().filter(char::is_ascii_digit);
                    tapped.extend(digits.map(Tapped::Digit));
                }
                Event::Key {
                    key, pressed: true, ..
                } => match key {
                    Key::Backspace => tapped.push(Tapped::Delete),
                    Key::Enter if !focused => tapped.push(Tapped::Enter),
                    Key::Escape => tapped.push(Tapped::Cancel),
                    _ => {}
                },
                _ => {}
            }
        }
    });
    tapped
}

pub(super) fn said(refusal: Refusal) -> Text {
    match refusal {
        // How long is said in its place.
        Refusal::WrongPin | Refusal::Wait(_) => Text::WrongPin,
        Refusal::NotAPin => Text::NotAPin,
        Refusal::Taken => Text::PinTaken,
        Refusal::EngineerFirst => Text::EngineerFirst,
        // It has fallen back meanwhile.
        Refusal::Needs(_) => Text::ScreenLocked,
        Refusal::NoRandomness => Text::NoRandomness,
    }
}

/// Where `action` needs another level: says which, and lets ask for it.
pub(super) fn needed(ui: &mut Ui, view: &View, station: &Station, action: Action) {
    if station.allows(action) {
        return;
    }
    ui.horizontal(|ui| {
        ask(ui, view, [124.0, 44.0]);
        let text = needs(view, action);
        ui.add(Label::new(RichText::new(text).color(view.theme.doubt)).wrap());
    });
}

/// Which level `action` needs.
pub(super) fn needs(view: &View, action: Action) -> String {
    let level = view.words.level(action.level());
    view.words.with(Text::NeedsLevel, &[level])
}

/// A button that asks for a PIN.
pub(super) fn ask(ui: &mut Ui, view: &View, size: [f32; 2]) {
    let button = Button::new(view.words.say(Text::AccessAsked)).min_size(size.into());
    if ui.add(button).clicked() {
        view.asks.set(Some(Purpose::Enter));
    }
}
