//! A screen that watches another one: its pages without controls.

use super::theme::Theme;
use super::{BAR, FRAME, Page, RAIL, View, alarms, bar, bare, look, pages, plot, run, scroll};
use crate::look::Look;
use crate::texts::Text;
use crate::viewing::watched::{SILENCE, Watched};
use crate::viewing::{Connection, News};
use eframe::egui::{self, Align, Frame, Label, Layout, RichText, Ui, Vec2, Visuals};
use std::time::Duration;
use web_time::Instant;

/// Pages that make sense for who commands nothing.
const PAGES: [Page; 4] = [Page::Run, Page::Plot, Page::Alarms, Page::Settings];

/// A window that is smaller than this shows everything smaller \[points\].
const LEAST: Vec2 = Vec2::new(1000.0, 640.0);
/// By how much that changes at least.
const STEP: f32 = 0.01;

/// See the module.
pub struct Viewer {
    /// What is known of the screen that is watched.
    pub watched: Watched,
    /// How it looks.
    pub look: Look,
    /// The screen that is watched.
    address: String,
    connection: Box<dyn Connection>,
    /// Why there is no connection; none where there is one.
    lost: Option<Lost>,
    page: Page,
    run: run::Sight,
    plot: plot::PlotPage,
    keep: Box<Keep>,
    kept: Look,
    /// How much smaller everything is than the look says, so that it fits.
    fit: f32,
    began: Instant,
}

/// Keeps a look for the next time; or a sentence why not.
type Keep = dyn FnMut(&Look) -> Result<(), String>;

/// Why there is no connection.
enum Lost {
    NotYet,
    Why(String),
}

impl Viewer {
    /// A viewer of the screen at `address`, which `connection` tells of. A `look` that is changed is given to `keep`.
    pub fn new(
        address: String,
        connection: Box<dyn Connection>,
        look: Look,
        keep: impl FnMut(&Look) -> Result<(), String> + 'static,
    ) -> Self {
        Self {
            watched: Watched::default(),
            look: look.clone(),
            address,
            connection,
            lost: Some(Lost::NotYet),
            page: Page::default(),
            run: run::Sight::default(),
            plot: plot::PlotPage::default(),
            keep: Box::new(keep),
            kept: look,
            fit: 1.0,
            began: Instant::now(),
        }
    }

    /// Brings `page` in sight.
    pub fn open(&mut self, page: Page) {
        self.page = page;
    }

    /// Whether there is a connection.
    pub fn is_connected(&self) -> bool {
        self.lost.is_none()
    }

    /// The viewer's clock.
    pub fn now(&self) -> Duration {
        self.began.elapsed()
    }

    /// Takes what has come.
    pub fn turn(&mut self) {
        let now = self.now();
        for news in self.connection.news() {
            match news {
                News::Connected => {
                    self.watched.reconnected();
                    self.lost = None;
                }
                News::Message(message) => self.watched.take(*message, now),
                News::Lost(why) => self.lost = Some(Lost::Why(why)),
            }
        }
        self.plot.turn(&self.watched.live.signals);
    }

    fn show(&mut self, ui: &mut Ui) {
        let theme = Theme::of(&self.look);
        self.fit(ui);
        let fitted = Look {
            zoom: self.look.zoom * self.fit,
            ..self.look.clone()
        };
        let view = View {
            no_program: Text::NoProgramThere,
            ..View::of(ui, &fitted, &theme, self.now())
        };
        if let Some(page) = pages::by_key(ui, &PAGES) {
            self.open(page);
        }
        bare(egui::Panel::top("bar"))
            .exact_size(BAR)
            .show(ui, |ui| self.bar(ui, &view));
        bare(egui::Panel::left("pages"))
            .exact_size(RAIL)
            .resizable(false)
            .show(ui, |ui| {
                ui.add_space(8.0);
                let open = self.watched.live.journal.open_alarms().count();
                if let Some(page) = pages::rail(ui, &view, &PAGES, self.page, open) {
                    self.open(page);
                }
            });
        egui::CentralPanel::default()
            .frame(Frame::new().inner_margin(8))
            .show(ui, |ui| self.page(ui, &view));
        if !ui.input(|input| input.pointer.any_down()) && self.look != self.kept {
            self.kept = self.look.clone();
            if let Err(error) = (self.keep)(&self.look) {
                self.watched.live.journal.settings_unwritten(view.now, &error);
            }
        }
    }

    /// Has everything be as much smaller as the window asks for.
    fn fit(&mut self, ui: &Ui) {
        let window = ui.ctx().content_rect().size() * ui.ctx().zoom_factor();
        let fit = (window / LEAST).min_elem().min(1.0);
        if (fit - self.fit).abs() > STEP {
            self.fit = fit;
        }
    }

    fn page(&mut self, ui: &mut Ui, view: &View) {
        let live = &self.watched.live;
        match self.page {
            Page::Plot => self.plot.show(ui, view, &live.signals, None),
            Page::Alarms => {
                alarms::open(ui, view, &live.journal);
                alarms::history(ui, view, &live.journal, &[]);
            }
            Page::Settings => {
                scroll().show(ui, |ui| {
                    look::appearance(ui, view, &mut self.look);
                    ui.add_space(12.0);
                    let hint = view.words.with(Text::WatchingHint, &[&self.address]);
                    ui.add(Label::new(hint).wrap());
                    look::footer(ui, view, Text::WatchingKeys);
                });
            }
            // Nothing has come yet; the bar says why.
            _ if self.watched.age(view.now).is_none() => {}
            // A line that is tapped begins nothing.
            _ => {
                self.run.show(ui, view, &self.watched.seen());
            }
        }
    }

    /// That it only watches, then what is always in sight; in its place what is wrong with the connection, or how old all is.
    fn bar(&self, ui: &mut Ui, view: &View) {
        let layout = Layout::left_to_right(Align::Center);
        ui.with_layout(layout, |ui| {
            let watching = RichText::new(view.words.say(Text::Watching)).size(20.0).strong();
            let hint = view.words.with(Text::WatchingHint, &[&self.address]);
            Frame::new()
                .stroke((2.0, view.theme.doubt))
                .corner_radius(6)
                .inner_margin(10)
                .show(ui, |ui| ui.add(Label::new(watching).extend()))
                .response
                .on_hover_text(hint);
            let age = self.watched.age(view.now).filter(|age| *age > SILENCE);
            let seen = self.watched.seen();
            if self.watched.age(view.now).is_some() {
                bar::state(ui, view, &seen);
            }
            if let Some(wrong) = self.wrong(view, age) {
                let text = RichText::new(wrong).size(18.0).color(view.theme.bad);
                ui.add(Label::new(text).wrap());
            } else {
                bar::told(ui, view, &seen);
            }
        });
    }

    fn wrong(&self, view: &View, age: Option<Duration>) -> Option<String> {
        let words = view.words;
        let lost = self.lost.as_ref().map(|lost| match lost {
            Lost::NotYet => words.with(Text::Connecting, &[&self.address]),
            Lost::Why(why) => words.with(Text::NoConnection, &[why]),
        });
        let old = age.map(|age| words.with(Text::ShownIsOld, &[&format!("{:.1}", age.as_secs_f64())]));
        let told: Vec<String> = old.into_iter().chain(lost).collect();
        (!told.is_empty()).then(|| told.join(". "))
    }
}

impl eframe::App for Viewer {
    /// Also where the window is hidden.
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.turn();
        ctx.request_repaint_after(FRAME);
    }

    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }

    /// The ground of everything.
    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}
