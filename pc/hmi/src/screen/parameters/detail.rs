//! One parameter: what the file and its reader say of it, and a field to change it.

use super::ParametersPage;
use crate::screen::{View, writing};
use crate::texts::Text;
use config::parameters::{Kind, Range};
use eframe::egui::{Button, Grid, Key, Label, RichText, ScrollArea, TextEdit, Ui, vec2};

impl ParametersPage {
    pub(super) fn detail(&mut self, ui: &mut Ui, view: &View) {
        let words = view.words;
        let parameters = self.opened.as_ref();
        let found = parameters
            .zip(self.chosen.as_mut())
            .and_then(|(parameters, chosen)| {
                let parameter = parameters.parameter(&chosen.key)?;
                Some((parameters, chosen, parameter))
            });
        let Some((parameters, chosen, parameter)) = found else {
            let text = RichText::new(words.say(Text::ChooseParameter)).color(view.theme.faint);
            ui.add(Label::new(text).wrap());
            return;
        };
        let mut asked = Asked::Nothing;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.add(Label::new(RichText::new(&parameter.key).size(19.0).strong()).wrap());
            if !parameter.comment.is_empty() {
                ui.add(Label::new(&parameter.comment).wrap());
            }
            ui.horizontal(|ui| {
                let label = ui.label(words.say(Text::Value));
                let field = TextEdit::singleline(&mut chosen.typed)
                    .desired_width(match parameter.kind {
                        Kind::Float | Kind::Integer => 150.0,
                        Kind::Text | Kind::Other => 230.0,
                    })
                    .margin(vec2(8.0, 8.0));
                let field = ui.add(field).labelled_by(label.id);
                ui.label(parameter.unit);
                let escaped = ui.input(|input| input.key_pressed(Key::Escape));
                if field.lost_focus() {
                    asked = if escaped { Asked::Forget } else { Asked::Set };
                }
                if ui.button(words.say(Text::SetValue)).clicked() {
                    asked = Asked::Set;
                }
            });
            if let Some(error) = chosen.error {
                let text = words.say(writing::no_value(error));
                ui.add(Label::new(RichText::new(text).color(view.theme.bad)).wrap());
            } else if parameters.is_refused_at(parameter)
                && let Some(error) = parameters.refused()
            {
                let text = words.with(Text::Refused, &[&error.to_string()]);
                ui.add(Label::new(RichText::new(text).color(view.theme.bad)).wrap());
            }
            let change = parameters.change(&parameter.key);
            let in_file = change.map_or(Some(&parameter.value), |change| change.old.as_ref());
            let none = words.say(Text::LeftOut).to_owned();
            let range = match &*chosen.ranges {
                [] => words.say(Text::RangeUnsaid).to_owned(),
                ranges => ranges.iter().map(Range::to_string).collect::<Vec<_>>().join("; "),
            };
            Grid::new("of the parameter")
                .num_columns(2)
                .spacing([16.0, 4.0])
                .min_row_height(22.0)
                .show(ui, |ui| {
                    for (name, value) in [
                        (Text::ParameterRange, range),
                        (Text::InFile, in_file.cloned().unwrap_or_else(|| none.clone())),
                        (Text::Line, parameter.line.to_string()),
                        (
                            Text::Shipped,
                            parameters.shipped(&parameter.key).map_or(none, str::to_owned),
                        ),
                    ] {
                        ui.label(RichText::new(words.say(name)).color(view.theme.faint));
                        ui.add(Label::new(value).wrap());
                        ui.end_row();
                    }
                });
            if change.is_some_and(|change| change.old.is_some()) {
                let text = format!("● {}", words.say(Text::TakeBack));
                if ui.add(Button::new(text).min_size([160.0, 44.0].into())).clicked() {
                    asked = Asked::TakeBack;
                }
            }
        });
        self.act(asked);
    }

    fn act(&mut self, asked: Asked) {
        let (Some(parameters), Some(chosen)) = (self.opened.as_mut(), self.chosen.as_mut()) else {
            return;
        };
        match asked {
            Asked::Nothing => return,
            Asked::Forget => {}
            Asked::TakeBack => parameters.take_back(&chosen.key),
            Asked::Set => {
                chosen.error = parameters.set(&chosen.key, &chosen.typed).err();
                if chosen.error.is_some() {
                    return;
                }
            }
        }
        self.choose_again();
    }
}

/// What an operator wants of the parameter.
enum Asked {
    Nothing,
    /// What is typed.
    Set,
    /// What it was before it was typed in.
    Forget,
    /// What it was when the file was loaded.
    TakeBack,
}
