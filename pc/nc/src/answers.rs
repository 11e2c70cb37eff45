//! Questions of a program to the machine: what a probe meets (G38, G31), and what an input does (M66).
//!
//! A program is read before the machine moves, and nobody knows the answers then: what is most likely is taken for granted.
//! When the machine has been there, the program is read again from its beginning with the answers so far
//! ([`Program::answered`]), and goes on behind them.

use super::error::NcError;
use super::probing::{Found, Probed};
use super::program::Program;
use super::reading::{KEPT, read};
use super::setup::Options;
use super::source::Source;
use std::fmt;
use std::sync::Arc;

/// What the machine has answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// To a motion with the probe.
    Probe(Probed),
    /// To an M66: `#5399`, 1 of an input that is on, 0 of one that is off, −1 of one that was waited for in vain.
    Input(i8),
}

/// How a program is read again, and what this reading of it has looked at.
#[derive(Clone)]
pub(super) struct Again {
    pub source: Source,
    pub options: Options,
    /// What its last motion with the probe has found.
    pub found: Option<Found>,
    /// Numbers of the questions whose answers it has looked at by `#5399`, rising.
    pub looked: Vec<usize>,
}

impl fmt::Debug for Again {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Again")
    }
}

/// It says nothing of what a program does.
impl PartialEq for Again {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Program {
    /// What its last motion with the probe has found; `None` of a program without any.
    pub fn found(&self) -> Option<Found> {
        self.again.as_ref()?.found
    }

    /// Whether anything in it depends on the answer to a question, that of this number, to an M66.
    pub fn looks_at(&self, question: usize) -> bool {
        let again = self.again.as_ref();
        again.is_some_and(|again| again.looked.binary_search(&question).is_ok())
    }

    /// The same program after its first questions, to which these are the `answers`.
    ///
    /// # Errors
    /// What follows does not go with the answers, or the program is not as it was when it was read.
    pub fn answered(&self, answers: &[Answer]) -> Result<Self, NcError> {
        let Some(again) = &self.again else {
            return Ok(self.clone());
        };
        let options = Options {
            answers: Arc::from(answers),
            ..again.options.clone()
        };
        read(&again.source, options, KEPT)
    }
}
