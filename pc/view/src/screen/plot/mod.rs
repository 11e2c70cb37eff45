//! The page of live curves: any signals of the telemetry, a trigger, two cursors, export.

mod export;
mod trigger;

use super::curves::{Curve, Curves, live_plot};
use super::{View, bare};
use crate::live::{SIGNALS, Signal, Signals};
use crate::texts::{Text, Words};
use config::sentence;
use eframe::egui::{self, Button, Color32, Grid, Label, RichText, ScrollArea, Ui};
use egui_plot::VLine;
use shared::io::{AXIS_NAMES, MOTOR_NAMES, SLIDE_NAMES};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use trigger::Trigger;

/// Width of the list of signals \[points\].
const LIST: f32 = 270.0;
/// Windows that can be chosen \[s\].
const WINDOWS: [f64; 5] = [0.5, 2.0, 5.0, 10.0, 30.0];
/// Points of a curve on the screen.
const POINTS: usize = 1600;
/// Curves at a time.
const MOST: usize = 6;
/// Colours of the curves, in the order in which they were chosen.
const COLOURS: [Color32; MOST] = [
    Color32::from_rgb(80, 170, 255),
    Color32::from_rgb(255, 150, 50),
    Color32::from_rgb(90, 200, 120),
    Color32::from_rgb(255, 220, 120),
    Color32::from_rgb(220, 130, 255),
    Color32::from_rgb(230, 230, 230),
];

/// What the page remembers.
pub struct PlotPage {
    chosen: Vec<Signal>,
    window_s: f64,
    /// What was there when it was frozen.
    frozen: Option<Arc<Signals>>,
    trigger: Trigger,
    /// Two times \[s\], by the boards' clocks.
    cursors: [Option<f64>; 2],
    told: Option<Result<PathBuf, String>>,
    drawn: Curves,
}

impl Default for PlotPage {
    fn default() -> Self {
        Self {
            chosen: vec![Signal::Speed, Signal::SlideError(0), Signal::SlideError(2)],
            window_s: 5.0,
            frozen: None,
            trigger: Trigger::default(),
            cursors: [None; 2],
            told: None,
            drawn: Curves::default(),
        }
    }
}

impl PlotPage {
    /// Looks for what the trigger waits for, also while another page is in sight.
    pub fn turn(&mut self, signals: &Signals) {
        if self.frozen.is_none()
            && let Some(crossed_s) = self.trigger.due(signals, self.window_s)
        {
            self.frozen = Some(Arc::new(signals.clone()));
            self.cursors = [Some(crossed_s), None];
        }
    }

    /// Shows it. Curves can be exported into `folder`; without one there is no button for that.
    pub fn show(&mut self, ui: &mut Ui, view: &View, signals: &Signals, folder: Option<&Path>) {
        bare(egui::Panel::left("signals"))
            .exact_size(LIST)
            .resizable(false)
            .show(ui, |ui| self.list(ui, view));
        self.buttons(ui, view, signals, folder);
        let frozen = self.frozen.clone();
        let shown = frozen.as_deref().unwrap_or(signals);
        if shown.is_empty() {
            super::nothing(ui, view, Text::NoSignals);
            return;
        }
        self.values(ui, view, shown);
        self.curves(ui, view, shown);
    }

    fn list(&mut self, ui: &mut Ui, view: &View) {
        ui.heading(view.words.say(Text::Signals));
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for signal in SIGNALS {
                let mut on = self.chosen.contains(&signal);
                let room = on || self.chosen.len() < MOST;
                let colour = self.colour(signal).unwrap_or(ui.visuals().text_color());
                let text = RichText::new(name(view.words, signal)).color(colour);
                ui.add_enabled_ui(room, |ui| {
                    if ui.checkbox(&mut on, text).changed() {
                        self.chosen.retain(|chosen| *chosen != signal);
                        if on {
                            self.chosen.push(signal);
                        }
                    }
                });
            }
        });
    }

    fn colour(&self, signal: Signal) -> Option<Color32> {
        let place = self.chosen.iter().position(|chosen| *chosen == signal)?;
        Some(COLOURS[place])
    }

    fn buttons(&mut self, ui: &mut Ui, view: &View, signals: &Signals, folder: Option<&Path>) {
        let words = view.words;
        ui.horizontal_wrapped(|ui| {
            ui.label(words.say(Text::Window));
            for window in WINDOWS {
                let text = words.with(Text::Seconds, &[&window.to_string()]);
                ui.selectable_value(&mut self.window_s, window, text);
            }
            ui.separator();
            let mut frozen = self.frozen.is_some();
            if ui.toggle_value(&mut frozen, words.say(Text::Freeze)).changed() {
                (self.frozen, self.cursors) = (frozen.then(|| Arc::new(signals.clone())), [None; 2]);
            }
            // A viewer has not every tick.
            let Some(folder) = folder else { return };
            if ui
                .add_enabled(!signals.is_empty(), Button::new(words.say(Text::Export)))
                .clicked()
            {
                let shown = self.frozen.as_deref().unwrap_or(signals);
                let written = export::write(folder, words, shown, &self.chosen, self.window_s);
                self.told = Some(written.map_err(|error| sentence(error.as_ref())));
            }
        });
        self.trigger.show(ui, words, signals);
        match &self.told {
            Some(Ok(file)) => {
                let text = words.with(Text::Exported, &[&file.display().to_string()]);
                ui.label(RichText::new(text).color(view.theme.faint));
            }
            Some(Err(error)) => {
                ui.add(Label::new(RichText::new(error).color(view.theme.bad)).wrap());
            }
            None => {}
        }
    }

    /// What the signals are at both cursors.
    fn values(&self, ui: &mut Ui, view: &View, shown: &Signals) {
        let [Some(first), second] = self.cursors else {
            if self.frozen.is_some() {
                let hint = view.words.say(Text::CursorHint);
                ui.label(RichText::new(hint).color(view.theme.faint));
            }
            return;
        };
        Grid::new("cursors")
            .num_columns(4)
            .spacing([18.0, 2.0])
            .show(ui, |ui| {
                let ms = second.map_or(String::new(), |second| {
                    format!("Δt {:.1} ms", (second - first) * 1e3)
                });
                for text in ["", "A", "B", &ms] {
                    ui.label(RichText::new(text).color(view.theme.faint));
                }
                ui.end_row();
                for signal in &self.chosen {
                    let course = shown.course(*signal, f64::INFINITY, usize::MAX);
                    let value = |time: Option<f64>| value_at(&course, time?);
                    let [at_first, at_second] = [value(Some(first)), value(second)];
                    let difference = at_first.zip(at_second).map(|(first, second)| second - first);
                    ui.label(name(view.words, *signal));
                    for value in [at_first, at_second, difference] {
                        ui.label(value.map_or(String::new(), |value| {
                            format!("{value:.3} {}", signal.unit().name())
                        }));
                    }
                    ui.end_row();
                }
            });
    }

    /// Curves, each scaled for itself: what is at the bottom and at the top is said above them.
    fn curves(&mut self, ui: &mut Ui, view: &View, shown: &Signals) {
        let newest = shown.newest_s();
        let mut curves = Vec::with_capacity(self.chosen.len());
        ui.horizontal_wrapped(|ui| {
            for signal in &self.chosen {
                let colour = self.colour(*signal).unwrap_or(Color32::WHITE);
                let mut points = shown.course(*signal, self.window_s, POINTS);
                let (low, high) = range(&points);
                let (name, unit) = (name(view.words, *signal), signal.unit().name());
                let text = format!("{name}: {low:.3} … {high:.3} {unit}");
                ui.add(Label::new(RichText::new(text).color(colour)).extend());
                let span = (high - low).max(1e-9);
                for [x, y] in &mut points {
                    (*x, *y) = (*x - newest, (*y - low) / span);
                }
                curves.push(Curve {
                    points,
                    colour,
                    is_dashed: false,
                });
            }
        });
        let plot = live_plot("curves")
            .show_y(false)
            .include_x(-self.window_s)
            .include_x(0.0)
            .include_y(0.0)
            .include_y(1.0)
            .show_axes([true, false]);
        let response = plot.show(ui, |plot| {
            self.drawn.show(plot, curves);
            for (cursor, name) in self.cursors.into_iter().zip(["A", "B"]) {
                if let Some(time) = cursor {
                    plot.vline(VLine::new(name, time - newest).color(Color32::WHITE));
                }
            }
            plot.pointer_coordinate()
        });
        if self.frozen.is_some()
            && response.response.clicked()
            && let Some(tapped) = response.inner
        {
            self.set_cursor(tapped.x + newest);
        }
    }

    /// The first tap sets A, the second B, others move the nearer one.
    fn set_cursor(&mut self, time: f64) {
        let nearer = match self.cursors {
            [None, _] => 0,
            [_, None] => 1,
            [Some(a), Some(b)] => usize::from((time - b).abs() < (time - a).abs()),
        };
        self.cursors[nearer] = Some(time);
    }
}

/// Least and largest value.
fn range(course: &[[f64; 2]]) -> (f64, f64) {
    let values = course.iter().map(|[_, value]| *value);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if low > high { (0.0, 0.0) } else { (low, high) }
}

/// The value of the last tick at or before `time`.
fn value_at(course: &[[f64; 2]], time: f64) -> Option<f64> {
    let after = course.partition_point(|[at, _]| *at <= time);
    Some(course.get(after.checked_sub(1)?)?[1])
}

/// A signal, as the screen calls it.
fn name(words: Words, signal: Signal) -> String {
    let side = |side: usize| (side + 1).to_string();
    match signal {
        Signal::Speed => words.say(Text::SignalSpeed).to_owned(),
        Signal::Skew => words.say(Text::SignalSkew).to_owned(),
        Signal::Axis(axis) => words.with(Text::SignalAxis, &[AXIS_NAMES[axis]]),
        Signal::FollowingError(motor) => words.with(Text::SignalFollowingError, &[MOTOR_NAMES[motor]]),
        Signal::Beam(of) => words.with(Text::SignalBeam, &[&side(of)]),
        Signal::Power(of) => words.with(Text::SignalPower, &[&side(of)]),
        Signal::Slide(slide) => words.with(Text::SignalSlide, &[SLIDE_NAMES[slide]]),
        Signal::SlideError(slide) => words.with(Text::SignalSlideError, &[SLIDE_NAMES[slide]]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taps_set_a_then_b_then_move_the_nearer_one() {
        let mut page = PlotPage::default();
        [1.0, 3.0, 1.2, 2.5]
            .into_iter()
            .for_each(|time| page.set_cursor(time));
        assert_eq!(page.cursors, [Some(1.2), Some(2.5)]);
    }

    #[test]
    fn a_value_is_that_of_the_tick_before() {
        let course = [[1.0, 10.0], [2.0, 20.0]];
        assert_eq!(value_at(&course, 0.5), None);
        assert_eq!(value_at(&course, 1.9), Some(10.0));
        assert_eq!(value_at(&course, 9.0), Some(20.0));
    }
}
