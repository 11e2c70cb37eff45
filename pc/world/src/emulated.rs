//! Boards that are emulated on this computer.

#[cfg(target_os = "linux")]
use emulator::Pace;
use emulator::Session;
#[cfg(target_os = "linux")]
use host_link::boards::Endpoint;
use host_link::boards::{LinkError, NetworkBoards, Timeouts};
use thiserror::Error;

/// Why emulated or simulated boards cannot be used.
#[derive(Debug, Error)]
pub enum BoardsError {
    /// They are there, and do not answer as they should.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// There is no such plant.
    #[error(transparent)]
    Plant(#[from] plant_file::PlantFileError),
    /// The emulated boards run another machine.
    #[error(
        "the emulated boards are wired to a {wired}, but the machine file describes a {wanted}; boot others with `cargo xtask emulate --machine FILE`"
    )]
    WrongMachine {
        /// What they run.
        wired: String,
        /// The kinematics of the machine file.
        wanted: &'static str,
    },
    /// The emulated boards run another plant.
    #[error(
        "the emulated boards are wired to a machine {wired}, not to {wanted}; boot others with `cargo xtask weld --plant …` or `cargo xtask emulate --plant …`"
    )]
    WrongPlant {
        /// What they run.
        wired: String,
        /// What was asked for.
        wanted: String,
    },
    /// No emulated boards on this computer.
    #[error(
        "no emulated boards are running: use `cargo xtask weld`, or `cargo xtask emulate` in another terminal"
    )]
    NoEmulator,
    /// The session file of the emulated boards cannot be used.
    #[error("the emulated boards cannot be found: {0}; start them with `cargo xtask emulate`")]
    BadSession(#[from] emulator::SessionError),
    /// This computer cannot run them.
    #[error("emulated boards need Linux; use --boards simulated, or the addresses of real boards")]
    NeedsLinux,
}

/// Connects to emulated boards, and takes part in their pace: they wait while this program has no processor. There are
/// always two; the tracker board is left alone unless it is `tracked`.
///
/// # Errors
/// As [`NetworkBoards::connect`], or [`BoardsError::BadSession`] if the boards' page cannot be opened.
#[cfg(target_os = "linux")]
pub fn connect(session: &Session, tracked: bool, patience: Timeouts) -> Result<NetworkBoards, BoardsError> {
    let target = session.path_states_to;
    let tracker = endpoint(session.tracker);
    let boards = NetworkBoards::connect(
        &endpoint(session.motion),
        tracked.then_some(&tracker),
        Some((target.host.octets(), target.udp)),
        patience,
    )?;
    let pace = Pace::join(&session.pace).map_err(|source| emulator::SessionError::File {
        path: session.pace.clone(),
        source,
    })?;
    // Where that fails they do not wait, which costs accuracy on a busy computer and nothing else.
    Ok(boards.paced_by(move || drop(pace.handled())))
}

/// Emulated boards are not available on this system.
///
/// # Errors
/// [`BoardsError::NeedsLinux`] always.
#[cfg(not(target_os = "linux"))]
pub fn connect(_: &Session, _: bool, _: Timeouts) -> Result<NetworkBoards, BoardsError> {
    Err(BoardsError::NeedsLinux)
}

#[cfg(target_os = "linux")]
fn endpoint(board: emulator::Endpoint) -> Endpoint {
    Endpoint {
        host: board.host.to_string(),
        request_port: board.tcp,
        datagram_port: board.udp,
    }
}
