//! Where the boards are: what a program on the PC needs to talk with them.

use serde::{Deserialize, Serialize};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::{fs, io};
use thiserror::Error;

/// Environment variable with the path of the session file.
pub const SESSION_VARIABLE: &str = "SEAMWRIGHT_EMULATOR";
/// Environment variable with the machine file that seamwright uses if none is given.
pub const MACHINE_VARIABLE: &str = "SEAMWRIGHT_MACHINE";
/// Environment variable with the job that seamwright uses if none is given.
pub const JOB_VARIABLE: &str = "SEAMWRIGHT_JOB";
/// Environment variable with the seam that seamwright uses if none is given.
pub const SEAM_VARIABLE: &str = "SEAMWRIGHT_SEAM";

/// Environment variable with the plant that seamwright uses if none is given, as `--plant` has it.
pub const PLANT_VARIABLE: &str = "SEAMWRIGHT_PLANT";

/// Where a board answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Endpoint {
    /// Address.
    pub host: Ipv4Addr,
    /// TCP port of the requests.
    pub tcp: u16,
    /// UDP port of the datagrams.
    pub udp: u16,
}

impl Endpoint {
    /// Where requests go.
    pub fn requests(&self) -> SocketAddr {
        SocketAddr::new(IpAddr::V4(self.host), self.tcp)
    }

    /// Where datagrams go.
    pub fn datagrams(&self) -> SocketAddr {
        SocketAddr::new(IpAddr::V4(self.host), self.udp)
    }
}

/// A running pair of emulated boards.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Session {
    /// The machine that the motion board is wired to, as kinematics are called in machine files.
    pub machine: String,
    /// What is true of that machine: as shipped, or as `--plant` says.
    pub plant: String,
    /// The page by which boards and PC keep together, see [`crate::Pace`].
    pub pace: PathBuf,
    /// The motion board, as the PC reaches it.
    pub motion: Endpoint,
    /// The tracker board, as the PC reaches it.
    pub tracker: Endpoint,
    /// The tracker board, as the motion board reaches it: where path states go.
    pub path_states_to: PathStatesTo,
}

/// An address as seen by a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathStatesTo {
    /// Address.
    pub host: Ipv4Addr,
    /// UDP port.
    pub udp: u16,
}

/// Why a session file cannot be used.
#[derive(Debug, Error)]
pub enum SessionError {
    /// It cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is no session file.
    #[error("{}: {source}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<toml::de::Error>,
    },
}

impl Session {
    /// Reads a session file.
    pub fn read(path: &Path) -> Result<Self, SessionError> {
        let text = fs::read_to_string(path).map_err(|source| SessionError::File {
            path: path.to_owned(),
            source,
        })?;
        toml::from_str(&text).map_err(|source| SessionError::Content {
            path: path.to_owned(),
            source: Box::new(source),
        })
    }

    /// Writes a session file.
    pub fn write(&self, path: &Path) -> Result<(), SessionError> {
        let text = toml::to_string(self).expect("addresses and ports are values of TOML");
        fs::write(path, text).map_err(|source| SessionError::File {
            path: path.to_owned(),
            source,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_file_is_read_as_it_was_written() {
        let text = "machine = \"pipe-welder\"\nplant = \"as shipped\"\npace = \"/run/peers\"\n\n[motion]\nhost = \"127.0.0.1\"\ntcp = 4001\nudp = 4002\n\n\
                    [tracker]\nhost = \"127.0.0.1\"\ntcp = 4003\nudp = 4004\n\n\
                    [path_states_to]\nhost = \"10.0.2.2\"\nudp = 4004\n";
        let session: Session = toml::from_str(text).expect("is a session");
        assert_eq!(session.tracker.requests().to_string(), "127.0.0.1:4003");
        assert_eq!(session.motion.datagrams().to_string(), "127.0.0.1:4002");
        assert_eq!(toml::to_string(&session).expect("can be written"), text);
    }
}
