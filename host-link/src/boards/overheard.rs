//! Boards for tests that listen in on the motion board.

use super::{Boards, LinkError};
use shared::protocol::{Datagram, Identity, MotionSample, Request, Response, Role};
use std::time::Duration;

/// Boards, and what is done with every sample of the motion board before the job gets it.
pub struct Overheard<'a, F> {
    /// The boards.
    pub boards: &'a mut dyn Boards,
    /// Gets the boards, too, so that it can act.
    pub hear: F,
}

impl<F: FnMut(&mut dyn Boards, &MotionSample)> Boards for Overheard<'_, F> {
    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        self.boards.request(role, request)
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received {
            for sample in &telemetry.samples {
                (self.hear)(self.boards, sample);
            }
        }
        Ok(received)
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        self.boards.send(role, datagram)
    }

    fn now(&self) -> Duration {
        self.boards.now()
    }

    fn identity(&self, role: Role) -> Option<&Identity> {
        self.boards.identity(role)
    }

    fn path_states_target(&self) -> Option<Request> {
        self.boards.path_states_target()
    }
}
