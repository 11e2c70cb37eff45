//! Waits between two paths of a program: for the operator, and for inputs of the process.

use crate::countdown::Countdown;
use crate::session::Session;
use crate::{JobError, Weld};
use cam::path::PlannedPath;
use host_link::Command;
use host_link::events::{Phase, Question};
use nc::{InputEvent, Until, Wait};
use shared::io::Bits;
use shared::protocol::MotionSample;
use std::collections::VecDeque;

impl Weld {
    /// Waits for all that `path` has before it, one after the other.
    pub(super) fn wait_before(&self, session: &mut Session, path: &PlannedPath) -> Result<(), JobError> {
        for wait in &path.waits_before {
            match wait.until {
                Until::Continued | Until::ToolIn(_) => session.wait_for_operator(wait)?,
                Until::Input {
                    input,
                    event,
                    within_s,
                } => {
                    let name = self.planner.input_name(input).unwrap_or_default();
                    session.wait_for_input(wait, (input, name), event, within_s)?;
                }
            }
        }
        Ok(())
    }
}

/// A program that stops is not begun where nobody could continue it.
pub(super) fn check_attended(session: &Session, paths: &[PlannedPath]) -> Result<(), JobError> {
    let mut waits = paths.iter().flat_map(|path| &path.waits_before);
    match waits.find(|wait| wait.is_for_operator()) {
        Some(wait) if session.control.unattended() => Err(nobody(wait)),
        _ => Ok(()),
    }
}

fn nobody(wait: &Wait) -> JobError {
    JobError::NobodyAtStop {
        code: wait.code,
        line: wait.place.line,
    }
}

impl Session<'_> {
    /// Until the operator says to resume; what was said before is nothing.
    fn wait_for_operator(&mut self, wait: &Wait) -> Result<(), JobError> {
        while self.obey(false)?.is_some() {}
        let (line, text) = (wait.place.line, wait.text.clone());
        self.question(match wait.until {
            Until::ToolIn(tool) => Question::Tool { tool, line, text },
            Until::Continued | Until::Input { .. } => Question::Stop {
                code: wait.code.into(),
                line,
                text,
            },
        });
        self.go_on_until(|session| match session.obey(true) {
            Err(JobError::NoOperator) => Err(nobody(wait)),
            order => Ok(order? == Some(Command::Resume)),
        })
    }

    /// Until an input of that number, from 0, and name does what is waited for; too long is an error.
    fn wait_for_input(
        &mut self,
        wait: &Wait,
        (input, name): (u8, &str),
        event: InputEvent,
        within_s: f64,
    ) -> Result<(), JobError> {
        let line = wait.place.line;
        let number = input + 1;
        self.phase(Phase::WaitingForInput { number, line });
        self.refresh()?;
        let mut watch = InputWatch::new(self.tick(), input, event);
        let mut left = Countdown::new(self.tick(), (within_s * 1e3).ceil() as u64);
        self.go_on_until(|session| {
            session.obey(false)?;
            let came = watch.look(session.record.motion());
            if !came && left.is_over(session.tick()) {
                return Err(JobError::NoInput {
                    name: name.to_owned(),
                    number,
                    event,
                    within_s,
                    line,
                });
            }
            Ok(came)
        })
    }
}

/// Looks for what an input does in the samples of the motion board.
struct InputWatch {
    /// The newest sample that was looked at.
    tick: u32,
    input: usize,
    event: InputEvent,
    /// The input in it.
    was: Option<bool>,
}

/// Samples after path tick `tick`.
pub(super) fn newer(
    samples: &VecDeque<MotionSample>,
    tick: u32,
) -> impl Iterator<Item = &MotionSample> + use<'_> {
    // The count of ticks starts again after 49 days.
    let newer = |sample: &&MotionSample| (1..1 << 31).contains(&sample.tick.wrapping_sub(tick));
    let new = samples.iter().rev().take_while(newer).count();
    samples.range(samples.len() - new..)
}

impl InputWatch {
    /// In samples after path tick `tick`.
    fn new(tick: u32, input: u8, event: InputEvent) -> Self {
        Self {
            tick,
            input: input.into(),
            event,
            was: None,
        }
    }

    /// Whether it came in the samples that are new.
    fn look(&mut self, samples: &VecDeque<MotionSample>) -> bool {
        for sample in newer(samples, self.tick) {
            let is = Bits(sample.inputs).get(self.input);
            let was = self.was.replace(is).unwrap_or(is);
            self.tick = sample.tick;
            let came = match self.event {
                InputEvent::Rises => is && !was,
                InputEvent::Falls => !is && was,
                InputEvent::High => is,
                InputEvent::Low => !is,
            };
            if came {
                return true;
            }
        }
        false
    }
}
