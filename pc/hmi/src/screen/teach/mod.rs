//! The page for teaching: the tip is jogged to the places of a part, and they are taken down; or the cameras are taught its seams.

mod places;
mod seams;

use super::{View, access, bare, jog, writing};
use crate::station::{Action, Station};
use crate::teaching::Teaching;
use crate::texts::Text;
use config::sentence;
use eframe::egui::{self, Button, Id, Label, Modal, RichText, ScrollArea, Ui};
use view::screen::run::Textures;

/// Width of part and points \[points\].
const LEFT: f32 = 428.0;
/// Size of a large button \[points\].
const LARGE: [f32; 2] = [196.0, 56.0];

/// What the page remembers between two frames.
#[derive(Default)]
pub(super) struct TeachPage {
    teaching: Option<Teaching>,
    /// Of the lesson.
    cameras: Textures,
    /// Lessons whose points are counted.
    counted: u32,
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
    /// The question before all that was taught is taken out.
    Restart,
    /// The question before a lesson.
    Lesson,
}

impl TeachPage {
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station, panel: &mut jog::Panel) {
        self.count(station);
        bare(egui::Panel::left("taught"))
            .exact_size(LEFT)
            .resizable(false)
            .show(ui, |ui| self.part(ui, view, station));
        egui::Frame::new()
            .inner_margin(8)
            .show(ui, |ui| match &self.teaching {
                Some(Teaching::Seams(_)) => self.cameras.show(ui, view, &station.live, |_, _| {}),
                _ => places::led(ui, view, station, panel),
            });
        match self.over {
            Over::Nothing => {}
            Over::Parts => self.choose(ui, view, station),
            Over::Restart => self.restart(ui, view, station),
            Over::Lesson => self.ask(ui, view, station),
        }
    }

    /// The part, and what was taught of it.
    fn part(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        // What opens covers Stop: not where anything moves.
        let rests = !station.is_running() || station.may(Action::ByHand, view.now);
        if button(ui, view, Text::ChoosePart, rests) {
            self.over = Over::Parts;
        }
        let part = match &self.teaching {
            None => {
                let text = RichText::new(view.words.say(Text::NoPart)).color(view.theme.faint);
                ui.add(Label::new(text).wrap());
                self.say(ui, view);
                return;
            }
            Some(Teaching::Places(places)) => places.part(),
            Some(Teaching::Seams(seams)) => seams.part(),
        };
        ui.label(RichText::new(writing::name(part)).size(18.0).strong());
        if !station.allows(Action::Teach) {
            let text = RichText::new(access::needs(view, Action::Teach)).color(view.theme.doubt);
            ui.add(Label::new(text).wrap());
        }
        match self.teaching {
            Some(Teaching::Places(_)) => self.places(ui, view, station, rests),
            _ => self.seams(ui, view, station, rests),
        }
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
                    let name = writing::name(&part);
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
                    let done = teaching.map(|teaching| {
                        station.teach(|| match teaching {
                            Teaching::Places(places) => places.restart(),
                            Teaching::Seams(seams) => seams.restart(),
                        })
                    });
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

fn button(ui: &mut Ui, view: &View, text: Text, enabled: bool) -> bool {
    let label = RichText::new(view.words.say(text)).size(18.0);
    ui.add_enabled(enabled, Button::new(label).min_size(LARGE.into()))
        .clicked()
}

/// An error in words.
fn told(done: anyhow::Result<(Text, String)>) -> Result<(Text, String), String> {
    done.map_err(|error| sentence(error.as_ref()))
}
