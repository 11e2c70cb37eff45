//! The program with its current line.

use super::title;
use crate::screen::View;
use crate::seen::Seen;
use eframe::egui::{Button, RichText, ScrollArea, TextWrapMode, Ui};

/// Height of a line \[points\].
const LINE: f32 = 20.0;
/// Lines kept in sight above the current one.
const ABOVE: f32 = 4.0;

/// Shows it; a line that is tapped, from 1.
pub(super) fn show(ui: &mut Ui, view: &View, seen: &Seen) -> Option<u32> {
    let Some((drawn, _)) = seen.program else {
        super::nothing(ui, view, view.no_program);
        return None;
    };
    title(ui, view, &drawn.name);
    let current = seen.current_line();
    ui.spacing_mut().item_spacing.y = 0.0;
    ui.spacing_mut().interact_size.y = LINE;
    ui.spacing_mut().button_padding = [4.0, 0.0].into();
    let mut area = ScrollArea::vertical().auto_shrink(false);
    if let Some(line) = current.filter(|line| *line > 0) {
        // Beyond the last line it would spring back at every frame, and ask for the next one at once.
        let last = (drawn.listing.count as f32 * LINE - ui.available_height()).max(0.0);
        area = area.vertical_scroll_offset(((line as f32 - 1.0 - ABOVE) * LINE).clamp(0.0, last));
    }
    let mut tapped = None;
    area.show_rows(ui, LINE, drawn.listing.count, |ui, rows| {
        for row in rows {
            let number = row as u32 + 1;
            let chosen = current == Some(number) || (current.is_none() && drawn.from_line == Some(number));
            let text = format!("{number:>4} {}", drawn.listing.line(row).unwrap_or("…"));
            let text = RichText::new(text).monospace();
            let line = Button::selectable(chosen, text).wrap_mode(TextWrapMode::Truncate);
            let line = line.min_size([ui.available_width(), LINE].into());
            if ui.add(line).clicked() {
                tapped = Some(number);
            }
        }
    });
    tapped
}
