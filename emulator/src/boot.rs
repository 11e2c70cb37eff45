//! A pair of boards, from boot to end.

use crate::hello;
use crate::monitor::BoardAction;
use crate::qemu::{Board, PROGRAM, Setup};
use crate::session::{Endpoint, PathStatesTo, Session};
use plant_file::{DEFAULT_MACHINE, PlantChoice, PlantFileError};
use shared::protocol::{Role, SCHEMA_HASH};
use std::fs::{self, File, TryLockError};
use std::net::{Ipv4Addr, TcpListener, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use std::{env, io, thread};
use thiserror::Error;

/// Where a board's net ends and this host begins, as the board sees it.
const HOST_SEEN_BY_BOARD: Ipv4Addr = Ipv4Addr::new(10, 0, 2, 2);
/// The page the two pace plugins share.
const PEERS: &str = "peers";
/// What is true of the machine, in postcard; the boards read it by this name.
const PLANT: &str = "plant";
const PEERS_LENGTH: u64 = 4096;
/// Wall time for both boards to answer.
const PATIENCE: Duration = Duration::from_secs(30);
const BETWEEN_TRIES: Duration = Duration::from_millis(50);

/// What to boot.
#[derive(Clone, Debug)]
pub struct Options {
    /// Firmware of the motion board.
    pub motion: PathBuf,
    /// Firmware of the tracker board.
    pub tracker: PathBuf,
    /// The pace plugin, a shared library.
    pub plugin: PathBuf,
    /// Directory for the boards' logs; made if it is missing. One pair of boards at a time.
    pub log_directory: PathBuf,
    /// The boards' time per wall time; 1 is real time, less suits a loaded host.
    pub rate: f64,
    /// Name of the machine that the motion board is wired to, as kinematics are called in machine files.
    pub machine: String,
    /// What is true of that machine.
    pub plant: PlantChoice,
}

/// Environment variables that say what a test boots, in the order of [`Options`].
pub const BOOT_VARIABLES: [&str; 3] = ["SEAMWRIGHT_MOTION", "SEAMWRIGHT_TRACKER", "SEAMWRIGHT_PACE"];

/// Environment variables that name the programs a test runs: seamwright and xtask.
pub const PROGRAM_VARIABLES: [&str; 2] = ["SEAMWRIGHT_PROGRAM", "SEAMWRIGHT_XTASK"];

impl Options {
    /// What `cargo xtask test` has built, in real time, wired to the [`DEFAULT_MACHINE`]; an error names the variable that is not set.
    pub fn from_environment(log_directory: PathBuf) -> Result<Self, BootError> {
        let path = |variable| {
            env::var_os(variable)
                .map(PathBuf::from)
                .ok_or(BootError::NotTold { variable })
        };
        let [motion, tracker, plugin] = BOOT_VARIABLES;
        Ok(Self {
            motion: path(motion)?,
            tracker: path(tracker)?,
            plugin: path(plugin)?,
            log_directory,
            rate: 1.0,
            machine: DEFAULT_MACHINE.to_owned(),
            plant: PlantChoice::Shipped,
        })
    }
}

/// Why the boards do not run.
#[derive(Debug, Error)]
pub enum BootError {
    /// There is no such plant.
    #[error("the emulated boards cannot be wired to a machine: {0}")]
    Plant(#[from] PlantFileError),
    /// A file to boot from is not there.
    #[error("{what} {} cannot be read ({source}); build it first", path.display())]
    Missing {
        /// What it should be.
        what: &'static str,
        /// Where it was looked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// QEMU cannot be run.
    #[error("{program} cannot be started ({source}); install it: Debian package {package}")]
    NoProgram {
        /// The program.
        program: &'static str,
        /// The package that has it.
        package: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// The directory of the logs, or the network, cannot be used.
    #[error("the emulated boards cannot be set up in {}: {source}", directory.display())]
    Setup {
        /// Directory for the logs.
        directory: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The environment does not say what to boot.
    #[error("{variable} is not set; run these tests by `cargo xtask test`")]
    NotTold {
        /// The variable.
        variable: &'static str,
    },
    /// Other boards run with this directory.
    #[error("emulated boards that use {} are running already", directory.display())]
    InUse {
        /// Directory for the logs.
        directory: PathBuf,
    },
    /// A board's process has ended.
    #[error("the emulated {board} board has ended ({status}): {said}; its log is in {}", directory.display())]
    Ended {
        /// Which board.
        board: &'static str,
        /// Exit code 101 is a panic or a fault of the firmware.
        status: ExitStatus,
        /// What QEMU said.
        said: String,
        /// Directory of its log.
        directory: PathBuf,
    },
    /// A board runs, but does not answer.
    #[error("the emulated {board} board does not answer within {} s ({source}); its log is in {}", PATIENCE.as_secs(), directory.display())]
    Silent {
        /// Which board.
        board: &'static str,
        /// What the last try gave.
        source: io::Error,
        /// Directory of its log.
        directory: PathBuf,
    },
    /// Another firmware than this program belongs to.
    #[error(
        "the emulated {board} board runs another firmware ({found:?}, schema {schema:016x}); build all from one source"
    )]
    WrongFirmware {
        /// Which board it should be.
        board: &'static str,
        /// Which one it is.
        found: Role,
        /// Its schema hash.
        schema: u64,
    },
}

/// Two boards that run and answer; they are ended when this is dropped. The thread that boots them must live
/// as long as they shall.
pub struct Boards {
    motion: Board,
    tracker: Board,
    session: Session,
    directory: PathBuf,
    /// Locked as long as the boards use it.
    _page: Page,
}

/// The page the plugins share, locked against a second pair.
struct Page(File);

impl Drop for Page {
    fn drop(&mut self) {
        // Closing is not enough: a process that is just being started has a copy until it runs.
        let _ = self.0.unlock();
    }
}

impl Boards {
    /// Boots both boards and waits until both answer.
    pub fn boot(options: &Options) -> Result<Self, BootError> {
        let plant = options.plant.of(&options.machine)?;
        find_program(PROGRAM, "qemu-system-arm")?;
        find_program("setpriv", "util-linux")?;
        let motion = existing("the motion firmware", &options.motion)?;
        let tracker = existing("the tracker firmware", &options.tracker)?;
        let plugin = existing("the pace plugin", &options.plugin)?;
        let setup = |source| BootError::Setup {
            directory: options.log_directory.clone(),
            source,
        };
        fs::create_dir_all(&options.log_directory).map_err(setup)?;
        let directory = options.log_directory.canonicalize().map_err(setup)?;
        let session = free_ports(directory.join(PEERS), &options.machine, &options.plant).map_err(setup)?;
        let page = shared_page(&directory)?;
        fs::write(directory.join(PLANT), plant.encode()).map_err(setup)?;

        let start = |name, mac, slot, firmware, endpoint| {
            Board::start(&Setup {
                name,
                mac,
                slot,
                firmware,
                plugin: &plugin,
                rate: options.rate,
                directory: &directory,
                peers: PEERS,
                endpoint,
            })
            .map_err(setup)
        };
        let motion = start("motion", "52:54:00:12:34:51", 0, &motion, session.motion)?;
        let tracker = start("tracker", "52:54:00:12:34:52", 1, &tracker, session.tracker)?;
        let mut boards = Self {
            motion,
            tracker,
            session,
            directory,
            _page: page,
        };
        let deadline = Instant::now() + PATIENCE;
        boards.wait_for(Role::Motion, deadline)?;
        boards.wait_for(Role::Tracker, deadline)?;
        Ok(boards)
    }

    /// Where the boards are.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Whether both boards still run; the error says how one ended.
    pub fn check(&mut self) -> Result<(), BootError> {
        for board in [&mut self.motion, &mut self.tracker] {
            let ended = board.ended().map_err(|source| BootError::Setup {
                directory: self.directory.clone(),
                source,
            })?;
            if let Some(status) = ended {
                let said = board.said();
                let directory = self.directory.clone();
                return Err(BootError::Ended {
                    board: board.name,
                    status,
                    said,
                    directory,
                });
            }
        }
        Ok(())
    }

    /// Does something to a board from outside.
    pub fn act(&self, role: Role, action: BoardAction) -> io::Result<()> {
        match role {
            Role::Motion => self.motion.act(action),
            Role::Tracker => self.tracker.act(action),
        }
    }

    /// Cuts the power of a board for good.
    pub fn kill(&mut self, role: Role) -> io::Result<()> {
        match role {
            Role::Motion => self.motion.kill(),
            Role::Tracker => self.tracker.kill(),
        }
    }

    fn wait_for(&mut self, role: Role, deadline: Instant) -> Result<(), BootError> {
        let (board, endpoint) = match role {
            Role::Motion => (self.motion.name, self.session.motion),
            Role::Tracker => (self.tracker.name, self.session.tracker),
        };
        loop {
            self.check()?;
            match hello::ask(&endpoint) {
                Ok(who) if who.role == role && who.schema_hash == SCHEMA_HASH => return Ok(()),
                Ok(who) => {
                    return Err(BootError::WrongFirmware {
                        board,
                        found: who.role,
                        schema: who.schema_hash,
                    });
                }
                Err(source) if Instant::now() >= deadline => {
                    return Err(BootError::Silent {
                        board,
                        source,
                        directory: self.directory.clone(),
                    });
                }
                Err(_) => thread::sleep(BETWEEN_TRIES),
            }
        }
    }
}

/// An empty page for the two plugins.
fn shared_page(directory: &Path) -> Result<Page, BootError> {
    let setup = |source| BootError::Setup {
        directory: directory.to_owned(),
        source,
    };
    let page = File::options()
        .write(true)
        .create(true)
        .truncate(false)
        .open(directory.join(PEERS))
        .map_err(setup)?;
    match page.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(BootError::InUse {
                directory: directory.to_owned(),
            });
        }
        Err(TryLockError::Error(source)) => return Err(setup(source)),
    }
    page.set_len(0)
        .and_then(|()| page.set_len(PEERS_LENGTH))
        .map_err(setup)?;
    Ok(Page(page))
}

fn find_program(program: &'static str, package: &'static str) -> Result<(), BootError> {
    Command::new(program)
        .arg("--version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map(|_| ())
        .map_err(|source| BootError::NoProgram {
            program,
            package,
            source,
        })
}

fn existing(what: &'static str, path: &Path) -> Result<PathBuf, BootError> {
    path.canonicalize().map_err(|source| BootError::Missing {
        what,
        path: path.to_owned(),
        source,
    })
}

/// A session on four unused ports, found by taking all at once and giving them back.
fn free_ports(pace: PathBuf, machine: &str, plant: &PlantChoice) -> io::Result<Session> {
    let host = Ipv4Addr::LOCALHOST;
    let tcp = [TcpListener::bind((host, 0))?, TcpListener::bind((host, 0))?];
    let udp = [UdpSocket::bind((host, 0))?, UdpSocket::bind((host, 0))?];
    let endpoint = |i: usize| -> io::Result<Endpoint> {
        Ok(Endpoint {
            host,
            tcp: tcp[i].local_addr()?.port(),
            udp: udp[i].local_addr()?.port(),
        })
    };
    let (motion, tracker) = (endpoint(0)?, endpoint(1)?);
    Ok(Session {
        machine: machine.to_owned(),
        plant: plant.to_string(),
        pace,
        motion,
        tracker,
        path_states_to: PathStatesTo {
            host: HOST_SEEN_BY_BOARD,
            udp: tracker.udp,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_firmware_is_named() {
        let error = existing("the motion firmware", Path::new("no/such/firmware")).expect_err("is missing");
        let text = error.to_string();
        assert!(text.contains("the motion firmware no/such/firmware"), "{text}");
    }

    #[test]
    fn a_missing_program_is_named_with_its_package() {
        let error = find_program("seamwright-no-such-program", "qemu-system-arm").expect_err("is missing");
        let text = error.to_string();
        assert!(
            text.contains("seamwright-no-such-program") && text.contains("package qemu-system-arm"),
            "{text}"
        );
    }

    #[test]
    fn an_unknown_machine_is_named_with_those_there_are() {
        let error = PlantChoice::Shipped.of("lathe").expect_err("there is none");
        let text = BootError::from(error).to_string();
        assert!(
            text.contains("called lathe") && text.contains("dual-beam-gantry, "),
            "{text}"
        );
    }

    #[test]
    fn a_directory_serves_one_pair_at_a_time() {
        let directory = tempfile::tempdir().expect("the temporary directory is writable");
        let directory = directory.path();
        let page = shared_page(directory).expect("is free");
        assert_eq!(page.0.metadata().expect("is open").len(), PEERS_LENGTH);
        assert!(matches!(shared_page(directory), Err(BootError::InUse { .. })));
        drop(page);
        shared_page(directory).expect("is free again");
    }

    #[test]
    fn ports_differ_and_path_states_go_to_the_tracker() {
        let session = free_ports(PathBuf::new(), DEFAULT_MACHINE, &PlantChoice::Shipped)
            .expect("the loopback has ports");
        assert_ne!(session.motion.tcp, session.tracker.tcp);
        assert_ne!(session.motion.udp, session.tracker.udp);
        assert_eq!(session.path_states_to.udp, session.tracker.udp);
    }
}
