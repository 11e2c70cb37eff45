//! The program with its current line; a line is chosen to start from by a tap, where nothing runs.

use super::title;
use crate::screen::View;
use crate::station::{Action, Station};
use crate::texts::Text;
use eframe::egui::{Button, RichText, ScrollArea, TextWrapMode, Ui};

/// Height of a line \[points\].
const LINE: f32 = 20.0;
/// Lines kept in sight above the current one.
const ABOVE: f32 = 4.0;

pub(super) fn show(ui: &mut Ui, view: &View, station: &mut Station) {
    let Some(loaded) = station.loaded().cloned() else {
        super::nothing(ui, view, Text::NoProgram);
        return;
    };
    title(ui, view, &loaded.name());
    let may_choose = station.may(Action::Start, view.now);
    let current = station
        .live
        .motion
        .as_ref()
        .map(|motion| motion.line)
        .filter(|_| station.runs_program());
    ui.spacing_mut().item_spacing.y = 0.0;
    ui.spacing_mut().interact_size.y = LINE;
    ui.spacing_mut().button_padding = [4.0, 0.0].into();
    let mut area = ScrollArea::vertical().auto_shrink(false);
    if let Some(line) = current.filter(|line| *line > 0) {
        area = area.vertical_scroll_offset(((line as f32 - 1.0 - ABOVE) * LINE).max(0.0));
    }
    area.show_rows(ui, LINE, loaded.lines.len(), |ui, rows| {
        for row in rows {
            let number = row as u32 + 1;
            let chosen = current == Some(number) || (current.is_none() && loaded.from_line == Some(number));
            let text = format!("{number:>4} {}", loaded.lines[row]);
            let text = RichText::new(text).monospace();
            let line = Button::selectable(chosen, text).wrap_mode(TextWrapMode::Truncate);
            let line = line.min_size([ui.available_width(), LINE].into());
            if ui.add(line).clicked() && may_choose {
                let again = loaded.from_line == Some(number);
                station.load(loaded.program_file.clone(), (!again).then_some(number));
            }
        }
    });
}
