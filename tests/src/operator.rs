//! Operators of jobs in tests. They act on the job's own thread, so that every run is the same.

use host_link::boards::{Boards, LinkError};
use host_link::events::{Event, Interest, Subscription};
use host_link::{Remote, control, pass_on};
use job::{Job, JobError};
use report::Ended;
use shared::protocol::{Datagram, MotionSample, Role};
use std::time::Duration;

/// More events than come between two waits for the boards.
const EVENTS: usize = 100_000;

/// Watches and drives a job.
pub trait Operator {
    /// Something happened.
    fn event(&mut self, _event: &Event, _remote: &Remote) {}

    /// The job has waited for the boards once more.
    fn turn(&mut self, _remote: &Remote) {}
}

/// An operator who does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoOperator;

impl Operator for NoOperator {}

/// Boards with a function that gets every sample of the motion board before the job does.
pub struct TappedBoards<'a, F> {
    /// The boards.
    pub boards: &'a mut dyn Boards,
    /// Gets the boards, too, so that it can act.
    pub on_sample: F,
}

impl<F: FnMut(&mut dyn Boards, &MotionSample)> Boards for TappedBoards<'_, F> {
    pass_on!(boards: request, send, now, identity, path_states_target);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received {
            for sample in &telemetry.samples {
                (self.on_sample)(self.boards, sample);
            }
        }
        Ok(received)
    }
}

/// Boards of a job with an operator.
struct OperatedBoards<'a> {
    boards: &'a mut dyn Boards,
    events: Subscription,
    remote: Remote,
    operator: &'a mut dyn Operator,
}

impl Boards for OperatedBoards<'_> {
    pass_on!(boards: request, ask, answer, send, now, identity, path_states_target, waker, last_stall, dropped_datagrams);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        while let Ok(received) = self.events.receive(Duration::ZERO) {
            self.operator.event(&received.event, &self.remote);
        }
        self.operator.turn(&self.remote);
        Ok(received)
    }
}

/// Does a job and judges it.
///
/// # Errors
/// As [`job::run`].
pub fn run(boards: &mut dyn Boards, job: &Job, operator: &mut dyn Operator) -> Result<Ended, JobError> {
    let (remote, mut control) = control();
    let mut attended = OperatedBoards {
        boards,
        events: remote.subscribe(Interest::Samples, EVENTS),
        remote,
        operator,
    };
    let record = job::run(&mut attended, job, &mut control)?;
    Ok(report::ended(job, record))
}
