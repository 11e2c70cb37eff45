//! One board: a QEMU process.

use crate::monitor::{self, ADAPTER, BoardAction};
use crate::session::Endpoint;
use shared::protocol::{DATAGRAM_PORT, REQUEST_PORT};
use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};

/// The emulator program, found on the PATH.
pub const PROGRAM: &str = "qemu-system-arm";
/// A board's time per instruction is 2^SHIFT ns: 125 instructions a microsecond, about a quarter of what the real
/// part does at 550 MHz, of which the simulated machine takes its share.
const SHIFT: u32 = 3;
/// The same, as a board counts what its ticks take.
pub const INSTRUCTIONS_PER_US: u16 = 1000 >> SHIFT;
/// Address of a board in its own net; the two nets know nothing of each other.
const BOARD_ADDRESS: &str = "10.0.2.15";

/// A command that is killed when the thread that starts it ends, however it ends. It runs in a process group
/// of its own, so Ctrl-C reaches it only through its parent.
pub fn bound_to_parent(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new("setpriv");
    command
        .args(["--pdeathsig", "KILL", "--"])
        .arg(program)
        .process_group(0);
    command
}

/// What a board is started with.
pub struct Setup<'a> {
    pub name: &'static str,
    pub mac: &'static str,
    pub slot: u32,
    pub firmware: &'a Path,
    pub plugin: &'a Path,
    pub rate: f64,
    /// Directory for logs and the page the plugins share, both by relative names.
    pub directory: &'a Path,
    pub peers: &'a str,
    pub endpoint: Endpoint,
}

/// A board that runs, until dropped.
pub struct Board {
    pub name: &'static str,
    child: Child,
    console: PathBuf,
    directory: PathBuf,
}

impl Board {
    pub fn start(setup: &Setup) -> io::Result<Self> {
        let console = setup.directory.join(format!("{}.console", setup.name));
        let output = File::create(&console)?;
        let Endpoint { host, tcp, udp } = setup.endpoint;
        let child = bound_to_parent(PROGRAM)
            .args(["-machine", "mps2-an500", "-display", "none"])
            .arg("-kernel")
            .arg(setup.firmware)
            .args(["-icount", &format!("shift={SHIFT},sleep=on,align=off"), "-plugin"])
            .arg(format!(
                "{},shift={SHIFT},rate={},peers={},slot={}",
                setup.plugin.display().to_string().replace(',', ",,"),
                setup.rate,
                setup.peers,
                setup.slot
            ))
            .args(["-serial", &format!("file:{}.defmt", setup.name)])
            .arg("-semihosting-config")
            .arg(format!(
                "enable=on,target=native,arg={}",
                setup.name
            ))
            .arg("-nic")
            .arg(format!(
                "user,id={ADAPTER},model=lan9118,mac={},hostfwd=tcp:{host}:{tcp}-{BOARD_ADDRESS}:{REQUEST_PORT},\
                 hostfwd=udp:{host}:{udp}-{BOARD_ADDRESS}:{DATAGRAM_PORT}",
                setup.mac
            ))
            .args(["-monitor", &format!("unix:{}.monitor,server=on,wait=off", setup.name)])
            .current_dir(setup.directory)
            .stdin(Stdio::null())
            .stdout(output.try_clone()?)
            .stderr(output)
            .spawn()?;
        Ok(Self {
            name: setup.name,
            child,
            console,
            directory: setup.directory.to_owned(),
        })
    }

    /// Does something to the board from outside.
    pub fn act(&self, action: BoardAction) -> io::Result<()> {
        monitor::act(&self.directory, &format!("{}.monitor", self.name), action)
    }

    /// Cuts its power for good.
    pub fn kill(&mut self) -> io::Result<()> {
        self.child.kill()?;
        self.child.wait().map(drop)
    }

    /// How the process ended, if it did.
    pub fn ended(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }

    /// What QEMU said.
    pub fn said(&self) -> String {
        std::fs::read_to_string(&self.console)
            .unwrap_or_default()
            .trim()
            .to_owned()
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        // Errors mean it has ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
