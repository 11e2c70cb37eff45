//! Doing what the operator asks for.

use crate::session::Session;
use crate::{JobError, Word};
use host_link::boards::LinkError;
use shared::protocol::{Request, Role};

impl Session<'_> {
    /// Does what the operator asks for now, but to go on, which is for the caller to do; what it was. Somebody must be
    /// there who could ask if the machine is `waiting` for them.
    ///
    /// # Errors
    /// [`JobError::NoOperator`], and what the connection has.
    pub fn obey(&mut self, waiting: bool) -> Result<Option<Word>, JobError> {
        let word = self.progress.word();
        match word {
            None | Some(Word::GoOn) => {}
            Some(Word::Hold) => self.ask(&Request::Hold)?,
            Some(Word::Back) => self.ask(&Request::Back)?,
            Some(Word::Override(factor)) => self.ask(&Request::Override { factor })?,
            Some(Word::Gone) if waiting => return Err(JobError::NoOperator),
            Some(Word::Gone) => {}
        }
        Ok(word)
    }

    /// A request to the motion board that means nothing in another state, as one that the operator makes a moment
    /// too late.
    pub fn ask(&mut self, request: &Request) -> Result<(), LinkError> {
        match self.command(Role::Motion, request) {
            Err(LinkError::Refused { .. }) => Ok(()),
            answered => answered,
        }
    }

    /// Tells the operator that the machine waits for them before `what`.
    pub fn tell_waiting(&mut self, what: &str) {
        self.progress
            .phase(&format!("waiting before {what}: Enter goes on"));
    }

    /// In single block, waits at rest between two paths until the operator lets the machine go on to `what`.
    pub fn wait_before(&mut self, what: &str) -> Result<(), JobError> {
        if !self.progress.single_block() {
            return Ok(());
        }
        self.progress
            .phase(&format!("waiting before {what}: Enter goes on"));
        self.go_on_until(|session| Ok(session.obey(true)? == Some(Word::GoOn)))
    }
}
