//! The panel to jog at: armed first, then a button held, or tapped for a step.

use super::{View, access, title};
use crate::station::{Action, Station};
use crate::texts::Text;
use eframe::egui::{Button, Color32, Context, Key, RichText, Sense, Ui};
use host_link::{ByHand, Command, Jog, JogWay};
use shared::io::{AXES, AXIS_NAMES, SLIDE_NAMES};
use std::time::Duration;

/// What is held to is asked for again so often; the screen is drawn anew as often then.
const AGAIN: Duration = Duration::from_millis(45);
/// A panel that nobody has used for so long is not armed any more.
const UNUSED: Duration = Duration::from_secs(60);
/// Steps \[mm or °\].
const STEPS: [f64; 4] = [0.01, 0.1, 1.0, 10.0];
/// Speeds \[mm/s or °/s\].
const SPEEDS: [f64; 5] = [0.5, 2.0, 5.0, 20.0, 50.0];
/// Size of a button to jog with \[points\].
const JOG: [f32; 2] = [112.0, 64.0];
/// Names of the directions of the tool.
const TOOL_NAMES: [&str; 3] = ["T", "B", "N"];

/// What the directions are of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Frame {
    #[default]
    Axes,
    Work,
    Tool,
    Slides,
}

impl Frame {
    const ALL: [(Self, Text); 4] = [
        (Self::Axes, Text::FrameAxes),
        (Self::Work, Text::FrameWork),
        (Self::Tool, Text::FrameTool),
        (Self::Slides, Text::FrameSlides),
    ];

    /// Its directions with their names, where axes are `fitted`, and so many slides.
    fn ways(self, fitted: &[bool; AXES], slides: usize) -> Vec<(JogWay, &'static str)> {
        let axes = |axes: std::ops::Range<usize>, way: fn(usize) -> JogWay| {
            axes.filter(|axis| fitted[*axis])
                .map(move |axis| (way(axis), AXIS_NAMES[axis]))
        };
        match self {
            Self::Axes => axes(0..AXES, JogWay::Axis).collect(),
            Self::Work => (0..3)
                .map(|axis| (JogWay::Work(axis), AXIS_NAMES[axis]))
                .chain(axes(3..AXES, JogWay::Turn))
                .collect(),
            Self::Tool => (0..).map(JogWay::Tool).zip(TOOL_NAMES).collect(),
            Self::Slides => (0..slides).map(JogWay::Slide).zip(SLIDE_NAMES).collect(),
        }
    }
}

/// See the module.
pub(super) struct Panel {
    /// When it was used last, if it is armed.
    armed: Option<Duration>,
    frame: Frame,
    /// `None`: as long as it is held.
    step: Option<f64>,
    speed: f64,
    /// What is held, and when that was asked for last.
    held: Option<(Jog, Duration)>,
}

impl Default for Panel {
    fn default() -> Self {
        Self {
            armed: None,
            frame: Frame::default(),
            step: None,
            speed: 5.0,
            held: None,
        }
    }
}

impl Panel {
    pub fn is_armed(&self) -> bool {
        self.armed.is_some()
    }

    pub fn disarm(&mut self) {
        self.armed = None;
    }

    /// It is not armed for ever, nor where nothing can be moved.
    pub fn turn(&mut self, station: &mut Station, now: Duration) {
        let unused = self.armed.is_some_and(|used| now > used + UNUSED);
        let allowed = station.allows(Action::Jog);
        if unused || !allowed || !station.may(Action::Jog, now) && !station.may(Action::Hold, now) {
            self.armed = None;
        }
        if self.armed.is_none() {
            self.hold(None, station, now);
        }
    }

    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station) {
        let words = view.words;
        self.arm(ui, view, station);
        ui.horizontal(|ui| {
            for (frame, text) in Frame::ALL {
                let there = frame != Frame::Slides || station.live.tracker.is_some();
                let button = Button::selectable(self.frame == frame, words.say(text));
                if ui
                    .add_enabled(there, button.min_size([100.0, 44.0].into()))
                    .clicked()
                {
                    self.frame = frame;
                }
            }
        });
        ui.horizontal(|ui| {
            title(ui, view, words.say(Text::Step));
            let continuous = Button::selectable(self.step.is_none(), words.say(Text::Continuous));
            if ui.add(continuous.min_size([96.0, 44.0].into())).clicked() {
                self.step = None;
            }
            for step in STEPS {
                let button = Button::selectable(self.step == Some(step), step.to_string());
                if ui.add(button.min_size([56.0, 44.0].into())).clicked() {
                    self.step = Some(step);
                }
            }
            title(ui, view, "mm, °");
        });
        ui.horizontal(|ui| {
            title(ui, view, words.say(Text::JogSpeed));
            for speed in SPEEDS {
                let button = Button::selectable(self.speed == speed, format!("{speed} "));
                if ui.add(button.min_size([56.0, 44.0].into())).clicked() {
                    self.speed = speed;
                }
            }
            title(ui, view, "mm/s, °/s");
        });
        ui.add_space(8.0);
        let asked = self.directions(ui, view, station);
        self.ask(asked, ui.ctx(), station, view.now);
        ui.label(
            RichText::new(words.say(Text::JogKeys))
                .size(13.0)
                .color(view.theme.faint),
        );
    }

    fn arm(&mut self, ui: &mut Ui, view: &View, station: &Station) {
        if !station.allows(Action::Jog) {
            access::needed(ui, view, station, Action::Jog);
            return;
        }
        let may = station.may(Action::Jog, view.now);
        let (text, fill) = match self.armed {
            Some(_) => (Text::Armed, view.theme.doubt),
            None => (Text::ArmPanel, view.theme.card),
        };
        let mut label = RichText::new(view.words.say(text)).size(18.0);
        if self.armed.is_some() {
            label = label.color(Color32::BLACK).strong();
        }
        let button = Button::new(label)
            .fill(fill)
            .min_size([ui.available_width(), 56.0].into());
        if ui.add_enabled(may || self.armed.is_some(), button).clicked() {
            self.armed = match self.armed {
                Some(_) => None,
                None => Some(view.now),
            };
        }
    }

    /// The buttons; what of them is held, or tapped for a step, and whether it goes up.
    fn directions(&self, ui: &mut Ui, view: &View, station: &Station) -> Option<(JogWay, f64)> {
        let fitted = station
            .by_hand()
            .map_or([true; AXES], |machine| machine.planner.fitted());
        let may = self.armed.is_some() && station.may(Action::Jog, view.now);
        let mut asked = self.keys(ui, may);
        let unit = station.by_hand().and_then(|machine| machine.is.tracking.as_ref());
        let ways = self
            .frame
            .ways(&fitted, unit.map_or(0, |unit| unit.board.slides.len()));
        eframe::egui::Grid::new("directions")
            .spacing([10.0, 8.0])
            .show(ui, |ui| {
                for pair in ways.chunks(2) {
                    for (way, name) in pair {
                        for (sign, mark) in [(-1.0, "−"), (1.0, "+")] {
                            let label = RichText::new(format!("{name} {mark}")).size(22.0);
                            // What can be clicked only is let go of after a second.
                            let button = Button::new(label)
                                .min_size(JOG.into())
                                .sense(Sense::click_and_drag());
                            let button = ui.add_enabled(may, button);
                            let held = button.is_pointer_button_down_on() && button.contains_pointer();
                            let wanted = match self.step {
                                None => held,
                                Some(_) => button.clicked(),
                            };
                            if wanted {
                                asked = Some((*way, sign));
                            }
                        }
                    }
                    ui.end_row();
                }
            });
        asked.filter(|_| may)
    }

    /// The same by keys: the first three directions, where no text is typed.
    fn keys(&self, ui: &Ui, may: bool) -> Option<(JogWay, f64)> {
        let directions = match self.frame {
            Frame::Axes => JogWay::Axis,
            Frame::Work => JogWay::Work,
            Frame::Tool => JogWay::Tool,
            Frame::Slides => return None,
        };
        if !may || ui.ctx().memory(|memory| memory.focused().is_some()) {
            return None;
        }
        let keys = [
            (Key::ArrowLeft, 0, -1.0),
            (Key::ArrowRight, 0, 1.0),
            (Key::ArrowDown, 1, -1.0),
            (Key::ArrowUp, 1, 1.0),
            (Key::PageDown, 2, -1.0),
            (Key::PageUp, 2, 1.0),
        ];
        let asked = |key: Key| {
            ui.input(|input| match self.step {
                None => input.key_down(key),
                Some(_) => input.key_pressed(key),
            })
        };
        let found = keys.into_iter().find(|(key, ..)| asked(*key));
        found.map(|(_, direction, sign)| (directions(direction), sign))
    }

    /// Asks the job for it.
    fn ask(&mut self, asked: Option<(JogWay, f64)>, ctx: &Context, station: &mut Station, now: Duration) {
        let jog = asked.map(|(way, sign)| Jog::now(way, sign * self.speed, self.step));
        if jog.is_some() {
            self.armed = Some(now);
            ctx.request_repaint_after(AGAIN / 2);
        }
        match jog {
            Some(jog) if jog.step.is_some() => station.send(Command::ByHand(ByHand::Jog(jog)), now),
            held => self.hold(held, station, now),
        }
    }

    /// Asks again in time for what is held; lets go of what is not any more.
    fn hold(&mut self, jog: Option<Jog>, station: &mut Station, now: Duration) {
        match (jog, self.held) {
            (Some(jog), Some((before, asked))) if jog.renews(&before) && now < asked + AGAIN => {}
            (Some(jog), _) => {
                self.held = Some((jog, now));
                station.send(Command::ByHand(ByHand::Jog(jog)), now);
            }
            (None, Some(_)) => {
                self.held = None;
                station.send(Command::ByHand(ByHand::LetGo), now);
            }
            (None, None) => {}
        }
    }
}
