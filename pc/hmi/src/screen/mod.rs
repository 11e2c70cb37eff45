//! The pages, and what is always in sight around them.

mod access;
mod alarms;
mod bar;
mod commission;
mod jog;
mod keyboard;
mod levels;
mod parameters;
mod qr;
mod run;
mod set_up;
mod settings;
mod teach;
mod welds;
mod writing;

pub use ::view::look::Look;
pub use ::view::screen::Page;

use crate::access::Pins;
use crate::serving::Server;
use crate::settings::Settings;
use crate::station::{Action, Station};
use ::view::screen::theme::Theme;
use ::view::screen::{self as view, BAR, FRAME, RAIL, bare, nothing, pages, plot, scroll, title};
use eframe::egui::{self, Key, Modifiers, Ui, Visuals};
use host_link::Command;
use std::cell::Cell;
use std::ops::Deref;
use std::time::{Duration, Instant};

/// What a screen waits before it is drawn anew, where nothing happens.
const IDLE: Duration = Duration::from_millis(250);
/// The screen.
pub struct Screen {
    /// What it shows and commands.
    pub station: Station,
    /// How it looks.
    pub look: Look,
    page: Page,
    run: run::RunPage,
    /// What is jogged at, on the pages for that.
    panel: jog::Panel,
    set_up: set_up::SetUpPage,
    teach: teach::TeachPage,
    plot: plot::PlotPage,
    welds: welds::WeldsPage,
    parameters: parameters::ParametersPage,
    commission: commission::CommissionPage,
    /// Why a PIN was not taken away.
    refused: levels::Refused,
    /// A PIN is being typed, in the place of the page.
    pad: Option<access::Pad>,
    keyboard: keyboard::Keyboard,
    settings: Settings,
    /// What is in the settings, or could not be written there.
    kept: (Look, Option<Pins>),
    server: Option<Server>,
    clock: Box<dyn Fn() -> Duration>,
}

/// What every page is given.
struct View<'a> {
    view: view::View<'a>,
    /// A PIN is asked for.
    asks: Cell<Option<access::Purpose>>,
}

impl<'a> Deref for View<'a> {
    type Target = view::View<'a>;

    fn deref(&self) -> &Self::Target {
        &self.view
    }
}

impl Screen {
    /// A screen of `station`, with what is kept in `settings`.
    pub fn new(station: Station, settings: Settings) -> Self {
        let began = Instant::now();
        Self::by_clock(station, settings, move || began.elapsed())
    }

    /// The same, for which it is as late as `clock` says.
    pub fn by_clock(
        mut station: Station,
        mut settings: Settings,
        clock: impl Fn() -> Duration + 'static,
    ) -> Self {
        let look = settings.look.clone();
        let kept = (look.clone(), settings.access.pins().cloned());
        station.set_access(std::mem::take(&mut settings.access));
        if let Some(error) = &settings.unread {
            station.live.journal.settings_unread(clock(), error);
        }
        Self {
            station,
            look,
            page: Page::default(),
            run: run::RunPage::default(),
            panel: jog::Panel::default(),
            set_up: set_up::SetUpPage::default(),
            teach: teach::TeachPage::default(),
            plot: plot::PlotPage::default(),
            welds: welds::WeldsPage::default(),
            parameters: parameters::ParametersPage::default(),
            commission: commission::CommissionPage::default(),
            refused: None,
            pad: None,
            keyboard: keyboard::Keyboard::default(),
            settings,
            kept,
            server: None,
            clock: Box::new(clock),
        }
    }

    /// Has `server` show what this screen does.
    pub fn serve(&mut self, server: Server) {
        self.station.show_on(server.stage());
        self.server = Some(server);
    }

    /// Takes what has happened, and asks to be drawn again in time.
    fn turn(&mut self, ctx: &egui::Context) {
        self.station.turn(self.now());
        let now = self.now();
        self.panel.turn(&mut self.station, now);
        self.plot.turn(&self.station.live.signals);
        let live = self.station.is_running() || self.station.is_loading();
        ctx.request_repaint_after(if live { FRAME } else { IDLE });
    }

    /// Draws everything, and does what is asked for.
    fn show(&mut self, ui: &mut Ui) {
        let theme = Theme::of(&self.look);
        let view = View {
            view: view::View::of(ui, &self.look, &theme, self.now()),
            asks: Cell::new(None),
        };
        if ui.input(|input| input.pointer.any_down() || !input.keys_down.is_empty()) {
            self.station.touch(view.now);
        }
        self.keyboard.turn(ui.ctx());
        self.keys(ui, view.now);
        bare(egui::Panel::top("bar")).exact_size(BAR).show(ui, |ui| {
            bar::show(ui, &view, &mut self.station, self.look.left_handed);
        });
        bare(egui::Panel::left("pages"))
            .exact_size(RAIL)
            .resizable(false)
            .show(ui, |ui| {
                self.rail(ui, &view);
            });
        egui::CentralPanel::default()
            .frame(egui::Frame::new().inner_margin(8))
            .show(ui, |ui| match self.page {
                _ if self.pad.is_some() => self.type_pin(ui, &view),
                Page::Run => self.run.show(ui, &view, &mut self.station, self.look.left_handed),
                Page::SetUp => self.set_up.show(ui, &view, &mut self.station, &mut self.panel),
                Page::Teach => self.teach.show(ui, &view, &mut self.station, &mut self.panel),
                Page::Plot => {
                    let folder = Some(self.station.place.reports.as_path());
                    self.plot.show(ui, &view, &self.station.live.signals, folder);
                }
                Page::Welds => self.welds.show(ui, &view, &self.station.place.reports),
                Page::Parameters => {
                    self.parameters
                        .show(ui, &view, &mut self.station, self.look.left_handed);
                }
                Page::Commission => self.commission.show(ui, &view, &mut self.station),
                Page::Alarms => alarms::show(ui, &view, &mut self.station),
                Page::Settings => {
                    // Everything larger is higher than a panel.
                    scroll().show(ui, |ui| {
                        let (look, station) = (&mut self.look, &mut self.station);
                        let server = self.server.as_ref();
                        settings::show(ui, &view, look, station, &mut self.refused, server);
                    });
                }
            });
        if self.look.keys_on_screen {
            self.keyboard.show(ui.ctx(), &view);
        }
        if let Some(purpose) = view.asks.take() {
            self.panel.disarm();
            self.pad = Some(access::Pad::new(purpose));
        }
        // Not at every place that something is drawn through.
        if !ui.input(|input| input.pointer.any_down()) {
            self.keep(view.now);
        }
    }

    fn type_pin(&mut self, ui: &mut Ui, view: &View) {
        let pad = self.pad.as_mut();
        let is_done = scroll()
            .show(ui, |ui| {
                pad.is_some_and(|pad| pad.show(ui, view, &mut self.station))
            })
            .inner;
        if is_done {
            self.pad = None;
        }
    }

    /// Writes what has changed of the settings.
    fn keep(&mut self, now: Duration) {
        let pins = self.station.access().pins();
        if (&self.look, pins) == (&self.kept.0, self.kept.1.as_ref()) {
            return;
        }
        self.kept = (self.look.clone(), pins.cloned());
        if let Err(error) = self.settings.write(&self.look, pins) {
            let error = config::sentence(error.as_ref());
            self.station.live.journal.settings_unwritten(now, &error);
        }
    }

    /// Brings `page` in sight.
    pub fn open(&mut self, page: Page) {
        (self.page, self.pad) = (page, None);
        // Nothing is moved from a page that is not in sight.
        self.panel.disarm();
        match page {
            Page::Welds => self.welds.open(&self.station.place.reports),
            Page::Parameters => self.parameters.open(&self.station),
            Page::Commission => self.commission.open(&self.station),
            _ => {}
        }
    }

    /// The screen's clock.
    fn now(&self) -> Duration {
        (self.clock)()
    }

    fn rail(&mut self, ui: &mut Ui, view: &View) {
        ui.add_space(8.0);
        let open = self.station.live.journal.open_alarms().count();
        if let Some(page) = pages::rail(ui, view, &Page::ALL, self.page, open) {
            self.open(page);
        }
    }

    /// Keys that work on every page.
    fn keys(&mut self, ui: &mut Ui, now: Duration) {
        let pressed = |key| {
            ui.ctx()
                .input_mut(|input| input.consume_key(Modifiers::NONE, key))
        };
        let stop = self.station.may(Action::Stop, now);
        // Esc also closes what is open over a page, where nothing runs.
        if pressed(Key::F1) || (stop && pressed(Key::Escape)) {
            self.station.send(Command::Stop, now);
        }
        if pressed(Key::F2) && self.station.may(Action::Hold, now) {
            self.station.send(Command::Hold, now);
        }
        if let Some(page) = pages::by_key(ui, &Page::ALL) {
            self.open(page);
        }
    }
}

impl eframe::App for Screen {
    /// Also where the window is hidden.
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.turn(ctx);
    }

    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }

    /// The ground of everything.
    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}
