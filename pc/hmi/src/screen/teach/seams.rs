//! Seams that the cameras are taught.

use super::{Over, TeachPage, button, told};
use crate::running::{Machine, Outcome};
use crate::screen::{View, writing};
use crate::station::{Action, Station};
use crate::teaching::Teaching;
use crate::texts::Text;
use config::sentence;
use eframe::egui::{Id, Label, Modal, RichText, Ui};
use host_link::events::Phase;

impl TeachPage {
    /// Counts the points of a lesson that has ended.
    pub(super) fn count(&mut self, station: &Station) {
        if let Some(Teaching::Seams(seams)) = &mut self.teaching
            && self.counted != station.lessons()
        {
            self.counted = station.lessons();
            let counted = seams.count().err();
            self.said = counted.map(|error| Err(sentence(error.as_ref())));
        }
    }

    /// Seams are taught, taken out and planned.
    pub(super) fn seams(&mut self, ui: &mut Ui, view: &View, station: &mut Station, rests: bool) {
        let Some(Teaching::Seams(seams)) = &self.teaching else {
            return;
        };
        let words = view.words;
        let allowed = station.allows(Action::Teach);
        let some = seams.points() > 0 && allowed && !station.is_running();
        let mut done = None;
        ui.horizontal(|ui| {
            if button(ui, view, Text::TeachSeams, station.may(Action::Lesson, view.now)) {
                self.over = Over::Lesson;
            }
            let ends = station.is_teaching() && allowed;
            if button(ui, view, Text::EndLesson, ends) {
                station.end_lesson(view.now);
            }
        });
        ui.horizontal(|ui| {
            if button(ui, view, Text::PlanProgram, some) {
                let planned = station.teach(|| seams.plan(&Machine::read(station.machine_file())?));
                done = Some(planned.map(|program| {
                    let name = writing::name(&program);
                    station.load(program, None);
                    (Text::Planned, name)
                }));
            }
            if button(ui, view, Text::Restart, rests && some) {
                self.over = Over::Restart;
            }
        });
        let count = match station.live.phase {
            Some(Phase::TeachingSeam { number }) if station.is_teaching() => number - 1,
            _ => seams.points(),
        };
        let file = writing::name(seams.points_file());
        let points = words.with(Text::PointsIn, &[&count.to_string(), &file]);
        ui.add(Label::new(points).wrap());
        if station.by_hand().is_some() {
            let text = RichText::new(words.say(Text::DrivesOffFirst)).color(view.theme.doubt);
            ui.add(Label::new(text).wrap());
        }
        if let Some(done) = done {
            self.said = Some(told(done));
        }
        ended(ui, view, station);
        self.say(ui, view);
    }

    /// The question before a lesson.
    pub(super) fn ask(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        let Some(Teaching::Seams(seams)) = &self.teaching else {
            self.over = Over::Nothing;
            return;
        };
        let modal = Modal::new(Id::unique("lesson")).show(ui.ctx(), |ui| {
            ui.set_width(560.0);
            ui.heading(words.with(Text::TeachSeamsTitle, &[&writing::name(seams.part())]));
            ui.label(station.place.boards.name());
            let warning = RichText::new(words.say(Text::TeachSeamsWarning)).color(view.theme.doubt);
            ui.add(Label::new(warning.size(15.0)).wrap());
            if seams.points() > 0 {
                ui.label(words.with(Text::GoesOnAfter, &[&seams.points().to_string()]));
            }
            ui.horizontal(|ui| {
                if button(ui, view, Text::TeachSeamsNow, true) {
                    let begun = station.teach_seams(seams, view.now).err();
                    self.said = begun.map(|error| Err(sentence(error.as_ref())));
                    self.over = Over::Nothing;
                }
                if button(ui, view, Text::Cancel, true) {
                    self.over = Over::Nothing;
                }
            });
        });
        // What runs meanwhile must not be covered.
        if modal.should_close() || !station.may(Action::Lesson, view.now) {
            self.over = Over::Nothing;
        }
    }
}

/// How the last lesson ended.
fn ended(ui: &mut Ui, view: &View, station: &Station) {
    let say = |ui: &mut Ui, text: &str, colour| {
        ui.add(Label::new(RichText::new(text).color(colour)).wrap());
    };
    match station.taught() {
        None => {}
        Some(Err(error)) => say(ui, error, view.theme.bad),
        Some(Ok(Outcome {
            error: Some(error), ..
        })) => say(ui, error, view.theme.bad),
        Some(Ok(outcome)) => {
            let told = outcome.taught.and_then(|taught| taught.told().ok());
            for sentence in told.unwrap_or_default() {
                say(ui, &sentence, view.theme.good);
            }
        }
    }
}
