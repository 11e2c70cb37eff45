//! The page for setting up: drives and homing, positions, jogging, blocks by hand, work offsets, tools and weld data.

mod block;
mod cameras;
mod homing;
mod pad;
mod positions;
mod sets;
mod sightings;
mod work_offsets;

use super::{View, access, bare, jog, title};
use crate::station::{Action, Station};
use crate::texts::Text;
use config::sets::Sets;
use eframe::egui::{self, Button, Color32, Id, Label, Modal, RichText, Ui};
use host_link::{ByHand, Command};

/// Width of drives and positions \[points\].
const LEFT: f32 = 428.0;
/// Height of what a block is typed into \[points\].
const BLOCK: f32 = 210.0;
/// Size of a large button \[points\].
const LARGE: [f32; 2] = [196.0, 60.0];
/// Size of what opens a dialog \[points\].
const DATA: [f32; 2] = [128.0, 44.0];

/// What the page remembers between two frames.
#[derive(Default)]
pub(in crate::screen) struct SetUpPage {
    block: block::Entry,
    /// The question before homing is open.
    asks: bool,
    /// What is being set, or why it cannot be.
    data: Option<Result<Data, String>>,
    cameras: cameras::Cameras,
}

/// What is set in a dialog of its own.
enum Data {
    WorkOffsets(work_offsets::Dialog),
    Sets(sets::Dialog),
}

impl Data {
    fn open(action: Action, station: &Station) -> Result<Self, String> {
        match action {
            Action::Tools => sets::Dialog::open(Sets::Tools, station).map(Self::Sets),
            Action::WeldData => sets::Dialog::open(Sets::WeldData, station).map(Self::Sets),
            _ => work_offsets::Dialog::open(station).map(Self::WorkOffsets),
        }
    }

    /// Whether it stays open.
    fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station) -> bool {
        match self {
            Self::WorkOffsets(dialog) => dialog.show(ui, view, station),
            Self::Sets(dialog) => dialog.show(ui, view, station),
        }
    }
}

impl SetUpPage {
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station, panel: &mut jog::Panel) {
        bare(egui::Panel::left("drives"))
            .exact_size(LEFT)
            .resizable(false)
            .show(ui, |ui| {
                self.drives(ui, view, station);
                ui.add_space(6.0);
                positions::show(ui, view, station);
                self.data(ui, view, station);
                ui.add_space(6.0);
                homing::show(ui, view, station);
                if station
                    .by_hand()
                    .is_some_and(|machine| machine.is.tracking.is_some())
                {
                    ui.add_space(6.0);
                    self.cameras.show(ui, view, &station.live);
                }
            });
        bare(egui::Panel::bottom("block"))
            .exact_size(BLOCK)
            .resizable(false)
            .show(ui, |ui| {
                self.block.show(ui, view, station, panel.is_armed());
            });
        egui::Frame::new()
            .inner_margin(8)
            .show(ui, |ui| panel.show(ui, view, station));
        if self.asks {
            self.ask(ui, view, station);
        }
        if let Some(Ok(data)) = &mut self.data
            && !data.show(ui, view, station)
        {
            self.data = None;
        }
    }

    /// What opens work offsets, tools and weld data.
    fn data(&mut self, ui: &mut Ui, view: &View, station: &Station) {
        ui.horizontal(|ui| {
            for (action, text, is_there) in [
                (Action::WorkOffsets, Text::WorkOffsets, true),
                (Action::Tools, Text::Tools, true),
                (
                    Action::WeldData,
                    Text::WeldData,
                    station.file_of(Sets::WeldData).is_some(),
                ),
            ] {
                let button = Button::new(view.words.say(text)).min_size(DATA.into());
                let may = is_there && station.may(action, view.now);
                if ui.add_enabled(may, button).clicked() {
                    self.data = Some(Data::open(action, station));
                }
            }
        });
        if station.by_hand().is_some() && station.allows(Action::Tools) {
            let text = RichText::new(view.words.say(Text::ToolsWithDrivesOff)).size(14.0);
            ui.add(Label::new(text.color(view.theme.faint)).wrap());
        }
        let refused = station.refused().map(str::to_owned);
        let failed = self.data.as_ref().and_then(|data| data.as_ref().err().cloned());
        for text in failed.into_iter().chain(refused) {
            ui.add(Label::new(RichText::new(text).color(view.theme.bad)).wrap());
        }
    }

    fn drives(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        ui.horizontal(|ui| {
            let label = RichText::new(view.words.say(Text::Home)).size(20.0);
            let home = Button::new(label).min_size(LARGE.into());
            if ui
                .add_enabled(station.may(Action::Home, view.now), home)
                .clicked()
            {
                self.asks = true;
            }
            let label = RichText::new(view.words.say(Text::DrivesOff)).size(20.0);
            let off = Button::new(label).min_size(LARGE.into());
            if ui.add_enabled(station.may(Action::Off, view.now), off).clicked() {
                station.send(Command::ByHand(ByHand::Off), view.now);
            }
        });
        if !station.allows(Action::Home) {
            let text = RichText::new(access::needs(view, Action::Home)).color(view.theme.doubt);
            ui.add(Label::new(text).wrap());
        } else if station.runs_program() {
            ui.add(Label::new(view.words.say(Text::ProgramRuns)).wrap());
        }
    }

    /// The question before homing: nothing moves by one touch.
    fn ask(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        if !station.may(Action::Home, view.now) {
            self.asks = false;
            return;
        }
        let modal = Modal::new(Id::unique("home")).show(ui.ctx(), |ui| {
            ui.set_width(560.0);
            ui.heading(words.say(Text::HomeTitle));
            ui.add_space(8.0);
            ui.label(station.place.boards.name());
            ui.add(Label::new(RichText::new(words.say(Text::HomeWarning)).color(view.theme.doubt)).wrap());
            ui.add_space(12.0);
            ui.horizontal(|ui| {
                let text = RichText::new(words.say(Text::HomeNow))
                    .size(20.0)
                    .color(Color32::BLACK);
                let button = Button::new(text)
                    .fill(view.theme.good)
                    .min_size([200.0, 60.0].into());
                if ui.add(button).clicked() {
                    station.home(view.now);
                    self.asks = false;
                }
                if ui
                    .add(Button::new(words.say(Text::Cancel)).min_size([200.0, 60.0].into()))
                    .clicked()
                {
                    self.asks = false;
                }
            });
        });
        if modal.should_close() {
            self.asks = false;
        }
    }
}
