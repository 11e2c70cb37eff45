//! The list of the motors, with what can be done.

use super::{CommissionPage, Over, Proposal, Shown, button, say};
use crate::commissioning::{Known, Motor, Standing};
use crate::screen::{View, access, title};
use crate::station::{Action, Station};
use crate::texts::Text;
use config::sentence;
use eframe::egui::{Align, Button, Checkbox, Color32, Layout, ProgressBar, RichText, TextWrapMode, Ui};
use host_link::events::Phase;
use shared::io::{MOTOR_NAMES, MOTORS};

/// Height of a row \[points\].
const ROW: f32 = 44.0;
/// Width of a tick with a name.
const TICK: f32 = 76.0;
/// Width of the rest of a row.
const STATE: f32 = 244.0;
/// Width of one of two buttons beside each other.
const HALF: f32 = 160.0;

impl CommissionPage {
    pub(super) fn motors(&mut self, ui: &mut Ui, view: &View, station: &Station) {
        ui.add_space(4.0);
        access::needed(ui, view, station, Action::Commission);
        title(ui, view, view.words.say(Text::Motors));
        let (ticked, shown) = (&mut self.ticked, &mut self.shown);
        if let Some(Ok(opened)) = &self.opened {
            for motor in &opened.motors {
                ui.horizontal(|ui| row(ui, view, motor, ticked, shown));
            }
        }
        for (shown, text) in [
            (Shown::Circle, Text::CircularTest),
            (Shown::Spot, Text::CameraToSpot),
        ] {
            let entry = Button::selectable(self.shown == shown, RichText::new(view.words.say(text)));
            if ui.add(entry.min_size([TICK + STATE + 8.0, ROW].into())).clicked() {
                self.shown = shown;
            }
        }
        ui.add_space(4.0);
        let is_free = station.may(Action::Commission, view.now);
        let unwritten = self.unwritten();
        let (mut measure, mut write) = (false, false);
        ui.horizontal(|ui| {
            let any = self.opened().is_some() && self.ticked.contains(&true);
            measure = button(ui, view, Text::Measure, HALF, is_free && any);
            let may = station.may(Action::Write, view.now) && unwritten.contains(&true);
            write = button(ui, view, Text::Write, HALF, may);
        });
        if measure {
            (self.over, self.failed) = (Over::Measure, None);
        }
        if write {
            self.propose(unwritten, unwritten);
        }
        self.told(ui, view, station, is_free);
    }

    /// Motors of which something was found that the machine file has not.
    fn unwritten(&self) -> [bool; MOTORS] {
        let motor = |index| self.opened().and_then(|opened| opened.motor(index));
        std::array::from_fn(|index| motor(index).is_some_and(|motor| motor.unwritten().is_some()))
    }

    /// Has what was found of the `chosen` motors as changes, to be looked at.
    pub(super) fn propose(&mut self, offered: [bool; MOTORS], chosen: [bool; MOTORS]) {
        let Some(opened) = self.opened() else { return };
        let motors: Vec<_> = (0..MOTORS).filter(|index| chosen[*index]).collect();
        (self.over, self.failed) = match opened.proposal(&motors) {
            Ok(parameters) => {
                let proposal = Proposal {
                    offered,
                    chosen,
                    parameters,
                };
                (Over::Write(Box::new(proposal)), None)
            }
            Err(error) => (Over::Nothing, Some(sentence(error.as_ref()))),
        };
    }

    /// How it goes on, or why not.
    fn told(&self, ui: &mut Ui, view: &View, station: &Station, is_free: bool) {
        let words = view.words;
        if let Some(Err(error)) = &self.opened {
            say(ui, error, view.theme.bad);
        }
        if self.opening.is_some() {
            say(ui, words.say(Text::Evaluating), view.theme.faint);
        }
        if let Some(failed) = &self.failed {
            say(ui, failed, view.theme.bad);
        }
        if station.is_commissioning() {
            if let Some(phase) = station.live.phase {
                say(ui, words.phase(phase), view.theme.doubt);
                if let Phase::Exciting { number, of, .. } = phase {
                    ui.add(ProgressBar::new(number as f32 / of as f32).desired_width(STATE + TICK));
                }
            }
        } else if !is_free && station.allows(Action::Commission) {
            say(ui, words.say(Text::CommissionAtRest), view.theme.doubt);
        }
        let error = match station.commissioned() {
            Some(Ok(outcome)) => outcome.error.as_ref(),
            Some(Err(error)) => Some(error),
            None => None,
        };
        if let Some(error) = error {
            say(ui, words.with(Text::EndedWith, &[error]), view.theme.bad);
        }
    }

    /// Names of the motors that are ticked.
    pub(super) fn ticked_names(&self) -> Vec<&'static str> {
        let named = MOTOR_NAMES.into_iter().zip(self.ticked);
        named
            .filter_map(|(name, is_ticked)| is_ticked.then_some(name))
            .collect()
    }
}

fn row(ui: &mut Ui, view: &View, motor: &Motor, ticked: &mut [bool; MOTORS], shown: &mut Shown) {
    ui.spacing_mut().icon_width = 28.0;
    let name = RichText::new(motor.name()).size(18.0).strong();
    let beside = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout([TICK, ROW].into(), beside, |ui| {
        ui.set_min_size([TICK, ROW].into());
        ui.add(Checkbox::new(&mut ticked[motor.index], name));
    });
    let (text, colour) = state(view, motor);
    let text = RichText::new(format!("{}: {}", motor.name(), view.words.say(text))).size(15.0);
    let choice = Shown::Motor(motor.index);
    // On the ground of what is chosen not every colour can be read.
    let is_shown = *shown == choice;
    let text = if is_shown { text } else { text.color(colour) };
    let button = Button::selectable(is_shown, text).wrap_mode(TextWrapMode::Wrap);
    if ui.add(button.min_size([STATE, ROW].into())).clicked() {
        *shown = choice;
    }
}

fn state(view: &View, motor: &Motor) -> (Text, Color32) {
    let theme = view.theme;
    let measured = match &motor.known {
        Known::Nothing => return (Text::MotorNotMeasured, theme.faint),
        Known::Unreadable(_) => return (Text::MotorUnreadable, theme.bad),
        Known::Measured(measured) => measured,
    };
    match (&measured.found, measured.standing) {
        (Err(_), _) => (Text::MotorRefused, theme.bad),
        (Ok(_), Standing::Current) => (Text::MotorMeasured, theme.good),
        (Ok(_), Standing::Changed) => (Text::MotorOlder, theme.doubt),
        (Ok(_), Standing::Written) => (Text::MotorWritten, theme.good),
    }
}
