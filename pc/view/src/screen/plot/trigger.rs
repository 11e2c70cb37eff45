//! When a curve freezes by itself.

use super::name;
use crate::live::{SIGNALS, Signal, Signals};
use crate::texts::{Text, Words};
use eframe::egui::{ComboBox, DragValue, Ui};

/// When to freeze.
pub(super) struct Trigger {
    signal: Signal,
    level: f64,
    /// Crossings before this time do not count \[s\]; `None` where it is not armed.
    armed: Option<f64>,
    /// When the level was crossed \[s\].
    crossed: Option<f64>,
}

impl Default for Trigger {
    fn default() -> Self {
        Self {
            signal: Signal::Speed,
            level: 1.0,
            armed: None,
            crossed: None,
        }
    }
}

impl Trigger {
    /// When its level was crossed upwards \[s\], once half a window has passed since; then it is not armed any more.
    pub fn due(&mut self, signals: &Signals, window_s: f64) -> Option<f64> {
        let newest_s = signals.newest_s();
        // The clock of boards that are new starts anew.
        let armed = self.armed?.min(newest_s);
        self.armed = Some(armed);
        if self.crossed.is_none() {
            let course = signals.course(self.signal, window_s, usize::MAX);
            let mut pairs = course.windows(2).filter(|pair| pair[1][0] > armed);
            self.crossed = pairs
                .find(|pair| pair[0][1] < self.level && pair[1][1] >= self.level)
                .map(|pair| pair[1][0]);
        }
        let crossed = self
            .crossed
            .filter(|crossed| newest_s > crossed + window_s / 2.0)?;
        (self.armed, self.crossed) = (None, None);
        Some(crossed)
    }

    /// What it waits for, and whether it is armed.
    pub fn show(&mut self, ui: &mut Ui, words: Words, signals: &Signals) {
        ui.horizontal_wrapped(|ui| {
            ui.label(words.say(Text::TriggerOn));
            let shown = name(words, self.signal);
            ComboBox::new("trigger", "")
                .selected_text(shown)
                .width(220.0)
                .show_ui(ui, |ui| {
                    for signal in SIGNALS {
                        ui.selectable_value(&mut self.signal, signal, name(words, signal));
                    }
                });
            let above = ui.label(words.say(Text::RisesAbove));
            let unit = format!(" {}", self.signal.unit().name());
            ui.add(DragValue::new(&mut self.level).speed(0.1).suffix(unit))
                .labelled_by(above.id);
            let mut armed = self.armed.is_some();
            if ui.toggle_value(&mut armed, words.say(Text::Arm)).changed() {
                (self.armed, self.crossed) = (armed.then(|| signals.newest_s()), None);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::io::{AXES, LEVELS, MOTORS, SIDES};
    use shared::protocol::MotionSample;
    use shared::state::State;

    fn tick(ms: u32, speed_mm_s: f64) -> MotionSample {
        MotionSample {
            tick: ms,
            time_us: u64::from(ms) * 1000,
            state: State::Running,
            path_id: 1,
            s_mm: 0.0,
            speed_mm_s,
            beams: [false; SIDES],
            outputs: 0,
            inputs: 0,
            levels: [0.0; LEVELS],
            switched: Default::default(),
            axes: [0.0; AXES],
            truth: None,
            following_error: [0.0; MOTORS],
            skew_mm: 0.0,
            load: None,
        }
    }

    #[test]
    fn it_is_due_half_a_window_after_the_first_crossing_since_it_was_armed_and_only_once() {
        let mut signals = Signals::default();
        let fast_from = |ms: u32| {
            if (100..200).contains(&ms) || ms >= 300 {
                50.0
            } else {
                0.0
            }
        };
        (0..250).for_each(|ms| signals.motion(&tick(ms, fast_from(ms))));
        let mut trigger = Trigger {
            armed: Some(signals.newest_s()),
            ..Trigger::default()
        };
        for ms in 250..1000 {
            signals.motion(&tick(ms, fast_from(ms)));
            let due = trigger.due(&signals, 1.0);
            // 1 m/min was crossed at 0.3 s; what was before it was armed does not count.
            assert_eq!(due, (ms == 801).then_some(0.3), "{ms} ms");
            if due.is_some() {
                break;
            }
        }
        assert_eq!(trigger.due(&signals, 1.0), None);
    }
}
