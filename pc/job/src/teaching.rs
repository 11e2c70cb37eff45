//! Teaching a panel with the machine of a session, and planning what was taught.
//!
//! No board has an input for a ranging probe yet. In a simulated world the probe measures the true panel from where
//! the tool truly is; on a real machine there is nothing to teach with.

use crate::session::Session;
use crate::{CameraPictures, Job, JobError, SeenMarks, TaughtSeam, Weld};
use commission::CapturedMotion;
use config::RangeError;
use config::machine::MachineFile;
use config::probe::Reading;
use host_link::events::Phase;
use nc::{Options, Program, interpret};
use parts::{Panel, PartFile};
use shared::geometry::Pose;
use shared::io::AXES;
use shared::kinematics::Kinematics;
use shared::protocol::{MotionSample, Role};
use std::time::Duration;
use teach::{Look, ProbeMachine, TaughtPoint, TeachError, Teacher, TipPoint};
use thiserror::Error;

/// A ranging probe in the place of the tool.
pub trait RangingProbe {
    /// One reading with the tool at `tool`.
    fn read(&mut self, tool: &Pose) -> Reading;
}

/// Longest time for some readings.
const LOOK_LIMIT: Duration = Duration::from_secs(10);

/// What was taught, as far as it came.
#[derive(Clone, Debug, Default)]
pub struct Taught {
    /// The points.
    pub points: Vec<TaughtPoint>,
    /// The part with all of its points.
    pub part: Option<PartFile>,
    /// The program planned from them.
    pub program: Option<String>,
    /// Pictures to calibrate a camera from.
    pub pictures: CameraPictures,
    /// Marks of the beams, and what a camera saw of them.
    pub marks: Option<SeenMarks>,
    /// What a person should know of it, a sentence each.
    pub notes: Vec<String>,
    /// The seams of a rib.
    pub seam: Option<TaughtSeam>,
    /// Places to which the tip was led.
    pub led: Vec<TipPoint>,
    /// What was captured of motors that were excited, in the order of their excitations.
    pub captured: Vec<CapturedMotion>,
}

/// Why nothing can be taught. Reads as one sentence.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoTeaching {
    /// The part is of another kind, or taught before.
    #[error("the part has nothing to teach: only panels without the key taught are taught")]
    Part,
    /// No guide points.
    #[error("the panel has no guide points to teach")]
    GuidePoint,
    /// The machine has no probe.
    #[error("the machine file has no [probe]: the machine cannot teach")]
    Probe,
    /// Boards of a real machine.
    #[error(
        "the motion board has no input for a ranging probe yet: teach on emulated or simulated boards, or write the \
         points by other means"
    )]
    Input,
    /// Nothing to range.
    #[error("the panel has no table simulated_surface, so a simulated world has no surface to measure")]
    Surface,
    /// What is to be made of it cannot be, however it is taught.
    #[error("{0}")]
    Panel(String),
    /// A setting makes no sense.
    #[error(transparent)]
    Parameter(#[from] RangeError),
}

/// Whether `part` can be taught with `machine`, as far as that is known without boards.
///
/// Gives back what a person should know of it.
///
/// # Errors
/// [`NoTeaching`].
pub fn check_teaching(machine: &MachineFile, part: &PartFile) -> Result<Option<String>, NoTeaching> {
    let panel = part.untaught().ok_or(NoTeaching::Part)?;
    let unit = machine.probe.as_ref().ok_or(NoTeaching::Probe)?;
    if panel.guides().is_empty() {
        return Err(NoTeaching::GuidePoint);
    }
    unit.build()?;
    panel.teaching().check(unit)?;
    part.check_before_teaching(machine)
        .map_err(|error| NoTeaching::Panel(error.to_string()))
}

impl Weld {
    /// Teaches the panel of the job.
    pub(super) fn teach(&mut self, session: &mut Session, job: &Job) -> Result<PartFile, JobError> {
        let part = job.part.ok_or(NoTeaching::Part)?;
        check_teaching(job.machine, part)?;
        let panel = part.untaught().ok_or(NoTeaching::Part)?;
        let points = self.teach_panel(session, job, panel)?;
        let part = part.clone().taught(points);
        self.taught.part = Some(part.clone());
        Ok(part)
    }

    /// Plans the program of a part that has been taught.
    pub(super) fn plan_taught(&mut self, job: &Job, part: &PartFile) -> Result<Program, JobError> {
        let plan = part
            .plan(job.machine, &job.title())
            .map_err(|error| JobError::Plan(format!("{error:#}")))?;
        let program = read(&plan.program)?;
        self.taught.program = Some(plan.program);
        self.taught.notes = plan.notes;
        Ok(program)
    }

    fn teach_panel(
        &mut self,
        session: &mut Session,
        job: &Job,
        panel: &Panel,
    ) -> Result<Vec<TaughtPoint>, JobError> {
        let identity = session.boards.identity(Role::Motion);
        if !identity.is_some_and(|identity| identity.simulated_machine) {
            return Err(NoTeaching::Input.into());
        }
        let unit = job.machine.probe.as_ref().ok_or(NoTeaching::Probe)?;
        let probe = job
            .part
            .and_then(|part| job.surroundings.probe(job.machine, part))
            .ok_or(NoTeaching::Surface)?;
        let kinematics: Kinematics = self.planner.kinematics().clone();
        let teacher = Teacher::build(job.machine, &kinematics, unit, panel.teaching());
        let teacher = teacher.map_err(NoTeaching::Parameter)?;
        let guides = panel.guides();
        let mut arm = BoardArm {
            weld: self,
            session,
            probe,
            settle_ms: unit.settle_ms.ceil() as u32,
            count: guides.len(),
        };
        teacher.teach(&mut arm, &guides).map_err(|error| match error {
            // A place that the machine does not reach is one of the point.
            TeachError::Machine {
                number,
                source: JobError::Path(reason),
            } => JobError::Teach(format!("point {number}: {reason}")),
            TeachError::Machine { source, .. } => source,
            point @ TeachError::Point { .. } => JobError::Teach(point.to_string()),
        })
    }
}

/// Reads a program that was written here.
fn read(text: &str) -> Result<Program, JobError> {
    interpret(text, Options::default()).map_err(|error| JobError::Plan(error.to_string()))
}

/// The machine of a session, with a simulated probe.
struct BoardArm<'w, 's, 'b> {
    weld: &'w mut Weld,
    session: &'s mut Session<'b>,
    probe: Box<dyn RangingProbe>,
    settle_ms: u32,
    /// Points to teach.
    count: usize,
}

impl ProbeMachine for BoardArm<'_, '_, '_> {
    type Error = JobError;

    fn run(&mut self, program: &str, slower: f64) -> Result<(), JobError> {
        let program = read(program)?;
        let from = self.session.motion.reference;
        let number = self.weld.taught.points.len() + 1;
        let phase = Phase::TeachingPoint {
            number,
            of: self.count,
        };
        if slower > 1.0 {
            // A motion that has to be exact from its beginning begins when all axes have settled.
            self.session.dwell(1e-3 * f64::from(self.settle_ms))?;
        }
        for path in self.weld.planner.program(&program, &from, None)? {
            self.weld.path(self.session, path.slower(slower), phase)?;
        }
        Ok(())
    }

    fn look(&mut self, readings: usize) -> Result<Look, JobError> {
        // A path tick is a millisecond.
        let settled = self.session.tick() + self.settle_ms;
        let rest = |session: &Session| -> Vec<MotionSample> {
            let newest = session.record.motion().iter().rev();
            newest
                .take_while(|sample| sample.tick > settled)
                .copied()
                .collect()
        };
        let wanted = readings.max(1);
        self.session
            .wait_until("a look at the surface", LOOK_LIMIT, |session| {
                Ok(rest(session).len() >= wanted)
            })?;
        let samples = rest(self.session);
        let mut axes = [0.0; AXES];
        let mut seen = Vec::with_capacity(readings);
        let mut time_us = 0;
        // The oldest first.
        for sample in samples.iter().rev().take(wanted) {
            for (mean, axis) in axes.iter_mut().zip(sample.axes) {
                *mean += axis / wanted as f64;
            }
            time_us = sample.time_us;
            if let Some((position, _)) = self.session.record.machine_at(sample.time_us)
                && seen.len() < readings
            {
                seen.push(self.probe.read(&self.session.machine.pose(&position)));
            }
        }
        Ok(Look {
            time_us,
            axes,
            readings: seen,
        })
    }

    fn taught(&mut self, done: &[TaughtPoint]) {
        self.weld.taught.points = done.to_vec();
    }
}
