//! The page for commissioning: motors are measured, what is found of them is looked at and written, a circle is made, and the spot
//! of a camera is found.

mod ask;
mod circle;
mod curves;
mod motor;
mod motors;
mod spot;
mod words;

use super::{View, bare, scroll};
use crate::commissioning::Commissioning;
use crate::parameters::Parameters;
use crate::station::Station;
use crate::texts::Text;
use config::sentence;
use eframe::egui::{self, Button, Label, RichText, Ui};
use shared::io::MOTORS;
use spot::Asked;
use std::thread::JoinHandle;

/// Width of the list \[points\].
const LIST: f32 = 352.0;

/// What the page remembers between two frames.
#[derive(Default)]
pub(super) struct CommissionPage {
    /// What was measured is being evaluated.
    opening: Option<JoinHandle<anyhow::Result<Commissioning>>>,
    opened: Option<Result<Commissioning, String>>,
    /// Jobs that had ended when it was opened.
    after: u32,
    /// Motors that are to be measured.
    ticked: [bool; MOTORS],
    shown: Shown,
    circle: circle::Entry,
    spot: spot::Entry,
    over: Over,
    failed: Option<String>,
}

/// What is beside the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Shown {
    #[default]
    Nothing,
    /// The motor with this index.
    Motor(usize),
    Circle,
    Spot,
}

/// What is open over the page.
#[derive(Default)]
enum Over {
    #[default]
    Nothing,
    /// The question before motors are measured.
    Measure,
    /// The question before what was found is written.
    Write(Box<Proposal>),
    /// The question before a circle.
    Circle,
    /// The question before marks are burnt.
    Spot,
    /// The question before a calibration is written.
    Calibration,
}

/// What could be written.
struct Proposal {
    /// Of which motors something was found that the machine file has not.
    offered: [bool; MOTORS],
    /// Of which it is to be written,
    chosen: [bool; MOTORS],
    /// and the machine file with that, as changes.
    parameters: Parameters,
}

impl CommissionPage {
    /// Evaluates anew what was measured.
    pub fn open(&mut self, station: &Station) {
        let file = station.machine_file().to_owned();
        (self.after, self.failed) = (station.commissioned_jobs(), None);
        self.opening = Some(std::thread::spawn(move || Commissioning::open(&file)));
    }

    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        self.turn(station);
        bare(egui::Panel::left("motors"))
            .exact_size(LIST)
            .resizable(false)
            .show(ui, |ui| scroll().show(ui, |ui| self.motors(ui, view, station)));
        egui::Frame::new().inner_margin(8).show(ui, |ui| {
            let bottom = ui.max_rect().bottom();
            // Everything larger is higher than a page.
            scroll()
                .id_salt("beside")
                .show(ui, |ui| self.beside(ui, view, station, bottom));
        });
        match self.over {
            Over::Nothing => {}
            Over::Measure => self.ask_to_measure(ui, view, station),
            Over::Write(_) => self.ask_to_write(ui, view, station),
            Over::Circle => self.ask_to_go_round(ui, view, station),
            Over::Spot => self.ask_to_burn(ui, view, station),
            Over::Calibration => self.ask_to_calibrate(ui, view, station),
        }
    }

    /// What is beside the list, on a page that ends at `bottom`.
    fn beside(&mut self, ui: &mut Ui, view: &View, station: &Station, bottom: f32) {
        match self.shown {
            Shown::Nothing => say(ui, view.words.say(Text::ChooseMotor), view.theme.faint),
            Shown::Motor(index) => match self.opened().and_then(|opened| opened.motor(index)) {
                Some(motor) => motor::show(ui, view, motor, bottom),
                None => say(ui, view.words.say(Text::Evaluating), view.theme.faint),
            },
            Shown::Circle => {
                if self.circle.show(ui, view, station, bottom) {
                    self.over = Over::Circle;
                }
            }
            Shown::Spot => match self.spot.show(ui, view, station) {
                Asked::Nothing => {}
                Asked::Burn => self.over = Over::Spot,
                Asked::Write => self.over = Over::Calibration,
            },
        }
    }

    /// What was measured, once that is evaluated.
    fn opened(&self) -> Option<&Commissioning> {
        self.opened.as_ref()?.as_ref().ok()
    }

    fn turn(&mut self, station: &Station) {
        if !station.is_running() && self.after != station.commissioned_jobs() {
            self.open(station);
        }
        let Some(opening) = self.opening.take_if(|opening| opening.is_finished()) else {
            return;
        };
        let opened = opening
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        let opened = opened.map_err(|error| sentence(error.as_ref()));
        if let Ok(opened) = &opened {
            // What is missing is what comes next.
            self.ticked = [false; MOTORS];
            for motor in &opened.motors {
                self.ticked[motor.index] = motor.measured().is_none();
            }
        }
        self.opened = Some(opened);
    }
}

/// What is left of a page that ends at `bottom`, and at least so much \[points\].
fn left_over(ui: &Ui, bottom: f32, least: f32) -> f32 {
    (bottom - ui.cursor().top()).max(least)
}

/// A large button.
fn button(ui: &mut Ui, view: &View, text: Text, width: f32, enabled: bool) -> bool {
    let label = RichText::new(view.words.say(text)).size(18.0);
    ui.add_enabled(enabled, Button::new(label).min_size([width, 52.0].into()))
        .clicked()
}

/// A sentence in a colour.
fn say(ui: &mut Ui, text: impl Into<String>, colour: egui::Color32) {
    ui.add(Label::new(RichText::new(text).size(15.0).color(colour)).wrap());
}
