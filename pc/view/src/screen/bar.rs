//! State of the machine, and what it does and waits for.

use super::View;
use crate::seen::Seen;
use crate::texts::Text;
use eframe::egui::{Color32, Frame, Label, RichText, Ui};
use host_link::events::Phase;
use shared::state::State;

/// State of the machine, as the board says it, and its age if that is old.
pub fn state(ui: &mut Ui, view: &View, seen: &Seen) {
    let live = seen.live;
    let state = live.state().filter(|_| seen.standing.is_running);
    // The board calls itself idle while it excites a motor, which moves.
    let excites = matches!(live.phase, Some(Phase::Exciting { .. }));
    let state = state.map(|state| match state {
        State::Idle if excites => State::Running,
        state => state,
    });
    let (text, fill) = match state {
        None => (view.words.say(Text::NoJob), view.theme.card),
        Some(state) => {
            let fill = match state {
                State::Fault => view.theme.bad,
                State::Holding | State::Stopping => view.theme.doubt,
                State::Running | State::Homing => view.theme.good,
                State::Off | State::Idle => view.theme.card,
            };
            (view.words.state(state), fill)
        }
    };
    let letters = if fill == view.theme.card {
        ui.visuals().text_color()
    } else {
        Color32::BLACK
    };
    Frame::new()
        .fill(fill)
        .corner_radius(6)
        .inner_margin(12)
        .show(ui, |ui| {
            ui.add(Label::new(RichText::new(text).size(20.0).strong().color(letters)).extend());
        });
    if live.beam_is_on() && seen.standing.is_running {
        Frame::new()
            .fill(view.theme.beam)
            .corner_radius(6)
            .inner_margin(12)
            .show(ui, |ui| {
                let text = RichText::new(view.words.say(Text::BeamOn))
                    .size(20.0)
                    .strong()
                    .color(Color32::BLACK);
                ui.add(Label::new(text).extend());
            });
    }
}

/// What the machine does, or waits for, or what is wrong; the most urgent alone.
pub fn told(ui: &mut Ui, view: &View, seen: &Seen) {
    let live = seen.live;
    let words = view.words;
    let (text, colour) = if let Some(silent) = live.silent_for(view.now).filter(|_| seen.goes_on()) {
        (
            words.with(Text::Silent, &[&format!("{:.1}", silent.as_secs_f64())]),
            view.theme.bad,
        )
    } else if let Some(question) = &live.question {
        (words.question(question), view.theme.doubt)
    } else if let Some(alarm) = live.journal.open_alarms().next_back() {
        (words.happened(&alarm.what), view.theme.bad)
    } else if seen.standing.is_loading {
        (words.say(Text::Loading).to_owned(), view.theme.faint)
    } else if seen.standing.is_running {
        let phase = live.phase.map(|phase| words.phase(phase));
        (
            phase.unwrap_or_else(|| words.say(Text::NotConnected).to_owned()),
            ui.visuals().text_color(),
        )
    } else {
        return;
    };
    ui.add(Label::new(RichText::new(text).size(18.0).color(colour)).wrap());
}
