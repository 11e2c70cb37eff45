//! A pair of boards on the model of the real one, for one test.

use emulator::{Session, bound_to_parent};
use host_link::boards::{Boards, NetworkBoards, Timeouts};
use report::Report;
use shared::protocol::{MotionStatus, Request, Response, Role, TrackerStatus};
use shared::state::{State, TrackerState};
use std::env;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Stdio};
use world::emulated;

/// Environment variables with the program, and with the folder of both images.
const PROGRAM: &str = "SEAMWRIGHT_VIRTUAL_NUCLEO";
const IMAGES: &str = "SEAMWRIGHT_NUCLEO_IMAGES";
/// How the line begins in which it tells where its boards are to be found.
const SESSION: &str = "session: ";
/// What embassy-stm32 does once, without harm (virtual-nucleo/README.md).
const KNOWN: &str = "IFCR of SPI3";

/// Boards that run, with a folder of their own.
pub struct Pair {
    child: Child,
    output: BufReader<ChildStdout>,
    pub session: Session,
}

impl Pair {
    /// Boots boards that are wired to `machine`; `name` is that of their folder.
    pub fn boot(name: &str, machine: &str) -> Self {
        Self::boot_with(name, machine, &[])
    }

    /// The same with other arguments.
    pub fn boot_with(name: &str, machine: &str, arguments: &[&str]) -> Self {
        let images = told(IMAGES);
        let image = |firmware: &str| images.join(format!("firmware-{firmware}-nucleo-h723zg"));
        let mut child = bound_to_parent(told(PROGRAM))
            .args([image("motion"), image("tracker")])
            .args(["--machine", machine, "--folder"])
            .arg(scratch(name))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("virtual-nucleo: {error}"));
        let mut output = BufReader::new(child.stdout.take().expect("is piped"));
        let mut line = String::new();
        output.read_line(&mut line).expect("its output");
        let file = line.trim_end().strip_prefix(SESSION);
        let file = file.unwrap_or_else(|| panic!("virtual-nucleo says {line:?}"));
        Self {
            child,
            output,
            session: Session::read(Path::new(file)).unwrap_or_else(|error| panic!("{error}")),
        }
    }

    pub fn connect(&self) -> NetworkBoards {
        self.connect_to(true)
    }

    /// A connection to a machine that has no tracker.
    pub fn connect_motion(&self) -> NetworkBoards {
        self.connect_to(false)
    }

    fn connect_to(&self, tracked: bool) -> NetworkBoards {
        emulated::connect(&self.session, tracked, Timeouts::default())
            .unwrap_or_else(|error| panic!("{error}"))
    }

    /// Checks that both boards are free of faults with their drives off, ends them, and checks that nothing was found.
    #[track_caller]
    pub fn assert_off(mut self) {
        let (motion, tracker) = status(&mut self.connect());
        assert_eq!((motion.state, motion.fault), (State::Off, None));
        assert_eq!((tracker.state, tracker.fault), (TrackerState::Off, None));
        self.end();
    }

    /// Ends the boards, and checks that nothing was found.
    #[track_caller]
    pub fn end(&mut self) {
        drop(self.child.stdin.take());
        let mut said = String::new();
        self.output.read_to_string(&mut said).expect("its output");
        self.child.wait().expect("it ends");
        println!("{said}");
        let mut boards = 0;
        for line in said.lines() {
            if line.ends_with(", 0 resets") {
                boards += 1;
            } else {
                assert!(line.contains(KNOWN), "{line}");
            }
        }
        assert_eq!(boards, 2, "{said}");
    }
}

/// Checks that every tick was served, and every turn of planning in time.
#[track_caller]
pub fn assert_served(report: &Report) {
    assert_eq!(report.lost_ticks.total(), 0);
    let load = report.load.expect("a processor");
    println!("path tick {}\nservo tick {}", load.path_tick, load.servo_tick);
    println!("planning {}, {} too late", load.planning, load.planning_missed);
    assert_eq!(load.planning_missed, 0, "{load:?}");
}

/// What both boards say of themselves.
fn status(boards: &mut NetworkBoards) -> (MotionStatus, TrackerStatus) {
    match (
        boards.request(Role::Motion, &Request::Status),
        boards.request(Role::Tracker, &Request::Status),
    ) {
        (Ok(Response::MotionStatus(motion)), Ok(Response::TrackerStatus(tracker))) => (motion, tracker),
        other => panic!("no status: {other:?}"),
    }
}

/// A folder or file of a test.
pub fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("virtual-nucleo")
        .join(name)
}

/// What the runner of these tests has built.
pub fn told(variable: &str) -> PathBuf {
    env::var_os(variable).map(PathBuf::from).unwrap_or_else(|| {
        panic!("{variable} is not set; run these tests by `cargo xtask test --boards virtual-nucleo`")
    })
}
