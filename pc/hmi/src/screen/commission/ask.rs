//! What opens over the page: the questions before something moves, and before what was found is written.

use super::circle::named;
use super::words::unit;
use super::{CommissionPage, Over, say, spot};
use crate::screen::{View, writing};
use crate::station::{Action, Station};
use crate::texts::Text;
use commission::excitations;
use config::kept;
use config::machine::MachineFile;
use config::sentence;
use eframe::egui::{Button, Color32, Id, Label, Modal, RichText, ScrollArea, Ui};
use shared::io::{MOTOR_NAMES, MOTORS};
use shared::protocol::{CAPTURE_TICKS, Excitation, Excited};
use shared::ticks::SERVO_PERIOD_S;
use std::f64::consts::TAU;

/// Size of a button \[points\].
const BUTTON: [f32; 2] = [200.0, 60.0];
/// Width of what opens \[points\].
const WIDTH: f32 = 680.0;
/// Height of a list in it \[points\].
const LIST: f32 = 260.0;

/// What was answered.
#[derive(Clone, Copy, PartialEq)]
enum Answer {
    None,
    Yes,
    No,
}

impl CommissionPage {
    /// The question before motors are measured: what will move how far.
    pub(super) fn ask_to_measure(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        let machine = MachineFile::read(station.machine_file());
        let motors: Vec<_> = (0..MOTORS).filter(|index| self.ticked[*index]).collect();
        let names = self.ticked_names().join(", ");
        let title = words.with(Text::MeasureTitle, &[&names]);
        let answer = ask(
            ui,
            view,
            "measure",
            &title,
            Text::MeasureNow,
            view.theme.good,
            |ui| {
                ui.label(station.place.boards.name());
                say(ui, words.say(Text::MeasureWarning), view.theme.doubt);
                let Ok(machine) = &machine else { return };
                let told: Vec<_> = motors
                    .iter()
                    .map(|index| (*index, excitations(&machine.motion, *index)))
                    .collect();
                ScrollArea::vertical().max_height(LIST).show(ui, |ui| {
                    for (index, excitations) in &told {
                        let text = moves(view, *index, excitations);
                        ui.add(Label::new(RichText::new(text).size(15.0)).wrap());
                    }
                });
                let seconds: f64 = told.iter().flat_map(|(_, all)| all).map(lasts_s).sum();
                let minutes = (seconds / 60.0).ceil().to_string();
                ui.add(Label::new(words.with(Text::MeasureLasts, &[&minutes])).wrap());
            },
        );
        // What runs meanwhile must not be covered.
        let may = station.may(Action::Commission, view.now);
        if answer == Answer::Yes {
            self.failed = station
                .measure(&motors, view.now)
                .err()
                .map(|error| sentence(error.as_ref()));
        }
        if answer != Answer::None || !may {
            self.over = Over::Nothing;
        }
    }

    /// The question before a circle.
    pub(super) fn ask_to_go_round(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        let Some(test) = self.circle.test() else {
            self.over = Over::Nothing;
            return;
        };
        let title = words.with(Text::GoRoundTitle, &[&named(view, test)]);
        let colour = view.theme.good;
        let answer = ask(ui, view, "circle", &title, Text::GoRoundNow, colour, |ui| {
            ui.label(station.place.boards.name());
            say(ui, words.say(Text::GoRoundWarning), view.theme.doubt);
        });
        let may = station.may(Action::Commission, view.now);
        if answer == Answer::Yes
            && let Err(error) = station.circle(test, view.now)
        {
            self.circle.refuse(sentence(error.as_ref()));
        }
        if answer != Answer::None || !may {
            self.over = Over::Nothing;
        }
    }

    /// The question before marks are burnt: what burns, and where.
    pub(super) fn ask_to_burn(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        let (Some(marking), Some(loaded)) = (self.spot.marking(), station.loaded().cloned()) else {
            self.over = Over::Nothing;
            return;
        };
        let camera = (marking.side + 1).to_string();
        let title = words.with(Text::BurnTitle, &[&camera]);
        let colour = view.theme.bad;
        let answer = ask(ui, view, "burn", &title, Text::BurnNow, colour, |ui| {
            ui.label(station.place.boards.name());
            let [power, length, plate] =
                [marking.power_w, marking.length_mm, marking.plate_mm()].map(|value| value.to_string());
            let program = writing::name(&loaded.program_file);
            let warning = words.with(Text::BurnWarning, &[&power, &length, &program, &plate]);
            say(ui, warning, view.theme.doubt);
        });
        let may = station.may(Action::Commission, view.now);
        if answer == Answer::Yes {
            let begun = station.find_spot(marking, view.now);
            self.spot
                .refused(begun.err().map(|error| sentence(error.as_ref())));
        }
        if answer != Answer::None || !may {
            self.over = Over::Nothing;
        }
    }

    /// The question before a calibration is written.
    pub(super) fn ask_to_calibrate(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let found = spot::found(station).cloned();
        let (Some(found), true) = (found, station.may(Action::Write, view.now)) else {
            self.over = Over::Nothing;
            return;
        };
        let version = found.file.exists().then(|| kept::next_version(&found.file));
        let answer = writing::ask(ui, view, &found.file, version.as_deref(), |ui| {
            let camera = (found.side + 1).to_string();
            ui.label(view.words.with(Text::WriteCalibration, &[&camera]));
        });
        let written = match answer {
            writing::Answer::Nothing => return,
            writing::Answer::Cancel => Ok(()),
            writing::Answer::Write => station.write_calibration(&found, view.now),
        };
        self.spot
            .refused(written.err().map(|error| sentence(error.as_ref())));
        self.over = Over::Nothing;
    }

    /// The question before what was found is written: of which motors, and what that changes.
    pub(super) fn ask_to_write(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        let Over::Write(proposal) = &mut self.over else {
            return;
        };
        let parameters = &proposal.parameters;
        let mut chosen = proposal.chosen;
        let title = words.with(Text::WriteTitle, &[&writing::name(parameters.file())]);
        let colour = view.theme.doubt;
        let answer = ask(ui, view, "write found", &title, Text::WriteNow, colour, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label(words.say(Text::OfMotors));
                for (index, name) in MOTOR_NAMES.iter().enumerate() {
                    let button = Button::selectable(chosen[index], *name).min_size([64.0, 44.0].into());
                    if proposal.offered[index] && ui.add(button).clicked() {
                        chosen[index] = !chosen[index];
                    }
                }
            });
            ScrollArea::vertical().max_height(LIST).show(ui, |ui| {
                for change in parameters.changes() {
                    ui.add(Label::new(RichText::new(words.change(change)).size(15.0)).wrap());
                }
                if !parameters.is_changed() {
                    say(ui, words.say(Text::NoChanges), view.theme.faint);
                }
                for weakened in parameters.weakened() {
                    say(ui, words.with(Text::Weakened, &[weakened]), view.theme.doubt);
                }
                if let Some(error) = parameters.refused() {
                    say(
                        ui,
                        words.with(Text::Refused, &[&error.to_string()]),
                        view.theme.bad,
                    );
                }
            });
            writing::then(ui, view, parameters.next_version().as_deref());
        });
        let (offered, is_other) = (proposal.offered, chosen != proposal.chosen);
        if answer == Answer::Yes {
            self.write(view, station);
        }
        if answer != Answer::None || !station.may(Action::Write, view.now) {
            self.over = Over::Nothing;
        } else if is_other {
            self.propose(offered, chosen);
        }
    }

    fn write(&mut self, view: &View, station: &mut Station) {
        let (Some(Ok(opened)), Over::Write(proposal)) = (&self.opened, &mut self.over) else {
            return;
        };
        let motors: Vec<_> = (0..MOTORS).filter(|index| proposal.chosen[*index]).collect();
        let written = station.write_found(opened, &motors, &mut proposal.parameters, view.now);
        let failed = written.err().map(|error| sentence(error.as_ref()));
        self.open(station);
        self.failed = failed;
    }
}

/// A question with what is said below it.
fn ask(
    ui: &Ui,
    view: &View,
    id: &str,
    title: &str,
    yes: Text,
    colour: Color32,
    below: impl FnOnce(&mut Ui),
) -> Answer {
    let words = view.words;
    let mut answer = Answer::None;
    let modal = Modal::new(Id::unique(id)).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.add(Label::new(RichText::new(title).heading()).wrap());
        ui.add_space(8.0);
        below(ui);
        ui.add_space(12.0);
        ui.horizontal(|ui| {
            let text = RichText::new(words.say(yes)).size(20.0).color(Color32::BLACK);
            let button = Button::new(text).fill(colour).min_size(BUTTON.into());
            if ui.add(button).clicked() {
                answer = Answer::Yes;
            }
            let cancel = Button::new(words.say(Text::Cancel)).min_size(BUTTON.into());
            if ui.add(cancel).clicked() {
                answer = Answer::No;
            }
        });
    });
    match answer {
        Answer::None if modal.should_close() => Answer::No,
        answer => answer,
    }
}

/// What a motor is going to do.
fn moves(view: &View, index: usize, excitations: &[Excitation]) -> String {
    let unit = unit(index);
    let commanded = || excitations.iter().filter(|told| told.excited == Excited::Command);
    let way = commanded().map(|told| told.way).fold(0.0, f64::max);
    // The slowest part of a chirp of the speed goes farthest.
    let shaken = commanded()
        .map(|told| told.amplitude / (TAU * told.from_hz))
        .fold(0.0, f64::max);
    let turning = excitations
        .iter()
        .filter(|told| told.excited == Excited::Reference);
    let turning = turning.map(|told| told.amplitude).fold(0.0, f64::max);
    let [way, shaken, turning] = [way, shaken, turning].map(|length| format!("{length:.2} {unit}"));
    let times = commanded().filter(|told| told.way > 0.0).count().to_string();
    view.words.with(
        Text::MeasureMoves,
        &[MOTOR_NAMES[index], &times, &way, &shaken, &turning],
    )
}

/// How long an excitation takes \[s\].
fn lasts_s(told: &Excitation) -> f64 {
    let settle = u32::from(told.settle_periods);
    let periods = if told.way > 0.0 {
        4 * settle + 2
    } else {
        settle + 1
    };
    f64::from(periods) * CAPTURE_TICKS as f64 * SERVO_PERIOD_S
}
