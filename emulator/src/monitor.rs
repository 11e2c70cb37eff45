//! What can be done to a board from outside, through the emulator's monitor.
//!
//! It is the one for people: for its monitor for programs (QMP) QEMU keeps a thread of its own, which wakes at every tick
//! of the board.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// The emulator answers at once, or not at all.
const PATIENCE: Duration = Duration::from_secs(5);

/// Name of a board's network adapter.
pub(crate) const ADAPTER: &str = "net0";

/// An action on a board from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardAction {
    /// Pull its network cable.
    CableOut,
    /// Put it back.
    CableIn,
    /// Freeze it: its processor stands still, and its outputs stay as they are.
    Freeze,
    /// Let it continue.
    GoOn,
    /// Press its reset button.
    Reset,
}

impl BoardAction {
    fn command(self) -> String {
        match self {
            Self::CableOut => format!("set_link {ADAPTER} off"),
            Self::CableIn => format!("set_link {ADAPTER} on"),
            Self::Freeze => "stop".to_owned(),
            Self::GoOn => "cont".to_owned(),
            Self::Reset => "system_reset".to_owned(),
        }
    }
}

/// What the monitor says when it is ready for a command.
const PROMPT: &str = "\r\n(qemu) ";

/// Carries out `action` on the board whose monitor is the socket `name` in `directory`; returns when it is done.
pub(crate) fn act(directory: &Path, name: &str, action: BoardAction) -> io::Result<()> {
    // The address of a socket has room for 107 bytes, which a long path would not fit into.
    let directory = File::open(directory)?;
    let path = format!("/proc/self/fd/{}/{name}", directory.as_raw_fd());
    let mut socket = UnixStream::connect(path)?;
    socket.set_read_timeout(Some(PATIENCE))?;
    until_prompt(&mut socket)?;
    writeln!(socket, "{}", action.command())?;
    // It repeats the command in the first line, and says nothing more unless something is wrong.
    match until_prompt(&mut socket)?.split_once("\r\n") {
        Some((_, wrong)) => Err(io::Error::other(wrong.to_owned())),
        None => Ok(()),
    }
}

/// What the monitor says before it is ready for the next command.
fn until_prompt(monitor: &mut impl Read) -> io::Result<String> {
    let mut said = Vec::new();
    let mut buffer = [0; 256];
    loop {
        let length = monitor.read(&mut buffer)?;
        if length == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        said.extend(&buffer[..length]);
        if let Some(before) = said.strip_suffix(PROMPT.as_bytes()) {
            return Ok(String::from_utf8_lossy(before).into_owned());
        }
    }
}
