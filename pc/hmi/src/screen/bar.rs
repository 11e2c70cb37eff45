//! What is always in sight: state, what the machine does and waits for, and Stop.

use super::View;
use super::alarms::said;
use crate::seen::Seen;
use crate::station::Station;
use crate::texts::Text;
use eframe::egui::{Align, Button, Color32, Direction, Frame, Label, Layout, RichText, Ui, UiBuilder};
use host_link::Command;
use host_link::events::Phase;
use shared::state::State;

/// Width of Stop \[points\].
const STOP: f32 = 150.0;

pub(super) fn show(ui: &mut Ui, view: &View, station: &mut Station, left_handed: bool) {
    let area = ui.max_rect();
    let (stop, rest) = if left_handed {
        let (stop, rest) = area.split_left_right_at_x(area.left() + STOP);
        (stop, rest.with_min_x(rest.left() + 12.0))
    } else {
        let (rest, stop) = area.split_left_right_at_x(area.right() - STOP);
        (stop, rest.with_max_x(rest.right() - 12.0))
    };
    let centred = Layout::centered_and_justified(Direction::TopDown);
    ui.scope_builder(
        UiBuilder::new().max_rect(stop.shrink(4.0)).layout(centred),
        |ui| stop_button(ui, view, station),
    );
    ui.scope_builder(
        UiBuilder::new()
            .max_rect(rest.shrink(4.0))
            .layout(Layout::left_to_right(Align::Center)),
        |ui| {
            let seen = station.seen();
            state(ui, view, &seen);
            told(ui, view, &seen);
        },
    );
}

/// Never greyed while anything runs, whatever else is lost.
fn stop_button(ui: &mut Ui, view: &View, station: &mut Station) {
    let text = RichText::new(view.words.say(Text::Stop))
        .size(30.0)
        .strong()
        .color(Color32::WHITE);
    let button = Button::new(text).fill(Color32::from_rgb(200, 20, 20));
    if ui
        .add(button)
        .on_hover_text(view.words.say(Text::StopHint))
        .clicked()
    {
        station.send(Command::Stop, view.now);
    }
}

/// State of the machine, as the board says it, and its age if that is old.
pub(super) fn state(ui: &mut Ui, view: &View, seen: &Seen) {
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
pub(super) fn told(ui: &mut Ui, view: &View, seen: &Seen) {
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
        (said(words, &alarm.what), view.theme.bad)
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
