//! Operators of jobs in tests. They act on the job's own thread, so that every run is the same.

use host_link::boards::{Boards, LinkError};
use host_link::events::{Event, Interest, Subscription};
use host_link::{Remote, control, pass_on};
use job::{Job, JobError};
use report::Ended;
use shared::protocol::{Datagram, MotionSample, Role};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
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

/// Subscribes to everything, pictures too, and sleeps for a second at each event.
#[derive(Debug, Default)]
pub struct Sleeper {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<u64>>,
}

impl Sleeper {
    /// Wakes it for the last time; how many events it lost.
    ///
    /// # Panics
    /// If there was no event.
    pub fn end(self) -> u64 {
        self.over.store(true, Ordering::Relaxed);
        let thread = self.thread.expect("a job has events");
        thread.join().expect("it only sleeps")
    }
}

impl Operator for Sleeper {
    fn event(&mut self, _: &Event, remote: &Remote) {
        self.thread.get_or_insert_with(|| {
            let (events, over) = (remote.subscribe(Interest::Pictures, 8), Arc::clone(&self.over));
            std::thread::spawn(move || {
                let mut lost = 0;
                for received in events {
                    lost += received.lost;
                    if over.load(Ordering::Relaxed) {
                        break;
                    }
                    std::thread::sleep(Duration::from_secs(1));
                }
                lost
            })
        });
    }
}

/// Boards, and what is done with every sample of the motion board before the job gets it.
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
