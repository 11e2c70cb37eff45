//! Both cameras live, with what helps to bring the work into focus.

use crate::live::Live;
use crate::screen::View;
use crate::texts::Text;
use ::view::screen::run::Textures;
use eframe::egui::{Label, Rect, RichText, Role, Sense, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use host_link::events::{Focus, MeasuredPicture};
use shared::io::SIDES;

/// Height of a bar \[points\].
const BAR: f32 = 24.0;

/// What the page remembers of the cameras between two frames.
#[derive(Default)]
pub(super) struct Cameras {
    textures: Textures,
    /// The sharpest that each was.
    best: [f64; SIDES],
}

impl Cameras {
    pub fn show(&mut self, ui: &mut Ui, view: &View, live: &Live) {
        if live.pictures.iter().all(Option::is_none) {
            // Nothing of another time at the machine is held.
            self.best = [0.0; SIDES];
        }
        let best = &mut self.best;
        self.textures.show(ui, view, live, |ui, picture| {
            focus(ui, view, picture, &mut best[picture.side.min(SIDES - 1)]);
        });
    }
}

/// How sharp the picture is beside the best that it was, and what brings it into focus.
fn focus(ui: &mut Ui, view: &View, picture: &MeasuredPicture, best: &mut f64) {
    let words = view.words;
    let sharpness = match picture.focus {
        Focus::Band { contrast, .. } => contrast,
        _ => 0.0,
    };
    *best = best.max(sharpness);
    let (rect, bar) = ui.allocate_exact_size(vec2(ui.available_width(), BAR), Sense::click());
    let text = words.with(
        Text::Sharpness,
        &[&format!("{sharpness:.1}"), &format!("{best:.1}")],
    );
    bar.widget_info(|| WidgetInfo::labeled(Role::Button, true, &text));
    if bar.clicked() {
        *best = sharpness;
    }
    let painter = ui.painter_at(rect);
    let share = if *best > 0.0 { sharpness / *best } else { 0.0 };
    let full = rect.shrink(1.0);
    let filled = Rect::from_min_max(
        full.min,
        pos2(full.left() + full.width() * share as f32, full.bottom()),
    );
    painter.rect_filled(rect, 3, view.theme.card);
    painter.rect_filled(filled, 3, view.theme.good.gamma_multiply(0.6));
    let stroke = if bar.has_focus() {
        (2.0, ui.visuals().strong_text_color())
    } else {
        (1.0, view.theme.faint)
    };
    painter.rect_stroke(rect, 3, stroke, StrokeKind::Inside);
    let font = eframe::egui::FontId::proportional(14.0);
    let colour = ui.visuals().strong_text_color();
    painter.text(
        rect.left_center() + vec2(6.0, 0.0),
        eframe::egui::Align2::LEFT_CENTER,
        text,
        font,
        colour,
    );
    let (text, colour) = match picture.focus {
        Focus::Band {
            defocus_mm: Some(mm), ..
        } => (
            words.with(Text::Defocus, &[&format!("{mm:+.3}")]),
            view.theme.good,
        ),
        Focus::Band { .. } => (words.say(Text::DefocusUnknown).to_owned(), view.theme.faint),
        Focus::TooHigh => (words.say(Text::FocusTooHigh).to_owned(), view.theme.doubt),
        Focus::TooLow => (words.say(Text::FocusTooLow).to_owned(), view.theme.doubt),
        Focus::Nothing => (words.say(Text::NothingSharp).to_owned(), view.theme.faint),
    };
    ui.add(Label::new(RichText::new(text).size(14.0).color(colour)).wrap());
}
