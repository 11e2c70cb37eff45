//! Waits between two paths of a program: for the operator, and for inputs of the process.

use crate::answers::Answers;
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
    /// Waits for all that `path` has before it, one after the other; whether the program looks at what came, and the paths that are
    /// left are to be planned anew.
    pub(super) fn wait_before(
        &self,
        session: &mut Session,
        path: &PlannedPath,
        answers: &mut Answers,
    ) -> Result<bool, JobError> {
        for wait in &path.waits_before {
            if answers.is_over(wait) {
                continue;
            }
            let value = match wait.until {
                Until::Continued | Until::ToolIn(_) => {
                    session.wait_for_operator(wait)?;
                    answers.over(wait);
                    continue;
                }
                Until::Input {
                    input,
                    event,
                    within_s,
                } => {
                    let came = session.wait_for_input(wait, input, event, within_s)?;
                    if !came && !answers.looks_at(wait) {
                        return Err(JobError::NoInput {
                            name: self.planner.input_name(input).unwrap_or_default().to_owned(),
                            number: input + 1,
                            event,
                            within_s,
                            line: wait.place.line,
                        });
                    }
                    if came { event.after() } else { -1 }
                }
                Until::Read { input } => i8::from(session.read_input(wait, input)?),
            };
            if answers.input(wait, value)? {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// A program that stops is not begun where nobody could continue it.
pub(super) fn check_attended(
    session: &Session,
    answers: &Answers,
    paths: &[PlannedPath],
) -> Result<(), JobError> {
    let mut waits = paths.iter().flat_map(|path| &path.waits_before);
    match waits.find(|wait| wait.is_for_operator() && !answers.is_over(wait)) {
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
            Until::Continued | Until::Input { .. } | Until::Read { .. } => Question::Stop {
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

    /// Until an input of that number, from 0, does what is waited for; whether it did within `within_s`.
    fn wait_for_input(
        &mut self,
        wait: &Wait,
        input: u8,
        event: InputEvent,
        within_s: f64,
    ) -> Result<bool, JobError> {
        self.wait_phase(wait, input)?;
        let mut watch = InputWatch::new(self.tick(), input, event);
        let mut left = Countdown::new(self.tick(), (within_s * 1e3).ceil() as u64);
        let mut came = false;
        self.go_on_until(|session| {
            session.obey(false)?;
            came = watch.look(session.record.motion());
            Ok(came || left.is_over(session.tick()))
        })?;
        Ok(came)
    }

    /// Whether an input of that number, from 0, is on now.
    fn read_input(&mut self, wait: &Wait, input: u8) -> Result<bool, JobError> {
        self.wait_phase(wait, input)?;
        let now = self.tick();
        let mut is_on = None;
        self.go_on_until(|session| {
            session.obey(false)?;
            let newest = newer(session.record.motion(), now).last();
            is_on = newest.map(|sample| Bits(sample.inputs).get(input.into()));
            Ok(is_on.is_some())
        })?;
        Ok(is_on.unwrap_or_default())
    }

    /// An input is looked at from now on.
    fn wait_phase(&mut self, wait: &Wait, input: u8) -> Result<(), JobError> {
        let (number, line) = (input + 1, wait.place.line);
        self.phase(Phase::WaitingForInput { number, line });
        Ok(self.refresh()?)
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
