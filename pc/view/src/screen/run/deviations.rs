//! How far both spots are beside their seams, along the weld, against the limit.

use super::title;
use crate::live::Deviations;
use crate::screen::View;
use crate::screen::curves::{Curve, Curves, live_plot};
use crate::seen::Seen;
use crate::texts::Text;
use eframe::egui::{Color32, RichText, Ui};
use egui_plot::{HLine, LineStyle, uniform_grid_spacer};
use shared::io::{SLIDE_NAMES, SLIDES};

/// mm to µm.
const UM: f64 = 1e3;

pub(super) fn show(ui: &mut Ui, view: &View, seen: &Seen, curves: &mut Curves) {
    title(ui, view, view.words.say(Text::Deviation));
    let deviations = &seen.live.deviations;
    let limit = seen.program.and_then(|(drawn, _)| drawn.deviation_limit_mm);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.spacing_mut().interact_size.y = 18.0;
        for (slide, newest) in deviations.newest().into_iter().enumerate() {
            let now = newest.map_or("–".to_owned(), |newest| format!("{:+.1}", newest * UM));
            let worst =
                deviations.worst()[slide].map_or("–".to_owned(), |worst| format!("{:.1}", worst * UM));
            let text = format!("{} {now} ({worst})", SLIDE_NAMES[slide]);
            ui.label(
                RichText::new(text)
                    .monospace()
                    .size(13.0)
                    .color(view.theme.slides[slide]),
            );
        }
    });
    let reach = limit.unwrap_or(0.05) * UM;
    let length = seen.program.map_or(100.0, |(drawn, _)| drawn.way.work_mm());
    live_plot("deviations")
        .y_grid_spacer(uniform_grid_spacer(move |_| [10.0 * reach, reach, reach / 5.0]))
        .include_x(0.0)
        .include_x(length)
        .include_y(-1.2 * reach)
        .include_y(1.2 * reach)
        .show(ui, |plot| {
            let all = (0..SLIDES).map(|slide| curve(deviations, slide, view.theme.slides[slide]));
            curves.show(plot, all.collect());
            if limit.is_some() {
                for side in [-reach, reach] {
                    let name = view.words.with(Text::Limit, &[&format!("{reach:.0}")]);
                    let limit = HLine::new(name, side).color(view.theme.bad);
                    plot.hline(limit.style(LineStyle::dashed_loose()));
                }
            }
        });
}

/// The deviation of a slide along the work \[µm\]: U solid, V dashed.
pub fn curve(deviations: &Deviations, slide: usize, colour: Color32) -> Curve {
    let ends = deviations
        .bins()
        .flat_map(|(at, bin)| [bin.least[slide], bin.largest[slide]].map(|value| [at, value * UM]));
    Curve {
        points: ends.filter(|[_, value]| value.is_finite()).collect(),
        colour,
        is_dashed: !slide.is_multiple_of(2),
    }
}
