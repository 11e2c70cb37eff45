//! Where the axes and the tip are, as the board says it.

use super::title;
use crate::screen::View;
use crate::station::Station;
use crate::texts::Text;
use eframe::egui::{Grid, RichText, Ui};
use shared::io::{AXES, AXIS_NAMES, SLIDE_NAMES};

/// Rows are so high \[points\].
const ROW: f32 = 22.0;

pub(super) fn show(ui: &mut Ui, view: &View, station: &Station) {
    title(ui, view, view.words.say(Text::Positions));
    let Some((machine, motion)) = station.by_hand().zip(station.live.motion.as_ref()) else {
        ui.label(RichText::new(view.words.say(Text::NotHomed)).color(view.theme.faint));
        return;
    };
    let fitted = machine.planner.fitted();
    let tip = machine.planner.tip(&motion.axes).position_mm;
    Grid::new("positions")
        .num_columns(4)
        .min_row_height(ROW)
        .spacing([12.0, 2.0])
        .show(ui, |ui| {
            for heading in [
                "",
                view.words.say(Text::FrameAxes),
                "",
                view.words.say(Text::TipOfTool),
            ] {
                ui.label(RichText::new(heading).size(13.0).color(view.theme.faint));
            }
            ui.end_row();
            for axis in (0..AXES).filter(|axis| fitted[*axis]) {
                let unit = if axis < 3 { "mm" } else { "°" };
                ui.label(RichText::new(AXIS_NAMES[axis]).size(17.0).strong());
                let homed = motion.homed;
                value(ui, view, &format!("{:9.3} {unit}", motion.axes[axis]), homed);
                match tip.get(axis) {
                    Some(at) => {
                        ui.label(RichText::new(AXIS_NAMES[axis]).size(17.0));
                        value(ui, view, &format!("{at:9.3} mm"), homed);
                    }
                    None => {
                        ui.label("");
                        ui.label("");
                    }
                }
                ui.end_row();
            }
        });
    if let (Some(tracker), Some(unit)) = (&station.live.tracker, &machine.is.tracking) {
        let fitted = SLIDE_NAMES.iter().take(unit.board.slides.len());
        let at = fitted.zip(tracker.slides_mm);
        let text: Vec<_> = at.map(|(name, at)| format!("{name} {at:.3}")).collect();
        ui.label(
            RichText::new(format!("{} mm", text.join("  ")))
                .monospace()
                .size(13.0),
        );
    }
}

/// Faint as long as it is not counted from a reference mark.
fn value(ui: &mut Ui, view: &View, text: &str, homed: bool) {
    let text = RichText::new(text).monospace().size(17.0);
    ui.label(if homed { text } else { text.color(view.theme.faint) });
}
