//! The weld job: from two boards that are off to a report, and the machine at rest whatever happens.

mod progress;
mod session;
#[cfg(test)]
mod tests;

pub use progress::{Progress, Silent, Terminal};

use crate::boards::{Boards, LinkError};
use crate::evaluate::{Evaluation, evaluate};
use crate::machine::MachineFile;
use crate::nc::Program;
use crate::path::{PathError, PlannedPath, Planner};
use crate::report::{BoardsUsed, ByBoard, ByMotor, Measurements, Outcome, Report, Truth, WeldTicks};
use crate::seam::{Deviation, SeamError};
use crate::world::{Cameras, Machine, TrueSeam};
use session::{Session, on_path};
use shared::motion::{Fault, State};
use shared::parameter::ParameterError;
use shared::protocol::{LOAD_BATCH, Request, Role};
use shared::tracking::{TrackerFault, TrackerState};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use thiserror::Error;

/// Longest time for the search of all reference marks.
const HOMING_LIMIT: Duration = Duration::from_secs(240);
/// Longest time for the boards to relate their clocks.
const CLOCK_LIMIT: Duration = Duration::from_secs(30);
/// Longest time of a controlled stop.
const STOP_LIMIT: Duration = Duration::from_secs(10);
/// A path may take this much longer than planned.
const PATH_MARGIN: Duration = Duration::from_secs(10);
/// Time for the last telemetry to arrive.
const DRAIN: Duration = Duration::from_millis(100);
/// Standard deviations in the noise of the machine file.
const SIGMAS: f64 = 3.0;

/// What is to be done.
pub struct Job<'a> {
    /// The machine.
    pub machine: &'a MachineFile,
    /// The program.
    pub program: &'a Program,
    /// Speed of the weld in place of the programmed feed \[m/min\].
    pub speed_m_per_min: Option<f64>,
    /// How the true seams deviate.
    pub seam: Rc<Deviation>,
    /// Start of the cameras' noise.
    pub seed: u64,
    /// What the report calls everything.
    pub names: Names,
}

/// What the report calls everything.
#[derive(Clone, Debug)]
pub struct Names {
    /// The program.
    pub program: String,
    /// The machine file.
    pub machine: String,
    /// The seam file.
    pub seam: String,
    /// The choice of boards.
    pub boards: String,
}

/// A job after its end.
#[derive(Debug)]
pub struct Ended {
    /// Why it ended early.
    pub error: Option<JobError>,
    /// Whether the machine moved along a path, so that there is something to report.
    pub began: bool,
    /// The report.
    pub report: Report,
    /// What it rests on.
    pub evaluation: Evaluation,
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
    /// The operator stopped it.
    #[error("stopped by the operator; beams are off and the machine stands")]
    Interrupted,
    /// Something does not come to an end.
    #[error("{what} took longer than {seconds} s; look at the boards' logs")]
    TooLong {
        /// What.
        what: &'static str,
        /// How long it may take.
        seconds: u64,
    },
    /// A path cannot be run.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The seam cannot be followed.
    #[error(transparent)]
    Seam(#[from] SeamError),
    /// A machine parameter is out of range.
    #[error("a machine parameter is out of range: {0}")]
    Parameter(#[from] ParameterError),
}

/// Runs a job on boards that may be in any state. They are off afterwards, if they can be reached at all.
pub fn run(
    boards: &mut dyn Boards,
    job: &Job,
    interrupted: &AtomicBool,
    progress: &mut dyn Progress,
) -> Result<Ended, JobError> {
    let planner = Planner::build(job.machine)?;
    let unit = job.machine.tracking.as_ref().ok_or(SeamError::NoTracking)?;
    let machine = Machine::build(&job.machine.motion, &unit.board.head)?;
    let cameras = &unit.cameras;
    let cameras = Cameras::new(
        (cameras.processing_ms * 1e3) as u64,
        cameras.noise_3sigma_mm / SIGMAS,
        job.seed,
    );
    let mut session = Session::begin(boards, machine, cameras, interrupted, progress)?;
    let mut weld = Weld {
        planner,
        paths_begun: 0,
        speed_mm_s: None,
    };
    let mut error = weld.all(&mut session, job).err();
    if let Err(link) = switch_off(&mut session) {
        error.get_or_insert(link.into());
    }
    Ok(weld.end(&mut session, job, error))
}

/// State of a job.
struct Weld {
    planner: Planner,
    paths_begun: u32,
    speed_mm_s: Option<f64>,
}

impl Weld {
    fn all(&mut self, session: &mut Session, job: &Job) -> Result<(), JobError> {
        session.progress.phase("setting up the boards");
        set_up(session, job)?;
        session.progress.phase("searching reference marks");
        session.command(Role::Motion, &Request::Home)?;
        session.command(Role::Tracker, &Request::Home)?;
        session.refresh()?;
        session.wait_until("the search for reference marks", HOMING_LIMIT, |s| {
            let (motion, tracker) = (&s.motion, &s.tracker);
            motion.homed
                && motion.state == State::Idle
                && tracker.homed
                && tracker.state == TrackerState::Ready
        })?;
        session.progress.phase("relating the clocks");
        session.wait_until("relating the boards' clocks", CLOCK_LIMIT, |s| {
            s.tracker.clock_settled && s.tracker_ahead_us().is_some()
        })?;

        let from = session.motion.reference;
        let speed = job
            .speed_m_per_min
            .map(|speed| speed * shared::units::MM_S_PER_M_MIN);
        let paths = self.planner.program(job.program, &from, speed)?;
        for path in paths.iter().filter(|path| path.weld().is_some()) {
            job.seam.check(path, job.machine)?;
        }
        let mut elsewhere = "approaching";
        for path in &paths {
            let what = if path.weld().is_some() {
                elsewhere = "moving on";
                "running in"
            } else {
                elsewhere
            };
            self.path(session, job, path, what)?;
        }
        let from = session.motion.reference;
        for path in &self.planner.park(&from)? {
            self.path(session, job, path, "parking")?;
        }
        Ok(())
    }

    /// Loads and runs one path; the machine stands afterwards, on an error too.
    fn path(
        &mut self,
        session: &mut Session,
        job: &Job,
        path: &PlannedPath,
        what: &str,
    ) -> Result<(), JobError> {
        self.paths_begun += 1;
        let id = self.paths_begun;
        for role in [Role::Motion, Role::Tracker] {
            session.command(
                role,
                &Request::ClearPath {
                    id,
                    space: path.space,
                },
            )?;
            for knots in path.knots.chunks(LOAD_BATCH) {
                let knots = knots.iter().copied().collect();
                session.command(role, &Request::LoadKnots(knots))?;
            }
        }
        for event in &path.events {
            session.command(Role::Motion, &Request::LoadEvent(*event))?;
        }
        if let Some((start_s, _)) = path.weld() {
            let seam = TrueSeam::new(path.path(), start_s, job.seam.clone());
            session.seams.insert(id, seam);
            self.speed_mm_s.get_or_insert(path.limits.velocity);
        }
        session.progress.phase(what);
        let ran = Self::follow(session, path, id);
        if ran.is_err() {
            session.progress.phase("stopping");
            session.stop(STOP_LIMIT)?;
        }
        ran
    }

    fn follow(session: &mut Session, path: &PlannedPath, id: u32) -> Result<(), JobError> {
        let run = Request::Run {
            speed_mm_s: path.limits.velocity,
            acceleration_mm_s2: path.limits.acceleration,
            jerk_mm_s3: path.limits.jerk,
        };
        session.command(Role::Motion, &run)?;
        session.refresh()?;
        let length = path.length_mm();
        let limit = Duration::from_secs_f64(path.duration_s()) + PATH_MARGIN;
        let mut welding = false;
        session.wait_until("a path", limit, |s| {
            if let Some(here) = s.record.motion().last().filter(|here| here.path_id == id) {
                if here.beams.contains(&true) && !welding {
                    welding = true;
                    s.progress.phase("welding");
                }
                s.progress.travel(here.s_mm, length);
            }
            !on_path(s.motion.state)
        })
    }

    fn end(self, session: &mut Session, job: &Job, error: Option<JobError>) -> Ended {
        let ahead = session.tracker_ahead_us().unwrap_or(0);
        let evaluation = evaluate(&session.record, &session.machine, &session.seams, ahead);
        let outcome = match &error {
            None => Outcome::Finished,
            Some(JobError::Interrupted) => Outcome::Interrupted,
            Some(_) => Outcome::Failed,
        };
        let mut faults: Vec<String> = error.iter().map(ToString::to_string).collect();
        let told = [
            session.motion.fault.map(|fault| fault.to_string()),
            session.tracker.fault.map(|fault| fault.to_string()),
        ];
        for fault in told.into_iter().flatten() {
            if !faults.iter().any(|known| known.contains(&fault)) {
                faults.push(fault);
            }
        }
        let (motion, tracker) = session.record.missing();
        let name = |role| {
            let identity = session.boards.identity(role);
            format!("{} {}", identity.board, identity.firmware)
        };
        let simulated = |role| session.boards.identity(role).simulated_machine;
        let report = Report {
            outcome,
            program: job.names.program.clone(),
            machine: job.names.machine.clone(),
            seam: job.names.seam.clone(),
            boards: BoardsUsed {
                choice: job.names.boards.clone(),
                motion: name(Role::Motion),
                tracker: name(Role::Tracker),
            },
            truth: if simulated(Role::Motion) && simulated(Role::Tracker) {
                Truth::SimulatedMachine
            } else {
                Truth::GratingsAndEncoders
            },
            speed_m_per_min: self.speed_mm_s.unwrap_or(0.0) / shared::units::MM_S_PER_M_MIN,
            weld_length_mm: evaluation.weld_length_mm,
            max_deviation_mm: evaluation.max_deviation_mm.into(),
            rms_deviation_mm: evaluation.rms_deviation_mm.into(),
            max_contour_error_mm: evaluation.max_contour_error_mm,
            max_following_error: ByMotor::from_mm_rad(evaluation.max_following_error),
            max_gantry_skew_um: evaluation.max_skew_mm * 1e3,
            weld_ticks: WeldTicks {
                recorded: evaluation.weld_ticks,
                unknown: evaluation.unknown_ticks,
            },
            lost_ticks: session.lost_ticks(),
            telemetry_gaps: ByBoard { motion, tracker },
            measurements: Measurements {
                accepted: session.tracker.accepted,
                rejected: session.tracker.rejected,
                too_old: session.tracker.too_old,
                given_up: session.cameras.given_up(),
            },
            clock_residual_us: session.clock_residual_us,
            clock_difference_us: session.clock_difference_us,
            faults,
            duration_s: (session.boards.now() - session.began).as_secs_f64(),
        };
        Ended {
            error,
            began: self.paths_begun > 0,
            report,
            evaluation,
        }
    }
}

/// Brings the boards from any state to off, forgets old faults, and sends the machine's parameters.
fn set_up(session: &mut Session, job: &Job) -> Result<(), JobError> {
    for role in [Role::Motion, Role::Tracker] {
        session.command(role, &Request::Disable)?;
    }
    session.refresh()?;
    let reset = [
        (Role::Motion, session.motion.fault.is_some()),
        (Role::Tracker, session.tracker.fault.is_some()),
    ];
    for (role, faulty) in reset {
        if faulty {
            session.command(role, &Request::Reset)?;
        }
    }
    let (address, port) = session.boards.path_states_target();
    session.command(
        Role::Motion,
        &Request::ConfigureMotion(job.machine.motion.clone()),
    )?;
    let unit = job.machine.tracking.as_ref().ok_or(SeamError::NoTracking)?;
    session.command(Role::Tracker, &Request::ConfigureTracker(unit.board.clone()))?;
    session.command(Role::Motion, &Request::PathStatesTo { address, port })?;
    Ok(())
}

/// Takes the last telemetry and switches the drives of both boards off, of each even if the other one is lost.
fn switch_off(session: &mut Session) -> Result<(), LinkError> {
    let drained = drain(session);
    let motion = session.command(Role::Motion, &Request::Disable);
    let tracker = session.command(Role::Tracker, &Request::Disable);
    drained.and(motion).and(tracker)
}

fn drain(session: &mut Session) -> Result<(), LinkError> {
    let end = session.boards.now() + DRAIN;
    while session.boards.now() < end {
        session.turn()?;
    }
    session.refresh()
}
