//! A pair of boards for one test.

use crate::model::Model;
use emulator::{
    BoardAction, INSTRUCTIONS_PER_US, Options, PROGRAM_VARIABLES, SESSION_VARIABLE, Session, bound_to_parent,
};
use host_link::boards::{Boards, NetworkBoards, Timeouts};
use plant_file::{DEFAULT_MACHINE, PlantChoice};
use report::Report;
use shared::protocol::{MotionStatus, Request, Response, Role, TrackerStatus};
use shared::state::{State, TrackerState};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use system_tests::{MACHINE, PROGRAM, SEAM, shipped};
use world::emulated;

/// The boards' time per wall time that a job may take; what it does take is what the host has processors for.
const AT_MOST: f64 = 4.0;

/// Boards that run, with a folder of their own.
pub struct Pair {
    boards: Running,
    folder: PathBuf,
}

enum Running {
    Emulated(emulator::Boards),
    Model(Model),
}

impl Pair {
    /// Boots boards that run in real time; `name` is that of their folder.
    pub fn boot(name: &str) -> Self {
        Self::boot_as(name, DEFAULT_MACHINE)
    }

    /// The same, wired to `machine`.
    pub fn boot_as(name: &str, machine: &str) -> Self {
        Self::boot_at(name, machine, &PlantChoice::Shipped, 1.0)
    }

    /// Boots boards that are wired to `machine`, for jobs that nothing from outside disturbs: they may run faster than real time,
    /// as they wait for the job, which handles all that they say.
    pub fn for_jobs(name: &str, machine: &str) -> Self {
        Self::for_jobs_on(&PlantChoice::Shipped, name, machine)
    }

    /// The same, where `plant` is true of the machine.
    pub fn for_jobs_on(plant: &PlantChoice, name: &str, machine: &str) -> Self {
        Self::boot_at(name, machine, plant, AT_MOST)
    }

    fn boot_at(name: &str, machine: &str, plant: &PlantChoice, rate: f64) -> Self {
        if Model::is_wanted() {
            let told = plant.to_string();
            let arguments = match plant {
                PlantChoice::Shipped => &[][..],
                _ => &["--plant", &told],
            };
            return Self::of_model(name, |folder| Model::boot(folder, machine, arguments));
        }
        let folder = scratch(name);
        let mut options = Options::from_environment(folder.clone()).expect("what to boot");
        options.machine = machine.to_owned();
        options.plant = plant.clone();
        options.rate = rate;
        let boards = emulator::Boards::boot(&options).unwrap_or_else(|error| panic!("{error}"));
        boards
            .session()
            .write(&folder.join("session.toml"))
            .expect("the scratch folder is writable");
        let boards = Running::Emulated(boards);
        Self { boards, folder }
    }

    /// Has the model boot boards.
    pub fn of_model(name: &str, boot: impl FnOnce(&Path) -> Model) -> Self {
        let folder = scratch(name);
        let boards = Running::Model(boot(&folder));
        Self { boards, folder }
    }

    pub fn session(&self) -> &Session {
        match &self.boards {
            Running::Emulated(boards) => boards.session(),
            Running::Model(model) => &model.session,
        }
    }

    /// What acts on emulated boards from outside.
    pub fn emulated(&mut self) -> &mut emulator::Boards {
        match &mut self.boards {
            Running::Emulated(boards) => boards,
            Running::Model(_) => panic!("the model has no monitor"),
        }
    }

    /// Checks that both boards run.
    #[track_caller]
    pub fn check(&mut self) {
        match &mut self.boards {
            Running::Emulated(boards) => boards.check().unwrap_or_else(|error| panic!("{error}")),
            Running::Model(model) => model.check(),
        }
    }

    pub fn connect(&self) -> NetworkBoards {
        self.connect_to(true)
    }

    /// A connection to a machine that has no tracker. An emulated board that would be one is frozen: it would cost the host as
    /// much as the other.
    pub fn connect_without_tracker(&self) -> NetworkBoards {
        self.act_on_idle_tracker(BoardAction::Freeze);
        self.connect_motion()
    }

    /// A connection to the motion board only.
    pub fn connect_motion(&self) -> NetworkBoards {
        self.connect_to(false)
    }

    fn connect_to(&self, tracked: bool) -> NetworkBoards {
        emulated::connect(self.session(), tracked, Timeouts::default())
            .unwrap_or_else(|error| panic!("{error}"))
    }

    /// `seamwright weld` with the shipped job on these boards. Its cameras see where the seam is: what is tried with it is not what
    /// pictures show, and they are most of its work.
    pub fn seamwright(&self, seam: Option<&Path>) -> Command {
        let mut command = self.program(["weld", "--camera", "geometric"]);
        command
            .arg("--machine")
            .arg(shipped(MACHINE))
            .arg("--seam")
            .arg(seam.map_or_else(|| shipped(SEAM), Path::to_owned))
            .arg("--report")
            .arg(self.report())
            .arg(shipped(PROGRAM));
        command
    }

    /// `seamwright` with these arguments, on these boards.
    pub fn program<const N: usize>(&self, arguments: [&str; N]) -> Command {
        let mut command = bound_to_parent(program(PROGRAM_VARIABLES[0]));
        command
            .args(arguments)
            .args(["--boards", "emulated"])
            .env(SESSION_VARIABLE, self.folder.join("session.toml"));
        command
    }

    /// Where seamwright leaves its report.
    pub fn report(&self) -> PathBuf {
        self.folder.join("report")
    }

    /// Checks that both boards run, free of faults, with their drives off.
    #[track_caller]
    pub fn assert_off(&mut self) -> (MotionStatus, TrackerStatus) {
        self.act_on_idle_tracker(BoardAction::GoOn);
        self.check();
        let (motion, tracker) = status(&mut self.connect());
        assert_eq!((motion.state, motion.fault), (State::Off, None));
        assert_eq!((tracker.state, tracker.fault), (TrackerState::Off, None));
        (motion, tracker)
    }

    fn act_on_idle_tracker(&self, action: BoardAction) {
        if let Running::Emulated(boards) = &self.boards {
            let acted = boards.act(Role::Tracker, action);
            acted.unwrap_or_else(|error| panic!("the tracker board: {error}"));
        }
    }
}

/// Most that a path tick may take on an emulated board: interpolation, kinematics and filter \[instructions\].
const PATH_TICK: u32 = 12_000;
/// The same of a turn of planning.
const PLANNING: u32 = 60_000;

/// Most of a millisecond that a board may be busy for \[%\], and the share of it in which an emulated one simulates a machine without
/// errors, which is in no figure of its load.
const BUSY: u32 = 75;
const SIMULATES: u32 = 7;

/// Checks that the motion board served every tick and every turn of planning in time: what it did in the worst millisecond leaves a
/// quarter of it and, on an emulated board, no path tick and no turn of planning took more than it may.
#[track_caller]
pub fn assert_served(report: &Report) {
    assert_eq!(report.lost_ticks.total(), 0);
    let load = report.load.expect("a processor");
    println!("path tick {}\nservo tick {}", load.path_tick, load.servo_tick);
    println!("planning {}, {} too late", load.planning, load.planning_missed);
    let servo_ticks = load.path_tick.period / load.servo_tick.period;
    let worst = load.path_tick.worst + load.planning.worst + servo_ticks * load.servo_tick.worst;
    let busy = if Model::is_wanted() {
        BUSY
    } else {
        BUSY - SIMULATES
    };
    assert!(100 * worst <= busy * load.path_tick.period, "{load:?}");
    assert_eq!(load.planning_missed, 0, "{load:?}");
    if !Model::is_wanted() {
        assert_eq!(load.cycles_per_us, INSTRUCTIONS_PER_US);
        assert!(load.path_tick.worst <= PATH_TICK, "{load:?}");
        assert!(load.planning.worst <= PLANNING, "{load:?}");
    }
}

/// What both boards say of themselves.
pub fn status(boards: &mut NetworkBoards) -> (MotionStatus, TrackerStatus) {
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
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A program that the runner of these tests has built.
pub fn program(variable: &str) -> PathBuf {
    env::var_os(variable)
        .map(PathBuf::from)
        .unwrap_or_else(|| panic!("{variable} is not set; run these tests by `cargo xtask test`"))
}
