//! Boards for tests that listen in on the motion board.

use super::{Boards, LinkError};
use crate::pass_on;
use shared::protocol::{Datagram, MotionSample, Role};
use std::time::Duration;

/// Boards, and what is done with every sample of the motion board before the job gets it.
pub struct Overheard<'a, F> {
    /// The boards.
    pub boards: &'a mut dyn Boards,
    /// Gets the boards, too, so that it can act.
    pub hear: F,
}

impl<F: FnMut(&mut dyn Boards, &MotionSample)> Boards for Overheard<'_, F> {
    pass_on!(boards: request, send, now, identity, path_states_target);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received {
            for sample in &telemetry.samples {
                (self.hear)(self.boards, sample);
            }
        }
        Ok(received)
    }
}
