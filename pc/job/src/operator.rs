//! Carries out the commands of the operator.

use crate::JobError;
use crate::session::Session;
use host_link::Command;
use host_link::boards::LinkError;
use host_link::events::{Event, Next, Phase, Question};
use shared::protocol::{Request, Role};

impl Session<'_> {
    /// Does what is asked for now, but to resume, which is for the caller to do; what it was. Somebody must be there who
    /// could ask if the machine is `waiting` for them.
    ///
    /// # Errors
    /// [`JobError::NoOperator`], and what the connection has.
    pub fn obey(&mut self, waiting: bool) -> Result<Option<Command>, JobError> {
        let order = self.control.order();
        match &order {
            None if waiting && self.control.unattended() => return Err(JobError::NoOperator),
            Some(Command::Hold) => self.ask(&Request::Hold)?,
            Some(Command::Back) => self.ask(&Request::Back)?,
            Some(Command::Override(factor)) => self.override_feed(*factor)?,
            None | Some(_) => {}
        }
        Ok(order)
    }

    /// A request to the motion board that means nothing in another state, as one that the operator makes a moment
    /// too late.
    pub fn ask(&mut self, request: &Request) -> Result<(), LinkError> {
        match self.command(Role::Motion, request) {
            Err(LinkError::Refused { .. }) => Ok(()),
            answered => answered,
        }
    }

    /// A new part of the job begins; one that continues is announced once.
    pub fn phase(&mut self, phase: Phase) {
        self.question = None;
        if self.phase.replace(phase) != Some(phase) {
            self.control.publish(Event::Phase(phase));
        }
    }

    /// The machine is at rest until the operator answers; a question that is open already is not asked again.
    pub fn question(&mut self, question: Question) {
        self.phase = None;
        if self.question.as_ref() != Some(&question) {
            self.question = Some(question.clone());
            self.control.publish(Event::Question(question));
        }
    }

    /// In single block, waits at rest between two paths until the machine may go on to `next`.
    pub fn wait_before(&mut self, next: Next) -> Result<(), JobError> {
        if !self.control.single_block() {
            return Ok(());
        }
        self.question(Question::GoOn { next });
        self.go_on_until(|session| Ok(session.obey(true)? == Some(Command::Resume)))
    }
}
