//! Blocks of NC by hand (MDI), with what was carried out before.

use super::title;
use crate::screen::View;
use crate::station::{Action, Station};
use crate::texts::Text;
use eframe::egui::{Button, Id, Key, Label, RichText, ScrollArea, TextEdit, Ui};
use host_link::{ByHand, Command};

/// Blocks that are remembered.
const REMEMBERED: usize = 50;

/// A block as it is typed, and those before.
#[derive(Default)]
pub(super) struct Entry {
    text: String,
    /// The newest first.
    before: Vec<String>,
}

impl Entry {
    /// `armed` the panel must be, as for a jog.
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station, armed: bool) {
        let words = view.words;
        let label = title(ui, view, words.say(Text::BlockByHand)).id;
        let may = armed && station.may(Action::ByHand, view.now);
        ui.horizontal(|ui| {
            let width = ui.available_width() - 190.0;
            let field = TextEdit::singleline(&mut self.text)
                .id(Id::unique("block of NC"))
                .hint_text("G1 X10 F600")
                .font(eframe::egui::TextStyle::Monospace)
                .desired_width(width);
            let typed = ui.add(field).labelled_by(label);
            let entered = typed.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let button = Button::new(words.say(Text::CarryOut)).min_size([170.0, 44.0].into());
            let tapped = ui
                .add_enabled(may && !self.text.trim().is_empty(), button)
                .clicked();
            if may && (tapped || entered) {
                self.carry_out(view, station);
            }
        });
        if let Some(told) = &station.live.told {
            ui.add(Label::new(RichText::new(told).color(view.theme.doubt)).wrap());
        }
        ScrollArea::vertical().show(ui, |ui| {
            for text in &self.before {
                let again = RichText::new(text).monospace();
                if ui.add(Button::new(again).frame(false)).clicked() {
                    self.text.clone_from(text);
                }
            }
        });
    }

    fn carry_out(&mut self, view: &View, station: &mut Station) {
        let text = std::mem::take(&mut self.text).trim().to_owned();
        if text.is_empty() {
            return;
        }
        station.send(Command::ByHand(ByHand::Block(text.clone())), view.now);
        self.before.retain(|before| *before != text);
        self.before.insert(0, text);
        self.before.truncate(REMEMBERED);
    }
}
