//! The WebSocket to the screen that is watched: opened again whenever it is lost. Nothing is ever sent on it.

use js_sys::{ArrayBuffer, Uint8Array};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::time::Duration;
use view::viewing::News;
use view::viewing::wire::Message;
use wasm_bindgen::closure::Closure;
use wasm_bindgen::prelude::{JsCast, JsValue};
use web_sys::{BinaryType, CloseEvent, MessageEvent, WebSocket};
use web_time::Instant;

/// Longest wait for a connection.
const CONNECTING: Duration = Duration::from_secs(5);
/// A connection on which nothing comes for so long is made again. That what is shown is old is said long before.
const LOST: Duration = Duration::from_secs(3);
/// Time between two tries.
const AGAIN: Duration = Duration::from_millis(500);
/// Messages that wait for the page to be drawn: 10 s of them. A page that is out of sight is not drawn; it is told everything anew when it
/// is seen again.
const WAITING: usize = 200;

/// See the module.
pub(super) struct Connection {
    url: String,
    /// The screen that is watched.
    address: String,
    socket: Option<Socket>,
    /// No try is made before.
    again: Instant,
}

impl Connection {
    /// To the screen at `address`, by `url`.
    pub fn open(url: String, address: String) -> Self {
        Self {
            url,
            address,
            socket: None,
            again: Instant::now(),
        }
    }

    /// Why `socket` is lost, if it is.
    fn lost(&self, socket: &Socket, now: Instant) -> Option<String> {
        let heard = socket.heard;
        let came = socket.came.borrow();
        match &came.closed {
            Some(reason) if !reason.is_empty() => Some(reason.clone()),
            // A browser does not tell why.
            Some(_) => Some(format!(
                "{} does not answer, or has another token now",
                self.address
            )),
            None if came.is_open && now - heard > LOST => Some("nothing comes any more".to_owned()),
            None if now - heard > CONNECTING => Some(format!("{} does not answer", self.address)),
            None => None,
        }
    }
}

impl view::viewing::Connection for Connection {
    fn news(&mut self) -> Vec<News> {
        let now = Instant::now();
        let Some(mut socket) = self.socket.take() else {
            if now >= self.again {
                match Socket::open(&self.url) {
                    Ok(socket) => self.socket = Some(socket),
                    Err(_) => {
                        return vec![News::Lost(format!(
                            "the browser does not connect to {}",
                            self.address
                        ))];
                    }
                }
            }
            return Vec::new();
        };
        let (mut news, mut wrong) = (Vec::new(), None);
        if socket.is_new() {
            news.push(News::Connected);
        }
        for bytes in socket.messages() {
            socket.heard = now;
            match Message::decode(&bytes) {
                Ok(message) => news.push(News::Message(Box::new(message))),
                Err(error) => wrong = Some(format!("a message was not understood: {error}")),
            }
        }
        if let Some(why) = wrong.or_else(|| self.lost(&socket, now)) {
            news.push(News::Lost(why));
            self.again = now + AGAIN;
        } else {
            self.socket = Some(socket);
        }
        news
    }
}

/// What has come on a socket.
#[derive(Default)]
struct Came {
    is_open: bool,
    /// That it is open has been told.
    is_told: bool,
    messages: VecDeque<Vec<u8>>,
    /// It is closed, for this reason.
    closed: Option<String>,
}

/// A WebSocket, closed when it is dropped.
struct Socket {
    socket: WebSocket,
    came: Rc<RefCell<Came>>,
    /// When something came last.
    heard: Instant,
    _opens: Closure<dyn FnMut()>,
    _tells: Closure<dyn FnMut(MessageEvent)>,
    _closes: Closure<dyn FnMut(CloseEvent)>,
}

impl Socket {
    fn open(url: &str) -> Result<Self, JsValue> {
        let socket = WebSocket::new(url)?;
        socket.set_binary_type(BinaryType::Arraybuffer);
        let came = Rc::<RefCell<Came>>::default();
        let opened = Rc::clone(&came);
        let opens = Closure::new(move || opened.borrow_mut().is_open = true);
        let (told, full) = (Rc::clone(&came), socket.clone());
        let tells = Closure::new(move |event: MessageEvent| {
            let Ok(buffer) = event.data().dyn_into::<ArrayBuffer>() else {
                return;
            };
            let mut came = told.borrow_mut();
            if came.messages.len() < WAITING {
                came.messages.push_back(Uint8Array::new(&buffer).to_vec());
            } else {
                came.messages.clear();
                came.closed = Some("this page was out of sight".to_owned());
                // It is closed already then.
                let _ = full.close();
            }
        });
        let closed = Rc::clone(&came);
        let closes = Closure::new(move |event: CloseEvent| {
            closed.borrow_mut().closed.get_or_insert_with(|| event.reason());
        });
        socket.set_onopen(Some(opens.as_ref().unchecked_ref()));
        socket.set_onmessage(Some(tells.as_ref().unchecked_ref()));
        socket.set_onclose(Some(closes.as_ref().unchecked_ref()));
        Ok(Self {
            socket,
            came,
            heard: Instant::now(),
            _opens: opens,
            _tells: tells,
            _closes: closes,
        })
    }

    /// Whether it is open, and that is not told yet.
    fn is_new(&self) -> bool {
        let mut came = self.came.borrow_mut();
        let is_new = came.is_open && !came.is_told;
        came.is_told |= is_new;
        is_new
    }

    /// What has come since it was asked last.
    fn messages(&self) -> VecDeque<Vec<u8>> {
        std::mem::take(&mut self.came.borrow_mut().messages)
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        self.socket.set_onopen(None);
        self.socket.set_onmessage(None);
        self.socket.set_onclose(None);
        // It is closed already then.
        let _ = self.socket.close();
    }
}
