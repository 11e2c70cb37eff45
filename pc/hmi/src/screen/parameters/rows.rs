//! The list of parameters, and what is searched in it.

use super::{ParametersPage, Shown};
use crate::parameters::Parameters;
use crate::screen::{View, nothing};
use crate::texts::Text;
use config::parameters::{Parameter, Table};
use eframe::egui::text::LayoutJob;
use eframe::egui::{
    Align2, Color32, FontId, Rect, Response, RichText, Role, ScrollArea, Sense, StrokeKind, TextEdit,
    TextStyle, Ui, WidgetInfo, vec2,
};

/// Height of a row that is tapped \[points\].
const ROW: f32 = 38.0;
/// Where columns begin: the mark, name, value, unit, the shipped value \[points\].
const COLUMNS: [f32; 5] = [6.0, 26.0, 300.0, 440.0, 530.0];

impl ParametersPage {
    pub(super) fn rows(&mut self, ui: &mut Ui, view: &View) {
        self.filter(ui, view);
        let Some(parameters) = &self.opened else { return };
        let search = self.search.trim().to_lowercase();
        let is_listed = |table: &Table, parameter: &Parameter| {
            let is_shown = match self.shown {
                Shown::All => true,
                Shown::Changed => parameters.change(&parameter.key).is_some(),
                Shown::OtherThanShipped => parameters.is_other_than_shipped(parameter),
            };
            let mut told = [&parameter.key, &parameter.comment, &table.comment].into_iter();
            is_shown && (search.is_empty() || told.any(|text| text.to_lowercase().contains(&search)))
        };
        heads(ui, view);
        let mut any = false;
        let mut tapped = None;
        ui.spacing_mut().item_spacing.y = 0.0;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for table in parameters.tables() {
                let mut listed = table
                    .parameters
                    .iter()
                    .filter(|one| is_listed(table, one))
                    .peekable();
                if listed.peek().is_some() && !table.name.is_empty() {
                    head_of(ui, view, table);
                }
                for parameter in listed {
                    any = true;
                    let is_chosen = self
                        .chosen
                        .as_ref()
                        .is_some_and(|chosen| chosen.key == parameter.key);
                    if row(ui, view, parameters, parameter, is_chosen).clicked() {
                        tapped = Some(parameter.key.clone());
                    }
                }
            }
            if !any {
                nothing(ui, view, Text::NoParameters);
            }
        });
        if let Some(key) = tapped {
            self.choose(&key);
        }
    }

    fn filter(&mut self, ui: &mut Ui, view: &View) {
        let words = view.words;
        let changed = self
            .opened
            .as_ref()
            .map_or(0, |parameters| parameters.changes().len());
        ui.horizontal(|ui| {
            let label = ui.label(words.say(Text::Search));
            let field = TextEdit::singleline(&mut self.search)
                .desired_width(190.0)
                .margin(vec2(8.0, 8.0));
            ui.add(field).labelled_by(label.id);
            for (shown, text) in [
                (Shown::All, words.say(Text::AllParameters).to_owned()),
                (
                    Shown::Changed,
                    words.with(Text::ChangedParameters, &[&changed.to_string()]),
                ),
                (
                    Shown::OtherThanShipped,
                    words.say(Text::OtherThanShipped).to_owned(),
                ),
            ] {
                ui.selectable_value(&mut self.shown, shown, RichText::new(text).size(15.0));
            }
        });
    }
}

/// Names of the columns.
fn heads(ui: &mut Ui, view: &View) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    for (column, text) in [
        (1, Text::Parameters),
        (2, Text::Value),
        (3, Text::Unit),
        (4, Text::Shipped),
    ] {
        cell(ui, rect, column, view.words.say(text), 14.0, view.theme.faint);
    }
}

/// A table's name, and its comment as far as there is room.
fn head_of(ui: &mut Ui, view: &View, table: &Table) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    if ui.is_rect_visible(rect) {
        let strong = ui.visuals().strong_text_color();
        let name = text_in(ui, rect, &format!("[{}]", table.name), 16.0, strong);
        let left = (name.right() + 10.0).max(rect.left() + COLUMNS[2]);
        text_in(ui, rect.with_min_x(left), &table.comment, 14.0, view.theme.faint);
    }
}

/// A parameter: all of its row is tapped.
fn row(ui: &mut Ui, view: &View, parameters: &Parameters, one: &Parameter, is_chosen: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let text = ui.visuals().text_color();
    let (mark, colour) = if parameters.is_refused_at(one) {
        ("✖", view.theme.bad)
    } else if parameters.change(&one.key).is_some() {
        ("●", view.theme.doubt)
    } else {
        ("", text)
    };
    response.widget_info(|| {
        let label = format!("{mark} {} = {} {}", one.key, one.value, one.unit);
        WidgetInfo::selected(Role::Button, true, is_chosen, label.trim())
    });
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let visuals = ui.style().interact_selectable(&response, is_chosen);
    let around = rect.shrink2(vec2(0.0, 1.0));
    if is_chosen || response.hovered() {
        ui.painter().rect_filled(around, 4, visuals.weak_bg_fill);
    }
    if response.has_focus() {
        let stroke = (2.0, ui.visuals().strong_text_color());
        ui.painter().rect_stroke(around, 4, stroke, StrokeKind::Inside);
    }
    cell(ui, rect, 0, mark, 16.0, colour);
    cell(ui, rect, 1, &one.name, 16.0, text);
    cell(ui, rect, 2, &one.value, 16.0, colour);
    cell(ui, rect, 3, one.unit, 15.0, view.theme.faint);
    let shipped = parameters.shipped(&one.key).unwrap_or("–");
    if parameters.is_other_than_shipped(one) {
        cell(ui, rect, 4, &format!("≠ {shipped}"), 16.0, text);
    } else {
        cell(ui, rect, 4, shipped, 16.0, view.theme.faint);
    }
    response
}

/// Text in a column of a row; the last one has all the room that is left.
fn cell(ui: &Ui, row: Rect, column: usize, text: &str, size: f32, colour: Color32) {
    let next = COLUMNS.get(column + 1);
    let right = next.map_or(row.right(), |next| row.left() + next - 8.0);
    let room = row.with_min_x(row.left() + COLUMNS[column]).with_max_x(right);
    text_in(ui, room, text, size, colour);
}

/// Text in one line, shortened where there is no room; gives where it is.
fn text_in(ui: &Ui, room: Rect, text: &str, size: f32, colour: Color32) -> Rect {
    let family = TextStyle::Body.resolve(ui.style()).family;
    let mut job = LayoutJob::simple_singleline(text.to_owned(), FontId::new(size, family), colour);
    job.wrap.max_width = room.width();
    (job.wrap.max_rows, job.wrap.break_anywhere) = (1, true);
    let galley = ui.painter().layout_job(job);
    let place = Align2::LEFT_CENTER.anchor_size(room.left_center(), galley.size());
    ui.painter().galley(place.min, galley, colour);
    place
}
