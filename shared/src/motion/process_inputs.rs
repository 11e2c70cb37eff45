//! Answers of the process: inputs that are on while a line is.

use super::outputs::OutputLimits;
use crate::config::MotionConfig;
use crate::io::{Bits, LINES, Lines, PROCESS_INPUTS, SIDES};
use crate::parameter::{ParameterError, check, positive};
use crate::state::Fault;
use crate::ticks::PATH_PERIOD_S;

const OWNERS: [&str; PROCESS_INPUTS] = ["input 1", "input 2", "input 3", "input 4"];

/// One input that the machine has.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Answer {
    /// The line that it answers.
    line: usize,
    within_ms: u32,
}

/// Inputs that the machine has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessInputs {
    answers: [Option<Answer>; PROCESS_INPUTS],
}

/// For how many path ticks each answer has been missing.
pub type Missing = [u32; PROCESS_INPUTS];

impl ProcessInputs {
    /// Checks the parameters of the inputs that the machine has; what they answer must be there.
    pub fn build(config: &MotionConfig, outputs: &OutputLimits) -> Result<Self, ParameterError> {
        let mut answers = [None; PROCESS_INPUTS];
        for (index, input) in config.process.inputs.iter().enumerate() {
            let Some(input) = input else { continue };
            let fitted = |line: f64| match line as usize {
                line @ ..SIDES => config.beams[line].is_some(),
                line @ ..LINES => outputs.has((line - SIDES) as u8),
                _ => false,
            };
            check(OWNERS[index], "answers", f64::from(input.answers), fitted)?;
            positive(OWNERS[index], "within_ms", f64::from(input.within_ms))?;
            answers[index] = Some(Answer {
                line: usize::from(input.answers),
                within_ms: input.within_ms,
            });
        }
        Ok(Self { answers })
    }

    /// A path tick in which `lines` are on and the inputs read `inputs`; the first answer that has been missing too long.
    pub fn tick(&self, missing: &mut Missing, lines: Lines, inputs: Bits) -> Option<Fault> {
        let mut fault = None;
        for (index, answer) in self.answers.iter().enumerate() {
            let Some(answer) = answer else { continue };
            let answered = !lines.get(answer.line) || inputs.get(index);
            missing[index] = if answered {
                0
            } else {
                missing[index].saturating_add(1)
            };
            if f64::from(missing[index]) * PATH_PERIOD_S * 1e3 > f64::from(answer.within_ms) {
                fault = fault.or(Some(Fault::NoAnswer {
                    input: index as u8,
                    line: answer.line as u8,
                    within_ms: answer.within_ms,
                }));
            }
        }
        fault
    }
}
