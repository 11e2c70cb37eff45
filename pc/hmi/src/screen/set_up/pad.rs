//! A value for what is chosen, typed with gloves on.

use crate::screen::View;
use crate::texts::Text;
use eframe::egui::{Button, Grid, RichText, TextEdit, TextStyle, Ui};

/// Size of a key \[points\].
const KEY: [f32; 2] = [76.0, 52.0];
/// Size of what does something with the value \[points\].
const SETS: [f32; 2] = [WIDTH, 52.0];
/// Width of all of it \[points\].
pub(super) const WIDTH: f32 = 3.0 * KEY[0] + 2.0 * 8.0;

/// A field for what is `typed`, and keys for it; `hint` is in the field while nothing is.
pub(super) fn show(ui: &mut Ui, view: &View, typed: &mut String, hint: &str) {
    let label = ui.label(view.words.say(Text::Value));
    let field = TextEdit::singleline(typed)
        .font(TextStyle::Monospace)
        .hint_text(hint)
        .desired_width(WIDTH - 8.0);
    ui.add(field).labelled_by(label.id);
    Grid::new("digits").spacing([8.0, 8.0]).show(ui, |ui| {
        for row in [["1", "2", "3"], ["4", "5", "6"], ["7", "8", "9"], ["-", "0", "."]] {
            for key in row {
                let button = Button::new(RichText::new(key).size(24.0)).min_size(KEY.into());
                if ui.add(button).clicked() {
                    typed.push_str(key);
                }
            }
            ui.end_row();
        }
    });
    if sets(ui, view, Text::DeleteDigit, !typed.is_empty()) {
        typed.pop();
    }
}

/// A button for what is done with the value.
pub(super) fn sets(ui: &mut Ui, view: &View, text: Text, may: bool) -> bool {
    ui.add_enabled(may, button(view.words.say(text).to_owned()))
        .clicked()
}

/// A button that does something with the value.
pub(super) fn button(text: String) -> Button<'static> {
    Button::new(RichText::new(text).size(18.0)).min_size(SETS.into())
}
