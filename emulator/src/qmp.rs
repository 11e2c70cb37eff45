//! What can be done to a board from outside, through the emulator's control socket (QMP).

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
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
        let link =
            |up: bool| format!(r#"{{"execute":"set_link","arguments":{{"name":"{ADAPTER}","up":{up}}}}}"#);
        match self {
            Self::CableOut => link(false),
            Self::CableIn => link(true),
            Self::Freeze => r#"{"execute":"stop"}"#.to_owned(),
            Self::GoOn => r#"{"execute":"cont"}"#.to_owned(),
            Self::Reset => r#"{"execute":"system_reset"}"#.to_owned(),
        }
    }
}

/// Carries out `action` on the board whose control socket is `name` in `directory`; returns when it is done.
pub(crate) fn act(directory: &Path, name: &str, action: BoardAction) -> io::Result<()> {
    // The address of a socket has room for 107 bytes, which a long path would not fit into.
    let directory = File::open(directory)?;
    let path = format!("/proc/self/fd/{}/{name}", directory.as_raw_fd());
    let mut socket = UnixStream::connect(path)?;
    socket.set_read_timeout(Some(PATIENCE))?;
    let mut answers = BufReader::new(socket.try_clone()?).lines();
    for command in [r#"{"execute":"qmp_capabilities"}"#, &action.command()] {
        writeln!(socket, "{command}")?;
        // Greeting and events come in between.
        loop {
            let line = answers.next().ok_or(io::ErrorKind::UnexpectedEof)??;
            if line.starts_with(r#"{"return""#) {
                break;
            }
            if line.starts_with(r#"{"error""#) {
                return Err(io::Error::other(line));
            }
        }
    }
    Ok(())
}
