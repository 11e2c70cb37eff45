//! Speed, power, place and time of the job, in large letters, and how the last one ended.

use super::card;
use crate::drawn::Drawn;
use crate::live::Live;
use crate::screen::View;
use crate::seen::{Ended, Seen};
use crate::texts::Text;
use eframe::egui::{Label, RichText, Ui};
use shared::units::MM_S_PER_M_MIN;

pub(super) fn show(ui: &mut Ui, view: &View, seen: &Seen) {
    let standing = &seen.standing;
    let Some((drawn, _)) = seen.program else {
        let text = match &standing.refused {
            Some(reason) => {
                RichText::new(format!("{}: {reason}", view.words.say(Text::WrongFile))).color(view.theme.bad)
            }
            None => RichText::new(view.words.say(view.no_program)).size(18.0),
        };
        ui.add(Label::new(text).wrap());
        return;
    };
    if let Some(reason) = &standing.refused {
        let text = format!("{}: {reason}", view.words.say(Text::WrongFile));
        ui.add(Label::new(RichText::new(text).color(view.theme.bad)).wrap());
    } else if let Some(last) = &standing.last {
        ended(ui, view, last);
    } else {
        ui.columns_const(|columns: &mut [Ui; 5]| {
            for (ui, (text, value)) in columns.iter_mut().zip(told(seen, drawn)) {
                figure(ui, view, text, &value);
            }
        });
    }
}

/// The figures of now.
fn told(seen: &Seen, drawn: &Drawn) -> [(Text, String); 5] {
    let live = seen.live;
    let none = || "–".to_owned();
    let speed = live
        .newest
        .map(|newest| format!("{:.2} m/min", newest.speed_mm_s / MM_S_PER_M_MIN));
    let along = live.along_mm().map(|along| format!("{along:.1} mm"));
    let line = live
        .motion
        .as_ref()
        .filter(|motion| motion.line > 0)
        .map(|motion| motion.line.to_string());
    let (time, seconds) = match live.place().filter(|_| seen.standing.runs_program) {
        Some((path, s_mm)) => (
            Text::Remaining,
            drawn.remaining_s(path, s_mm) / (seen.standing.override_percent / 100.0).max(0.01),
        ),
        None => (Text::Predicted, drawn.duration_s),
    };
    [
        (Text::Speed, speed.unwrap_or_else(none)),
        (Text::Power, power(live, drawn).unwrap_or_else(none)),
        (Text::Along, along.unwrap_or_else(none)),
        (Text::Line, line.unwrap_or_else(none)),
        (
            time,
            format!(
                "{:.0}:{:02.0}",
                (seconds / 60.0).floor(),
                (seconds % 60.0).floor()
            ),
        ),
    ]
}

/// Power of the beams that are on \[W\].
fn power(live: &Live, drawn: &Drawn) -> Option<String> {
    let newest = live.newest?;
    let beams = drawn.motion.beams.iter().zip(newest.beams).zip(newest.levels);
    let watts = beams.filter_map(|((beam, on), level)| {
        let full = beam.as_ref()?.power_at_10v_w;
        Some(if on {
            format!("{:.0}", f64::from(level) * full)
        } else {
            "0".to_owned()
        })
    });
    let watts: Vec<String> = watts.collect();
    (!watts.is_empty()).then(|| format!("{} W", watts.join(" + ")))
}

fn figure(ui: &mut Ui, view: &View, text: Text, value: &str) {
    card(view).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.label(
            RichText::new(view.words.say(text))
                .size(13.0)
                .color(view.theme.faint),
        );
        ui.add(Label::new(RichText::new(value).size(20.0).strong()).truncate());
    });
}

/// How the last job ended.
fn ended(ui: &mut Ui, view: &View, last: &Ended) {
    let (text, colour, more) = match (&last.error, &last.outside) {
        (Some(error), _) => (Text::EndedEarly, view.theme.bad, Some(error.clone())),
        (None, Some(outside)) => (Text::FinishedOutside, view.theme.bad, Some(outside.clone())),
        (None, None) => (Text::Finished, view.theme.good, None),
    };
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.label(
            RichText::new(view.words.say(text))
                .size(20.0)
                .strong()
                .color(colour),
        );
        let report = last.report.as_ref();
        let report = report.map(|folder| view.words.with(Text::ReportIn, &[folder]));
        let more: Vec<String> = more.into_iter().chain(report).collect();
        ui.add(Label::new(more.join(" · ")).wrap());
    });
}
