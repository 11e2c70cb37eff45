//! Jobs on boards: from drives off to the result, with the machine at rest at the end whatever happens.

mod answers;
mod by_hand;
mod calibrating;
mod cameras;
mod circle;
mod countdown;
mod delays;
mod exciting;
mod feed_override;
mod feeding;
mod following;
pub mod fresh_board;
mod images;
mod joint;
mod leading;
mod marking;
mod operator;
mod pivots;
mod planned;
mod positioning;
mod probing;
mod recentring;
mod rests;
mod run_in;
mod run_record;
mod seam_lesson;
mod seam_teaching;
mod session;
mod slides;
mod stopped;
mod surroundings;
mod teaching;
mod test_program;
mod tracking;
mod waits;

pub use calibrating::{CameraPictures, PictureRun};
pub use cameras::{Answer, CameraFigures, Moment, PictureSource, SeamCameras};
pub use circle::{CircularTest, NoCircle, NoTurn, Plane, PlannedCircle, SeenCircle};
pub use delays::{DelayFigures, Delays};
pub use exciting::ExcitationRun;
pub use images::{ImageCameras, Images, ImagesError, Sighting, SightingLog, WorkerError};
pub use joint::SeenSeam;
pub use leading::LedLesson;
pub use marking::{MarkRun, Marking, SeenMarks};
pub use pivots::{NoPivots, PivotTest, PlannedPivots};
pub use positioning::{NoTest, PlannedPositioning, PositioningTest, Rest};
pub use probing::ProbeError;
pub use rests::NotSeen;
pub use run_record::{ByBoard, Recentred, RunRecord, TrackingRecord};
pub use seam_lesson::{LessonOptions, SeamLesson, TaughtSeam};
pub use stopped::stopped;
pub use surroundings::{Surroundings, SurroundingsError};
pub use teaching::{NoTeaching, RangingProbe, Taught, check_teaching};

use answers::Answers;
use cam::path::{FromLineError, JogError, PathError, PlannedPath, Planner};
use config::machine::MachineFile;
use feeding::Feeding;
use following::follow;
use host_link::Control;
use host_link::boards::{Boards, LinkError};
use host_link::events::{Event, Next, Phase, STOPPED};
use host_link::spool::Spooling;
use nc::{InputEvent, NcError, Program, Wait};
use parts::PartFile;
use session::Session;
use shared::io::SIDES;
use shared::parameter::ParameterError;
use shared::protocol::{ExcitationEnd, LOAD_BATCH, Refusal, Request, Role};
use shared::state::{Fault, State, TrackerFault, TrackerState};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use thiserror::Error;
use tracking::Tracking;
use waits::check_attended;

/// Longest time for the search of all reference marks, where the machine file allows for no longer ways: then that many times what
/// these take at the speeds of the search, for the slow ones at the marks come besides.
const HOMING_LIMIT: Duration = Duration::from_secs(240);
const HOMING_TIMES: f64 = 1.25;
/// Longest time for the boards to relate their clocks.
const CLOCK_LIMIT: Duration = Duration::from_secs(30);
/// Longest time of a controlled stop.
const STOP_LIMIT: Duration = Duration::from_secs(10);
/// Time for the last telemetry to arrive.
const DRAIN: Duration = Duration::from_millis(100);

/// What is to be done.
pub struct Job<'a> {
    /// The machine.
    pub machine: &'a MachineFile,
    /// What to do between homing and parking.
    pub work: Work<'a>,
    /// The part that the run is judged by.
    pub part: Option<&'a PartFile>,
    /// Speed of the weld in place of the programmed feed \[m/min\].
    pub speed_m_per_min: Option<f64>,
    /// Line of the program to start at, in place of its beginning.
    pub from_line: Option<u32>,
    /// What is around the machine.
    pub surroundings: Arc<dyn Surroundings>,
    /// What the report calls everything.
    pub names: Names,
    /// Where what the boards told is kept, and what is computed of it.
    pub spooling: Spooling,
}

/// What to do between homing and parking.
#[derive(Clone, Copy, Debug)]
pub enum Work<'a> {
    /// To run a program.
    Program(&'a Program),
    /// To teach the part of the job, which is a panel.
    Teach,
    /// To teach it, and then to make it.
    TeachAndMake,
    /// To take pictures to calibrate a camera from.
    Pictures(&'a PictureRun<'a>),
    /// To burn marks, and to look back at them.
    Mark(&'a MarkRun<'a>),
    /// To teach both seams of a rib.
    TeachSeam(&'a SeamLesson),
    /// To teach places of the tip, to which the operator leads it.
    Lead(&'a LedLesson),
    /// To excite motors and capture what they do.
    Excite(&'a ExcitationRun),
    /// What the operator asks for by hand; the machine stays where it is then.
    ByHand,
}

impl Job<'_> {
    /// What the job is called.
    fn title(&self) -> String {
        let path = std::path::Path::new(&self.names.program);
        path.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    }
}

/// What the report calls everything.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// The program.
    pub program: String,
    /// The machine file.
    pub machine: String,
    /// The seam file.
    pub seam: Option<String>,
    /// The choice of boards.
    pub boards: String,
}

/// Why a job did not come to its end.
#[derive(Debug, Error)]
pub enum JobError {
    /// A board does not answer, or not as it should.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The motion board stopped.
    #[error("the motion board stopped: {0}")]
    Motion(Fault),
    /// The tracker board stopped, or wanted the beams off.
    #[error("the tracker board stopped the weld: {0}")]
    Tracker(TrackerFault),
    /// The boards had to do without this program.
    #[error(
        "this PC was stalled for {seconds:.1} s (paused, asleep or too busy), and the boards stop without it: {source}"
    )]
    Absent {
        /// For how long.
        seconds: f64,
        /// What the boards reported.
        source: Box<JobError>,
    },
    /// A camera gives no pictures, or none that can be measured.
    #[error(transparent)]
    Camera(#[from] ImagesError),
    /// The operator stopped it.
    #[error("{STOPPED}")]
    Interrupted,
    /// There is no operator who could start the next block or end a hold.
    #[error(
        "the machine waits for the operator, but there is no operator who could answer; run the job in a terminal, or without single block"
    )]
    NoOperator,
    /// A stop of the program that nobody ends.
    #[error(
        "{code} in line {line} stops the program until the operator continues it, and there is no operator who could: run \
         the job in a terminal"
    )]
    NobodyAtStop {
        /// The code.
        code: &'static str,
        /// Line of the program.
        line: u32,
    },
    /// An input that the program waits for did not come.
    #[error(
        "line {line}: M66 has waited for {within_s} s until input {number} ({name}) {event}, and it did not come; look at \
         what switches it, or wait longer (Q)"
    )]
    NoInput {
        /// What the machine file calls it.
        name: String,
        /// Its number, from 1.
        number: u8,
        /// What it had to do.
        event: InputEvent,
        /// How long it was waited for \[s\].
        within_s: f64,
        /// Line of the program.
        line: u32,
    },
    /// Something does not come to an end.
    #[error("{what} took longer than {seconds} s; look at the boards' logs")]
    TooLong {
        /// What.
        what: &'static str,
        /// How long it may take.
        seconds: u64,
    },
    /// A slide came to rest elsewhere, or moves too slowly.
    #[error(
        "slide {slide} is still {away_mm:.3} mm away from where it was sent; look at its drive and its dead band"
    )]
    SlideAway {
        /// The slide.
        slide: &'static str,
        /// How far it is off \[mm\].
        away_mm: f64,
    },
    /// The slides looked everywhere they may, and a seam is not there.
    #[error("{}", not_found(sides, *s_mm, reach_mm))]
    SeamNotFound {
        /// Those without a seam.
        sides: [bool; SIDES],
        /// Path length at which the machine stood \[mm\].
        s_mm: f64,
        /// How far to either side of the plan, and above and below it, it was looked for \[mm\].
        reach_mm: [f64; 2],
    },
    /// The machine should move, and does not.
    #[error(
        "the machine has stood still for {seconds} s in line {line}, {s_mm:.1} mm along the path, and nothing holds \
         it; look at the motion board's log"
    )]
    Standstill {
        /// Line of the program.
        line: u32,
        /// Path length \[mm\].
        s_mm: f64,
        /// For how long.
        seconds: u32,
    },
    /// A path cannot be run.
    #[error(transparent)]
    Path(#[from] PathError),
    /// A move that the operator asked for cannot be made; the machine has not moved.
    #[error("the machine does not go there: {0}")]
    Move(String),
    /// A jog that cannot be made; the machine has not moved.
    #[error(transparent)]
    Jog(#[from] JogError),
    /// A jog that was asked for too long ago to be begun now.
    #[error(
        "the jog was asked for {ms} ms ago, which is too long to begin it now; this PC is too busy: try again"
    )]
    Stale {
        /// How long ago \[ms\].
        ms: u128,
    },
    /// A motion with the probe was not as the program has it.
    #[error(transparent)]
    Probe(#[from] ProbeError),
    /// A program cannot be run with what the machine has answered.
    #[error("with what the machine has found, the program does not go on: {0}")]
    Answered(NcError),
    /// A block by hand that is none.
    #[error("the block is not carried out: {0}")]
    Block(String),
    /// The program cannot be started at a line.
    #[error(transparent)]
    FromLine(#[from] FromLineError),
    /// What is around the machine cannot be followed.
    #[error(transparent)]
    Surroundings(SurroundingsError),
    /// There is nothing to teach with.
    #[error(transparent)]
    NoTeaching(#[from] NoTeaching),
    /// A point cannot be taught.
    #[error("teaching ended: {0}")]
    Teach(String),
    /// What was taught cannot be made.
    #[error("the taught part cannot be made: {0}")]
    Plan(String),
    /// No pictures to calibrate a camera from.
    #[error("the camera is not calibrated: {0}")]
    Calibrate(String),
    /// A motor was not excited to the end.
    #[error("motor {motor} was not measured: {end}")]
    Excitation {
        /// The motor.
        motor: &'static str,
        /// Why.
        end: ExcitationEnd,
    },
    /// It ended, but its quality cannot be judged.
    #[error("the run cannot be judged: {0}")]
    Judge(String),
    /// A machine parameter is out of range.
    #[error("a machine parameter is out of range: {0}")]
    Parameter(#[from] ParameterError),
}

fn not_found(sides: &[bool; SIDES], s_mm: f64, [across, up]: &[f64; 2]) -> String {
    let side = match sides {
        [true, true] => "neither side",
        [true, false] => "side 1 not",
        [false, _] => "side 2 not",
    };
    format!(
        "{side} found its seam: it was looked for {across} mm to either side of the plan and {up} mm above and below it, \
         with the tip at s = {s_mm:.1} mm; check that there is a seam where the program has it, camera and lights, or \
         search farther (search_mm and search_height_mm of the machine file)"
    )
}

impl JobError {
    /// A move that was asked for and refused, or whose probe met nothing: the machine stands, and can be asked for something
    /// else.
    fn is_refused_move(&self) -> bool {
        match self {
            Self::Path(_)
            | Self::Probe(_)
            | Self::Answered(_)
            | Self::Teach(_)
            | Self::Move(_)
            | Self::Jog(_)
            | Self::Stale { .. }
            | Self::Block(_)
            | Self::Surroundings(_) => true,
            Self::Link(LinkError::Refused { refusal, .. }) => matches!(refusal, Refusal::BeyondTravel { .. }),
            _ => false,
        }
    }

    /// Why a job ended that ended with `self` first, and was brought to its end with `late`. The first error says why;
    /// an operator who ends a job is none, and has to know what went wrong then.
    fn then(self, late: Result<(), Self>) -> Self {
        match (self, late) {
            (Self::Interrupted, Err(late)) => late,
            (first, _) => first,
        }
    }
}

/// Runs a job on boards that may be in any state. They are off afterwards, if they can be reached at all.
pub fn run(boards: &mut dyn Boards, job: &Job, control: &mut Control) -> Result<RunRecord, JobError> {
    let planner = Planner::build(job.machine)?;
    let around = job.surroundings.as_ref();
    let spooling = Spooling {
        waits: boards.wait(),
        ..job.spooling.clone()
    };
    let mut session = Session::begin(boards, job.machine, around, spooling, control)?;
    session.probe = planner.probe();
    let mut weld = Weld {
        planner,
        paths: BTreeMap::new(),
        taught: Taught::default(),
    };
    let error = weld.all(&mut session, job).err();
    let switched_off = switch_off(&mut session, error.is_some());
    let error = match error {
        Some(error) => Some(error.then(switched_off)),
        None => switched_off.err(),
    };
    let end = Event::End {
        error: error.as_ref().map(ToString::to_string),
        duration: session.boards.now() - session.began,
    };
    session.control.publish(end);
    Ok(run_record::run_record(session, weld.paths, weld.taught, error))
}

/// State of a job.
struct Weld {
    planner: Planner,
    /// Paths begun, by the number that the boards know them by.
    paths: BTreeMap<u32, PlannedPath>,
    taught: Taught,
}

impl Weld {
    fn all(&mut self, session: &mut Session, job: &Job) -> Result<(), JobError> {
        make_ready(session, job)?;
        match job.work {
            Work::Program(program) => drop(self.program(session, job, program)?),
            Work::Pictures(run) => self.taught.pictures = self.take_pictures(session, job, run)?,
            Work::Mark(run) => self.taught.marks = Some(self.mark(session, job, run)?),
            Work::Teach => drop(self.teach(session, job)?),
            Work::TeachSeam(lesson) => self.teach_seam(session, job, lesson)?,
            Work::Lead(lesson) => self.lead(session, lesson)?,
            Work::ByHand => return self.by_hand(session, job),
            Work::Excite(run) => self.excite(session, job, run)?,
            Work::TeachAndMake => {
                let part = self.teach(session, job)?;
                let program = self.plan_taught(job, &part)?;
                drop(self.program(session, job, &program)?);
            }
        }
        session.wait_before(Next::Parking)?;
        for path in self.planner.park(&session.motion.reference)? {
            self.path(session, path, Phase::Parking)?;
        }
        Ok(())
    }

    /// Runs a program from where the axes stand; the program as it was with all that the machine has answered.
    fn program(&mut self, session: &mut Session, job: &Job, program: &Program) -> Result<Program, JobError> {
        let mut elsewhere = Phase::Approaching;
        let mut answers = Answers::new(program, session.motion.reference);
        let mut left = answers.plan(job, &self.planner)?;
        check_attended(session, &answers, left.as_slice())?;
        let mut begun = false;
        while let Some(path) = left.next() {
            // A stop of the program is one of single block, and what is read anew at a wait was asked for before it.
            let asked = |wait: &Wait| wait.is_for_operator() || answers.is_over(wait);
            let stops = path.waits_before.iter().any(asked);
            if std::mem::replace(&mut begun, true) && !stops {
                let next = match path.first_and_last_line().0 {
                    0 => Next::Approach,
                    line => Next::Line(line),
                };
                session.wait_before(next)?;
            }
            if self.wait_before(session, &path, &mut answers)? {
                left = answers.plan(job, &self.planner)?;
                check_attended(session, &answers, left.as_slice())?;
                continue;
            }
            let phase = if path.probe.is_some() {
                Phase::Probing
            } else if path.weld().is_some() {
                elsewhere = Phase::MovingOn;
                Phase::RunningIn
            } else {
                elsewhere
            };
            let probe = path.probe;
            self.path(session, path, phase)?;
            if let Some(probe) = probe {
                let found = probing::found(session, &self.planner, &probe)?;
                answers.probed(&probe, found)?;
                left = answers.plan(job, &self.planner)?;
                check_attended(session, &answers, left.as_slice())?;
            }
        }
        Ok(answers.program())
    }

    /// Loads and runs one path; the machine stands afterwards, on an error too.
    fn path(&mut self, session: &mut Session, path: PlannedPath, phase: Phase) -> Result<(), JobError> {
        self.run(session, path, phase, follow)
    }

    /// Loads a path and has it run by `follow`, which is told its number.
    fn run(
        &mut self,
        session: &mut Session,
        path: PlannedPath,
        phase: Phase,
        follow: impl FnOnce(&mut Session, Feeding, &PlannedPath, u32) -> Result<(), JobError>,
    ) -> Result<(), JobError> {
        let id = self.paths.len() as u32 + 1;
        let feeding = load(session, &path, id)?;
        if let Some(tracking) = &mut session.tracking {
            tracking.add_path(id, &path);
        }
        if path.dwell_before_s > 0.0 {
            session.phase(Phase::Dwelling);
            session.dwell(path.dwell_before_s)?;
        }
        session.fix_feed(path.fixed_feed)?;
        session.phase(phase);
        let ran = follow(session, feeding, &path, id);
        self.paths.insert(id, path);
        ran.map_err(|error| {
            session.phase(Phase::Stopping);
            error.then(session.stop(STOP_LIMIT))
        })
    }
}

/// Longest time for the search of all reference marks of `machine`: motors of one number of the sequence search together.
fn homing_limit(machine: &MachineFile) -> Duration {
    let mut seconds = BTreeMap::new();
    for motor in machine.motion.motors.iter().flatten() {
        let longest = seconds.entry(motor.home_sequence).or_insert(0.0);
        *longest = f64::max(*longest, motor.home.max_travel / motor.home.velocity.abs());
    }
    let longest = HOMING_TIMES * seconds.values().sum::<f64>();
    HOMING_LIMIT.max(Duration::try_from_secs_f64(longest).unwrap_or(Duration::MAX))
}

/// Brings boards and machine from any state to where paths can be run.
fn make_ready(session: &mut Session, job: &Job) -> Result<(), JobError> {
    session.phase(Phase::SettingUp);
    set_up(session, job)?;
    session.phase(Phase::Homing);
    session.command_all(&Request::Home)?;
    session.refresh()?;
    session.wait_until("the search for reference marks", homing_limit(job.machine), |s| {
        let tracking = s.tracking.as_ref().map(|tracking| &tracking.status);
        Ok(s.motion.homed
            && s.motion.state == State::Idle
            && tracking.is_none_or(|t| t.homed && t.state == TrackerState::Ready))
    })?;
    if session.tracking.is_some() {
        session.phase(Phase::RelatingClocks);
        session.wait_until("relating the boards' clocks", CLOCK_LIMIT, |s| {
            Ok(s.tracking.as_ref().is_none_or(Tracking::clocks_related))
        })?;
    }
    Ok(())
}

/// Begins a path on the boards: all knots for the tracker board, as many elements as the motion board has room for.
fn load<'a>(session: &mut Session, path: &'a PlannedPath, id: u32) -> Result<Feeding<'a>, JobError> {
    let space = path.space;
    if session.tracking.is_some() {
        session.command(Role::Tracker, &Request::ClearPath { id, space })?;
        for knots in path.knots.chunks(LOAD_BATCH) {
            let knots = knots.iter().copied().collect();
            session.command(Role::Tracker, &Request::LoadKnots(knots))?;
        }
    }
    let begin = Request::BeginPath {
        id,
        space,
        start_s_mm: path.start_s,
        limits: path.path_limits(),
    };
    session.command(Role::Motion, &begin)?;
    let mut feeding = Feeding::new(path, session.control.single_block());
    feeding.go_on(session)?;
    Ok(feeding)
}

/// Brings the boards from any state to off, forgets old faults, and sends the machine's parameters.
fn set_up(session: &mut Session, job: &Job) -> Result<(), JobError> {
    if session::on_path(session.motion.state) {
        // What the job before left moving comes to rest first: no search for marks begins while the axes coast.
        session.stop(STOP_LIMIT)?;
    }
    session.command_all(&Request::Disable)?;
    session.refresh()?;
    if session.motion.fault.is_some() {
        session.command(Role::Motion, &Request::Reset)?;
    }
    session.command(
        Role::Motion,
        &Request::ConfigureMotion(job.machine.motion.clone()),
    )?;
    for deviation in &job.machine.deviations {
        session.command(Role::Motion, &Request::Compensate(deviation.clone()))?;
    }
    // An override that an operator left behind is not one for this job.
    session.command(Role::Motion, &Request::Override { factor: 1.0 })?;
    if let (Some(tracking), Some(unit)) = (&session.tracking, &job.machine.tracking) {
        let role = Role::Tracker;
        if tracking.status.fault.is_some() {
            session.command(role, &Request::Reset)?;
        }
        session.command(role, &Request::ConfigureTracker(unit.board.clone()))?;
        let target = session.boards.path_states_target();
        let target = target.ok_or(LinkError::Absent { role })?;
        session.command(Role::Motion, &target)?;
    }
    Ok(())
}

/// Takes the last telemetry and switches the drives of all boards off, of each even if the other one is lost. A job that
/// ended `early` may have left the machine homing.
fn switch_off(session: &mut Session, early: bool) -> Result<(), JobError> {
    let stopped = if early {
        session.ask(&Request::Stop)
    } else {
        Ok(())
    };
    let drained = drain(session);
    let off = session.command_all(&Request::Disable);
    stopped
        .map_err(JobError::from)
        .and(drained)
        .and(off.map_err(JobError::from))
}

fn drain(session: &mut Session) -> Result<(), JobError> {
    let end = session.boards.now() + DRAIN;
    while session.boards.now() < end {
        session.turn()?;
    }
    Ok(session.refresh()?)
}
