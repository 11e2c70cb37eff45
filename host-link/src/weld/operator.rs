//! Doing what the operator asks for.

use super::session::Session;
use super::{JobError, Word};
use crate::boards::LinkError;
use shared::protocol::{Request, Role};

impl Session<'_> {
    /// Does what the operator asks for now; whether that is to go on. Somebody must be there who could ask if the
    /// machine is `waiting` for them.
    ///
    /// # Errors
    /// [`JobError::NoOperator`], and what the connection has.
    pub fn obey(&mut self, waiting: bool) -> Result<bool, JobError> {
        match self.progress.word() {
            None => {}
            Some(Word::GoOn) => return Ok(true),
            Some(Word::Hold) => self.ask(&Request::Hold)?,
            Some(Word::Back) => self.ask(&Request::Back)?,
            Some(Word::Override(factor)) => self.ask(&Request::Override { factor })?,
            Some(Word::Gone) if waiting => return Err(JobError::NoOperator),
            Some(Word::Gone) => {}
        }
        Ok(false)
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
        self.go_on_until(|session| session.obey(true))
    }
}
