//! Motions with the probe, and other motions in which it touches something.

use crate::JobError;
use crate::session::Session;
use crate::waits::newer;
use cam::path::{PlannedPath, Planner};
use host_link::boards::LinkError;
use host_link::events::Event;
use nc::{Probe, ProbeInput, Probed};
use shared::io::{AXES, Bits};
use shared::protocol::{Refusal, Request, Role};
use thiserror::Error;

/// What becomes of a motion with the probe that was not as the program has it. The machine stands.
#[derive(Debug, Error)]
pub enum ProbeError {
    /// The motion has not begun.
    #[error(
        "line {}: {}: before the motion begins the probe {} already: lead it elsewhere first, or look at its input",
        .0.place.line, .0.code, if .0.away { "touches nothing" } else { "touches" }
    )]
    Already(Probe),
    /// The motion has come to its end.
    #[error(
        "line {}: {}: at the end of the motion the probe {}: look at where the work is, or write {} if that may be",
        .0.place.line, .0.code,
        if .0.away { "touches still" } else { "has touched nothing" },
        if .0.away { "G38.5" } else { "G38.3" }
    )]
    Nothing(Probe),
    /// Another motion has run into something: that of this line, or a jog.
    #[error(
        "{}the probe touches in a motion that is none of G38, and the machine stops: look at what it touches, and lead it away",
        .0.map(|line| format!("line {line}: ")).unwrap_or_default()
    )]
    Hit(Option<u32>),
}

/// Has the board run `path`, to its end or until the probe says so.
pub(super) fn begin(session: &mut Session, path: &PlannedPath) -> Result<(), JobError> {
    let Some(probe) = path.probe else {
        return Ok(session.command(Role::Motion, &Request::Run)?);
    };
    let (input, on) = (probe.input, probe.on);
    let begun = session.command(Role::Motion, &Request::RunUntil { input, on });
    begun.map_err(|error| match error {
        LinkError::Refused {
            refusal: Refusal::InputAlready { .. },
            ..
        } => ProbeError::Already(probe).into(),
        error => error.into(),
    })
}

/// A probe that was free for so many samples, of a millisecond each, is no contact that still chatters.
const FREE: u32 = 20;

/// Looks for a probe that comes to touch in a motion that is not for that.
pub(super) struct Guard {
    probe: Option<ProbeInput>,
    /// The newest sample that was looked at.
    tick: u32,
    /// For how many samples it has been free.
    free: u32,
}

impl Guard {
    /// For a motion that begins now, by `probe` or not.
    pub fn new(session: &Session, by_probe: bool) -> Self {
        Self {
            probe: session.probe.filter(|_| !by_probe),
            tick: session.tick(),
            free: 0,
        }
    }

    /// Looks at what the motion board has told since.
    pub fn watch(&mut self, session: &Session) -> Result<(), ProbeError> {
        let Some(ProbeInput { input, touching }) = self.probe else {
            return Ok(());
        };
        for sample in newer(session.record.motion(), self.tick) {
            self.tick = sample.tick;
            if Bits(sample.inputs).get(input.into()) != touching {
                self.free += 1;
            } else if std::mem::take(&mut self.free) >= FREE {
                let line = session.motion.line;
                return Err(ProbeError::Hit((line > 0).then_some(line)));
            }
        }
        Ok(())
    }
}

/// What the last motion, that of `probe`, has found, which the operator is told.
pub(super) fn found(session: &mut Session, planner: &Planner, probe: &Probe) -> Result<Probed, ProbeError> {
    let tip = |axes: &[f64; AXES]| {
        let tip = planner.tip(axes);
        let [x, y, z] = tip.position_mm;
        let [a, b, c] = tip.angles_deg;
        [x, y, z, a, b, c]
    };
    let met = session.motion.met.as_ref().map(tip);
    let stands = tip(&session.motion.reference);
    let (line, code) = (probe.place.line, probe.code);
    let text = match met {
        None if probe.must => return Err(ProbeError::Nothing(*probe)),
        None => format!("line {line}: {code}: the probe has met nothing"),
        Some([x, y, z, ..]) => {
            let what = if probe.away { "came free" } else { "touched" };
            format!(
                "line {line}: {code}: the probe {what} with the tip at X{x:.3} Y{y:.3} Z{z:.3} of the machine"
            )
        }
    };
    session.control.publish(Event::Message(text));
    Ok(Probed { met, stands })
}
