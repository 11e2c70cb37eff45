//! A viewer of the operator's screen in a browser: the pages of [`view`], told over the WebSocket of the screen that has served this.
#![cfg(target_arch = "wasm32")]

mod connection;
mod kept;
mod shown;

use connection::Connection;
use eframe::egui::{self, Ui, Visuals};
use eframe::{App, Frame, WebOptions, WebRunner};
use std::cell::RefCell;
use std::rc::Rc;
use view::screen::Viewer;
use view::viewing::wire::PATH;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};
use web_sys::{HtmlCanvasElement, UrlSearchParams};

thread_local! {
    /// What is shown; a page has one.
    static VIEWER: RefCell<Option<Rc<RefCell<Viewer>>>> = const { RefCell::new(None) };
}

/// Shows on `canvas` what the screen that has served this page shows.
///
/// # Errors
/// The browser has no WebGL, or no address of the page.
#[wasm_bindgen]
pub async fn show(canvas: HtmlCanvasElement) -> Result<(), JsValue> {
    let location = web_sys::window().ok_or("there is no window")?.location();
    let host = location.host()?;
    let token = UrlSearchParams::new_with_str(&location.search()?)?.get("token");
    let url = format!("wss://{host}{PATH}?token={}", token.unwrap_or_default());
    let connection = Box::new(Connection::open(url, host.clone()));
    let viewer = Rc::new(RefCell::new(Viewer::new(
        host,
        connection,
        kept::look(),
        kept::keep,
    )));
    VIEWER.set(Some(Rc::clone(&viewer)));
    let options = WebOptions {
        dithering: false,
        ..WebOptions::default()
    };
    let runner = WebRunner::new();
    let app = move |created: &eframe::CreationContext| -> Result<Box<dyn App>, _> {
        view::fonts::add_chinese(&created.egui_ctx);
        Ok(Box::new(Page(viewer)))
    };
    runner.start(canvas, options, Box::new(app)).await
}

/// What is shown, as JSON, for tests.
#[wasm_bindgen]
pub fn shown() -> Option<String> {
    VIEWER.with_borrow(|viewer| {
        let viewer = viewer.as_ref()?.try_borrow().ok()?;
        Some(shown::of(&viewer))
    })
}

/// The viewer, drawn on the page.
struct Page(Rc<RefCell<Viewer>>);

impl App for Page {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut Frame) {
        self.0.borrow_mut().logic(ctx, frame);
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut Frame) {
        self.0.borrow_mut().ui(ui, frame);
    }

    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        self.0.borrow().clear_color(visuals)
    }
}
