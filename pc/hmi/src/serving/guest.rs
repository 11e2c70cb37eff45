//! A connection, from its request to its end. What a viewer sends ends it: there is nothing that it could ask for.

use super::VIEWERS;
use super::page::Page;
use super::publisher::{Closed, Seat, Viewers};
use super::request::{self, Request};
use super::token::Token;
use crate::sockets::is_wait;
use crate::viewing::wire::PATH;
use rustls::{ServerConfig, ServerConnection, StreamOwned};
use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

/// A request has to be whole within this.
const REQUEST: Duration = Duration::from_secs(5);
/// Longest wait for a request to go on.
const STEP: Duration = Duration::from_millis(100);
/// A viewer that takes nothing for so long is gone.
const STALLED: Duration = Duration::from_secs(5);
/// Longest wait for a message to send, before it is looked for one that came.
const TURN: Duration = Duration::from_millis(50);
/// Longest wait for what a viewer sends: that is looked at between messages.
const GLANCE: Duration = Duration::from_millis(1);
/// What waits in the system for a viewer \[bytes\]: less than a second.
const BUFFER: usize = 128 << 10;
/// Largest message of a viewer that is read to be refused \[bytes\].
const LARGEST: usize = 4096;
/// Why a viewer is sent away.
const ONLY_WATCHES: &str = "viewers only watch: this screen takes no message from them";

/// What a browser is told that asks for a page where there is none.
const NO_PAGE: [&str; 2] = [
    "Content-Type: text/plain; charset=utf-8\r\nCache-Control: no-store\r\n",
    "This screen has no page for browsers: `cargo xtask browser` makes it, and --browser DIR or a folder `browser` beside \
     seamwright-hmi says where it is. seamwright-hmi --watch watches without it.\n",
];

type Stream = StreamOwned<ServerConnection, TcpStream>;

/// What a connection needs to be let in.
#[derive(Debug)]
pub(super) struct Door {
    pub tls: Arc<ServerConfig>,
    pub token: Token,
    pub page: Option<Page>,
    pub viewers: Viewers,
}

impl Door {
    /// Serves `socket` until its end. What goes wrong with it ends it, and nothing else.
    pub fn let_in(&self, socket: TcpStream) {
        // Its errors are those of its end.
        let _ = self.serve(socket);
    }

    fn serve(&self, socket: TcpStream) -> std::io::Result<()> {
        socket.set_nonblocking(false)?;
        socket.set_nodelay(true)?;
        socket.set_read_timeout(Some(STEP))?;
        socket.set_write_timeout(Some(STALLED))?;
        socket2::SockRef::from(&socket).set_send_buffer_size(BUFFER)?;
        let tls = ServerConnection::new(Arc::clone(&self.tls)).map_err(std::io::Error::other)?;
        let mut stream = StreamOwned::new(tls, socket);
        let Some(request) = request::read(&mut stream, &self.token, Instant::now() + REQUEST) else {
            return Ok(());
        };
        let accept_key = match &request {
            Request {
                is_allowed: false, ..
            } => {
                return answer(
                    &mut stream,
                    "401 Unauthorized",
                    "WWW-Authenticate: Bearer\r\n",
                    b"",
                );
            }
            Request {
                accept_key: Some(key),
                path,
                ..
            } if path == PATH => key,
            Request { path, .. } => return self.give(&mut stream, path),
        };
        let upgrade = "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n";
        write!(stream, "{upgrade}Sec-WebSocket-Accept: {accept_key}\r\n\r\n")?;
        stream.flush()?;
        stream.sock.set_read_timeout(Some(GLANCE))?;
        let config = WebSocketConfig::default()
            .max_message_size(Some(LARGEST))
            .max_frame_size(Some(LARGEST));
        let socket = WebSocket::from_partially_read(stream, request.rest, Role::Server, Some(config));
        self.show(socket);
        Ok(())
    }

    /// Gives the file of the page that is at `path`.
    fn give(&self, stream: &mut Stream, path: &str) -> std::io::Result<()> {
        match &self.page {
            Some(page) => match page.file(path) {
                Some((header, bytes)) => answer(stream, "200 OK", &header, bytes),
                None => answer(stream, "404 Not Found", "", b""),
            },
            None if path == "/" => answer(stream, "404 Not Found", NO_PAGE[0], NO_PAGE[1].as_bytes()),
            None => answer(stream, "404 Not Found", "", b""),
        }
    }

    fn show(&self, mut socket: WebSocket<Stream>) {
        let (code, reason) = match self.viewers.sit() {
            None => (
                CloseCode::Again,
                format!("{VIEWERS} viewers are watching already"),
            ),
            Some(seat) => match watch(&mut socket, &seat) {
                End::Gone => return,
                End::Sent => (CloseCode::Policy, ONLY_WATCHES.to_owned()),
                End::Closed => (CloseCode::Away, "this screen is served no more".to_owned()),
            },
        };
        close(&mut socket, code, reason);
    }
}

/// Why a viewer is served no more.
enum End {
    /// It has left, or takes nothing.
    Gone,
    /// It has sent something.
    Sent,
    /// Nobody is served.
    Closed,
}

fn watch(socket: &mut WebSocket<Stream>, seat: &Seat) -> End {
    loop {
        match seat.receive(TURN) {
            Ok(Some(message)) => {
                if socket.send(Message::Binary(message)).is_err() {
                    return End::Gone;
                }
            }
            Ok(None) => {}
            Err(Closed) => return End::Closed,
        }
        match socket.read() {
            // The library answers these.
            Ok(Message::Ping(_) | Message::Pong(_)) => {}
            Ok(Message::Close(_)) => return End::Gone,
            Ok(_) | Err(Error::Capacity(_)) => return End::Sent,
            Err(Error::Io(error)) if is_wait(&error) => {}
            Err(_) => return End::Gone,
        }
    }
}

/// Says why, and waits a moment for the answer, so that the reason is not lost with the connection.
fn close(socket: &mut WebSocket<Stream>, code: CloseCode, reason: String) {
    let frame = CloseFrame {
        code,
        reason: reason.into(),
    };
    if socket.close(Some(frame)).is_err() {
        return;
    }
    let end = Instant::now() + Duration::from_secs(1);
    while Instant::now() < end {
        match socket.read() {
            Ok(_) => {}
            Err(Error::Io(error)) if is_wait(&error) => {}
            Err(_) => return,
        }
    }
}

fn answer(stream: &mut Stream, status: &str, header: &str, content: &[u8]) -> std::io::Result<()> {
    write!(
        stream,
        "HTTP/1.1 {status}\r\n{header}Content-Length: {}\r\nConnection: close\r\n\r\n",
        content.len()
    )?;
    stream.write_all(content)?;
    stream.conn.send_close_notify();
    stream.flush()
}
