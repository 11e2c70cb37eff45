//! Keys to type with where there is no keyboard: over the page, in the half of it where the field is not.

use super::View;
use crate::texts::Language;
use eframe::egui::SurrenderFocusOn;
use eframe::egui::{
    Align2, Area, Button, Context, Event, Frame, Grid, Id, Key, Modifiers, Order, Rect, RichText,
};
use view::screen::BAR;

/// Rows of keys. NC programs need no other signs.
const KEYS: [[&str; 11]; 5] = [
    ["1", "2", "3", "4", "5", "6", "7", "8", "9", "0", DELETE],
    ["Q", "W", "E", "R", "T", "Y", "U", "I", "O", "P", "/"],
    ["A", "S", "D", "F", "G", "H", "J", "K", "L", "#", "="],
    [CASE, "Z", "X", "C", "V", "B", "N", "M", ",", ".", "-"],
    ["(", ")", "[", "]", "*", "+", SPACE, "_", LEFT, RIGHT, ENTER],
];
const DELETE: &str = "⌫";
const CASE: &str = "⬆";
const SPACE: &str = " ";
const LEFT: &str = "⬅";
const RIGHT: &str = "➡";
const ENTER: &str = "⏎";
/// Height of a key \[points\].
const HEIGHT: f32 = 56.0;
/// Between two keys \[points\].
const GAP: f32 = 6.0;

/// See the module.
#[derive(Default)]
pub(super) struct Keyboard {
    /// Where it is.
    area: Option<Rect>,
    /// Small letters.
    is_small: bool,
    /// What was tapped and has not been given to the field.
    typed: Vec<Event>,
}

impl Keyboard {
    /// To be called before anything is drawn that is typed into.
    pub fn turn(&mut self, context: &Context) {
        context.input_mut(|input| input.events.append(&mut self.typed));
        let pointer = context.input(|input| input.pointer.interact_pos());
        let is_over = self.area.zip(pointer).is_some_and(|(area, at)| area.contains(at));
        context.options_mut(|options| {
            // A tap on a key leaves the field as it is.
            options.input_options.surrender_focus_on = if is_over {
                SurrenderFocusOn::Never
            } else {
                SurrenderFocusOn::default()
            };
        });
    }

    /// Shows it while something is typed into. To be called after all that may be.
    pub fn show(&mut self, context: &Context, view: &View) {
        let field = context.memory(|memory| memory.focused());
        let field = field.filter(|_| context.text_edit_focused());
        let Some(field) = field.and_then(|field| context.read_response(field)) else {
            self.area = None;
            return;
        };
        let page = context
            .content_rect()
            .with_min_y(context.content_rect().top() + BAR);
        let (anchor, down) = if field.rect.center().y < page.center().y {
            (Align2::CENTER_BOTTOM, 0.0)
        } else {
            (Align2::CENTER_TOP, BAR)
        };
        let count = KEYS[0].len() as f32;
        let frame = Frame::popup(&context.global_style()).inner_margin(GAP);
        let width = (page.width() - (count + 1.0) * GAP) / count - 1.0;
        let shown = Area::new(Id::unique("keyboard"))
            .order(Order::Tooltip)
            .anchor(anchor, [0.0, down])
            .show(context, |ui| {
                frame.show(ui, |ui| {
                    Grid::new("keys").spacing([GAP, GAP]).show(ui, |ui| {
                        for row in KEYS {
                            for key in row {
                                let letter = self.letter(key, view);
                                let button = Button::new(RichText::new(&letter).size(22.0));
                                if ui.add(button.min_size([width, HEIGHT].into())).clicked() {
                                    self.tap(key, letter);
                                }
                            }
                            ui.end_row();
                        }
                    });
                });
            });
        self.area = Some(shown.response.rect);
    }

    /// What is on a key.
    fn letter(&self, key: &str, view: &View) -> String {
        let key = match key {
            "Y" if view.words.0 == Language::German => "Z",
            "Z" if view.words.0 == Language::German => "Y",
            _ => key,
        };
        if self.is_small {
            key.to_lowercase()
        } else {
            key.to_owned()
        }
    }

    fn tap(&mut self, key: &str, letter: String) {
        let pressed = |key| {
            [true, false].map(|pressed| Event::Key {
                key,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            })
        };
        match key {
            CASE => self.is_small = !self.is_small,
            DELETE => self.typed.extend(pressed(Key::Backspace)),
            LEFT => self.typed.extend(pressed(Key::ArrowLeft)),
            RIGHT => self.typed.extend(pressed(Key::ArrowRight)),
            ENTER => self.typed.extend(pressed(Key::Enter)),
            _ => self.typed.push(Event::Text(letter)),
        }
    }
}
