//! Messages out of a stream of bytes.

use super::waits;
use shared::protocol::Response;
use shared::protocol::framing::{self, FrameError, MAX_MESSAGE};
use std::io::{self, Read};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// The answers of one board.
pub(super) struct Frames {
    socket: TcpStream,
    /// The beginning of the next answer, with its length before it.
    buffer: [u8; MAX_MESSAGE + 2],
    filled: usize,
}

impl Frames {
    pub(super) fn new(socket: TcpStream) -> Self {
        Self {
            socket,
            buffer: [0; MAX_MESSAGE + 2],
            filled: 0,
        }
    }

    /// The next answer, if it comes within `wait`.
    pub(super) fn next(&mut self, wait: Duration) -> io::Result<Option<Result<Response, FrameError>>> {
        let end = Instant::now() + wait;
        loop {
            if self.filled >= 2 {
                let length = self.length();
                let Some(body) = self.buffer[2..].get(..length) else {
                    return Ok(Some(Err(FrameError::TooLong)));
                };
                if self.filled == length + 2 {
                    self.filled = 0;
                    return Ok(Some(framing::decode_message(body)));
                }
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            self.socket.set_read_timeout(Some(left))?;
            let upto = if self.filled < 2 { 2 } else { 2 + self.length() };
            match self.socket.read(&mut self.buffer[self.filled..upto]) {
                Ok(0) => {
                    return Err(io::Error::new(
                        io::ErrorKind::UnexpectedEof,
                        "the board closed the connection",
                    ));
                }
                Ok(read) => self.filled += read,
                Err(error) if waits(&error) => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn length(&self) -> usize {
        usize::from(u16::from_le_bytes([self.buffer[0], self.buffer[1]]))
    }
}
