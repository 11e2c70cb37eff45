//! Excites motors one after the other, and reads what was captured.

use crate::session::{Session, unexpected};
use crate::{Job, JobError, Weld};
use commission::CapturedMotion;
use host_link::events::Phase;
use shared::io::{MOTOR_AXIS, MOTOR_NAMES};
use shared::protocol::{CaptureSample, CaptureState, Excitation, ExcitationEnd, Request, Response, Role};
use std::time::Duration;

/// Between two looks at an excitation \[s\].
const LOOK_S: f64 = 0.1;
/// Longest excitation: ten periods before what is captured, and the way there and back.
const LONGEST: Duration = Duration::from_secs(40);

/// Which motors to excite, and how.
#[derive(Clone, Debug)]
pub struct ExcitationRun {
    /// In their order. A way leads to where there is more room.
    pub excitations: Vec<Excitation>,
}

impl Weld {
    /// Excites the motors of `run` where the machine stands; what was captured before an error is kept.
    pub(super) fn excite(
        &mut self,
        session: &mut Session,
        job: &Job,
        run: &ExcitationRun,
    ) -> Result<(), JobError> {
        let of = run.excitations.len();
        for (index, excitation) in run.excitations.iter().enumerate() {
            let motor = MOTOR_NAMES[usize::from(excitation.motor)];
            let number = index + 1;
            session.phase(Phase::Exciting { motor, number, of });
            let excitation = towards_room(session, job, excitation);
            session.command(Role::Motion, &Request::Excite(excitation))?;
            self.taught.captured.push(captured(session, excitation, motor)?);
        }
        Ok(())
    }
}

/// The same with its way to the side where its axis has more room.
fn towards_room(session: &Session, job: &Job, excitation: &Excitation) -> Excitation {
    let axis = MOTOR_AXIS[usize::from(excitation.motor)];
    let at = session.motion.reference[axis];
    let back = job.machine.motion.axes[axis]
        .as_ref()
        .is_some_and(|travel| travel.travel_max - at < at - travel.travel_min);
    let way = excitation.way.abs();
    Excitation {
        way: if back { -way } else { way },
        ..*excitation
    }
}

/// Waits for its end, and reads what was captured.
fn captured(
    session: &mut Session,
    excitation: Excitation,
    motor: &'static str,
) -> Result<CapturedMotion, JobError> {
    let mut looks = LONGEST.as_secs_f64() / LOOK_S;
    loop {
        session.dwell(LOOK_S)?;
        match read(session, 0)?.0 {
            CaptureState::Complete => break,
            CaptureState::Running => {}
            CaptureState::Ended(end) => return Err(JobError::Excitation { motor, end }),
            // Another program has begun one, or the board was reset.
            CaptureState::Empty => {
                let end = ExcitationEnd::DrivesOff;
                return Err(JobError::Excitation { motor, end });
            }
        }
        looks -= 1.0;
        if looks < 0.0 {
            let (what, seconds) = ("an excitation", LONGEST.as_secs());
            return Err(JobError::TooLong { what, seconds });
        }
    }
    let mut samples = Vec::new();
    loop {
        let (_, part) = read(session, samples.len() as u16)?;
        if part.is_empty() {
            return Ok(CapturedMotion { excitation, samples });
        }
        samples.extend(part);
    }
}

fn read(session: &mut Session, from: u16) -> Result<(CaptureState, Vec<CaptureSample>), JobError> {
    let role = Role::Motion;
    match session.request(role, &Request::ReadCapture { from })? {
        Response::Captured(part) => Ok((part.state, part.samples.to_vec())),
        other => Err(unexpected(role, &other).into()),
    }
}
