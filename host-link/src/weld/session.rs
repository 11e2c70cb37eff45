//! A session with both boards while a job runs: takes what they send, answers their captures, asks for their
//! state and clock.

use super::{JobError, Progress};
use crate::boards::{Boards, LinkError, command};
use crate::record::Record;
use crate::report::ByBoard;
use crate::world::{BoardClocks, Cameras, Machine, Sight, TrueSeam};
use shared::motion::State;
use shared::protocol::{
    Capture, ClockRequest, Datagram, MotionStatus, Request, Response, Role, TrackerStatus,
};
use shared::tracking::TrackerState;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the boards are asked for their state; it also tells them that the PC is there.
const STATUS_PERIOD: Duration = Duration::from_millis(100);
/// How often the boards are asked for their clock.
const CLOCK_PERIOD: Duration = Duration::from_millis(50);
/// Longest and shortest wait for a datagram.
const LONGEST_WAIT: Duration = Duration::from_millis(10);
const SHORTEST_WAIT: Duration = Duration::from_micros(200);

/// A session and everything that was learned in it.
pub(super) struct Session<'a> {
    pub boards: &'a mut dyn Boards,
    pub interrupted: &'a AtomicBool,
    pub progress: &'a mut dyn Progress,
    pub machine: Machine,
    pub seams: BTreeMap<u32, TrueSeam>,
    pub cameras: Cameras,
    pub record: Record,
    pub motion: MotionStatus,
    pub tracker: TrackerStatus,
    pub lost_before: ByBoard,
    /// Largest residual that the tracker told while welding \[µs\].
    pub clock_residual_us: Option<f64>,
    /// Largest difference of its relation from the PC's while welding \[µs\].
    pub clock_difference_us: Option<f64>,
    pub began: Duration,
    clocks: BoardClocks,
    next_status: Duration,
    next_clock: Duration,
}

impl<'a> Session<'a> {
    /// Begins with the boards as they are.
    pub fn begin(
        boards: &'a mut dyn Boards,
        machine: Machine,
        cameras: Cameras,
        interrupted: &'a AtomicBool,
        progress: &'a mut dyn Progress,
    ) -> Result<Self, LinkError> {
        let began = boards.now();
        for role in [Role::Motion, Role::Tracker] {
            let port = boards.datagram_port(role);
            command(boards, role, &Request::Subscribe { port })?;
        }
        let (motion, tracker) = status(boards)?;
        let lost_before = lost(&motion, &tracker);
        Ok(Self {
            boards,
            interrupted,
            progress,
            machine,
            seams: BTreeMap::new(),
            cameras,
            record: Record::default(),
            motion,
            tracker,
            lost_before,
            clock_residual_us: None,
            clock_difference_us: None,
            began,
            clocks: BoardClocks::default(),
            next_status: began,
            next_clock: began,
        })
    }

    /// A request that is answered by "done".
    pub fn command(&mut self, role: Role, request: &Request) -> Result<(), LinkError> {
        command(self.boards, role, request)
    }

    /// Asks both boards for their state now.
    pub fn refresh(&mut self) -> Result<(), LinkError> {
        (self.motion, self.tracker) = status(self.boards)?;
        self.next_status = self.boards.now() + STATUS_PERIOD;
        if self.welding() {
            raise(
                &mut self.clock_residual_us,
                f64::from(self.tracker.clock_residual_us),
            );
        }
        Ok(())
    }

    /// Control ticks lost since the session began.
    pub fn lost_ticks(&self) -> ByBoard {
        let now = lost(&self.motion, &self.tracker);
        ByBoard {
            motion: now.motion.wrapping_sub(self.lost_before.motion),
            tracker: now.tracker.wrapping_sub(self.lost_before.tracker),
        }
    }

    /// How far the tracker's clock is ahead of the motion board's, as the PC found \[µs\].
    pub fn tracker_ahead_us(&self) -> Option<i64> {
        self.clocks.tracker_ahead_us()
    }

    /// Goes on until `done`, at most for `limit`; a fault or the operator end it early.
    pub fn wait_until(
        &mut self,
        what: &'static str,
        limit: Duration,
        mut done: impl FnMut(&mut Self) -> bool,
    ) -> Result<(), JobError> {
        let end = self.boards.now() + limit;
        while !done(self) {
            self.turn()?;
            self.check()?;
            if self.boards.now() > end {
                let seconds = limit.as_secs();
                return Err(JobError::TooLong { what, seconds });
            }
        }
        Ok(())
    }

    /// The first reason not to go on.
    fn check(&self) -> Result<(), JobError> {
        if let Some(fault) = self.motion.fault {
            return Err(JobError::Motion(fault));
        }
        let newest = self.record.tracker().last();
        let told = newest
            .filter(|sample| sample.state == TrackerState::Tracking)
            .and_then(|sample| sample.fault);
        if let Some(fault) = self.tracker.fault.or(told) {
            return Err(JobError::Tracker(fault));
        }
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(JobError::Interrupted);
        }
        Ok(())
    }

    /// Stops on the path and waits until the machine stands. The tracker board is not needed: it may be what was
    /// lost.
    pub fn stop(&mut self, limit: Duration) -> Result<(), JobError> {
        match self.command(Role::Motion, &Request::Stop) {
            // Refused: it does not move any more.
            Ok(()) | Err(LinkError::Refused { .. }) => {}
            Err(error) => return Err(error.into()),
        }
        let end = self.boards.now() + limit;
        loop {
            self.motion = motion_status(self.boards)?;
            if !on_path(self.motion.state) {
                return Ok(());
            }
            if self.boards.now() > end {
                let seconds = limit.as_secs();
                return Err(JobError::TooLong {
                    what: "the controlled stop",
                    seconds,
                });
            }
            let next = self.boards.now() + STATUS_PERIOD / 4;
            while self.boards.now() < next {
                match self.boards.receive(LONGEST_WAIT) {
                    Ok(Some((role, datagram))) => self.take(role, datagram),
                    Ok(None) => {}
                    Err(_) => break,
                }
            }
        }
    }

    /// One turn: at most one datagram, and whatever is due.
    pub fn turn(&mut self) -> Result<(), LinkError> {
        let now = self.boards.now();
        let mut due = self.next_status.min(self.next_clock);
        if let (Some(camera), Some(motion)) = (self.cameras.next_due_us(), self.motion_now_us()) {
            due = due.min(now + Duration::from_micros(camera.saturating_sub(motion)));
        }
        let wait = due.saturating_sub(now).clamp(SHORTEST_WAIT, LONGEST_WAIT);
        if let Some((role, datagram)) = self.boards.receive(wait)? {
            self.take(role, datagram);
        }
        let now = self.boards.now();
        if now >= self.next_clock {
            self.next_clock = now + CLOCK_PERIOD;
            let request = Datagram::ClockRequest(ClockRequest {
                asked_us: now.as_micros() as u64,
            });
            for role in [Role::Motion, Role::Tracker] {
                self.boards.send(role, &request)?;
            }
        }
        self.answer_captures()?;
        if now >= self.next_status {
            self.refresh()?;
        }
        Ok(())
    }

    fn take(&mut self, role: Role, datagram: Datagram) {
        let arrived_us = self.boards.now().as_micros() as u64;
        match datagram {
            Datagram::MotionTelemetry(telemetry) => {
                if let Some(newest) = telemetry.samples.last() {
                    self.clocks.saw_motion(newest.time_us, arrived_us);
                }
                self.record.add_motion(&telemetry.samples);
            }
            Datagram::TrackerTelemetry(telemetry) => self.record.add_tracker(&telemetry.samples),
            Datagram::ClockReply(reply) => self.clocks.add(role, &reply, arrived_us),
            Datagram::Capture(capture) => self.strobe(capture),
            // Boards send these to each other only.
            Datagram::PathState(_) | Datagram::Measurement(_) | Datagram::ClockRequest(_) => {}
        }
    }

    /// Gives a capture to the cameras. The time of the strobe is what the PC found, not what the tracker
    /// believes: a wrong belief must show.
    fn strobe(&mut self, capture: Capture) {
        let Some(ahead) = self.clocks.tracker_ahead_us() else {
            return;
        };
        let on_motion = capture.time_us.saturating_add_signed(-ahead);
        if self.welding() {
            let difference = capture.motion_time_us as f64 - on_motion as f64;
            raise(&mut self.clock_difference_us, difference.abs());
        }
        self.cameras.strobe(capture, on_motion);
    }

    fn answer_captures(&mut self) -> Result<(), LinkError> {
        let Some(now_us) = self.motion_now_us() else {
            return Ok(());
        };
        loop {
            let (record, seams) = (&self.record, &self.seams);
            let sight = |time_us| {
                let (position, sample) = record.machine_at(time_us)?;
                Some(Sight {
                    position,
                    s_mm: sample.s_mm,
                    seam: seams.get(&sample.path_id),
                })
            };
            let Some(measurement) = self.cameras.answer(&self.machine, now_us, sight) else {
                return Ok(());
            };
            self.boards
                .send(Role::Tracker, &Datagram::Measurement(measurement))?;
        }
    }

    /// What the motion board's clock shows now \[µs\].
    fn motion_now_us(&self) -> Option<u64> {
        self.clocks.motion_now_us(self.boards.now().as_micros() as u64)
    }

    fn welding(&self) -> bool {
        self.record
            .motion()
            .last()
            .is_some_and(|sample| sample.beams.contains(&true))
    }
}

/// Whether the machine is moving along a path, or may be.
pub(super) fn on_path(state: State) -> bool {
    matches!(state, State::Running | State::Holding | State::Stopping)
}

fn status(boards: &mut dyn Boards) -> Result<(MotionStatus, TrackerStatus), LinkError> {
    let motion = motion_status(boards)?;
    let tracker = match boards.request(Role::Tracker, &Request::Status)? {
        Response::TrackerStatus(status) => status,
        other => return Err(unexpected(Role::Tracker, &other)),
    };
    Ok((motion, tracker))
}

fn motion_status(boards: &mut dyn Boards) -> Result<MotionStatus, LinkError> {
    match boards.request(Role::Motion, &Request::Status)? {
        Response::MotionStatus(status) => Ok(status),
        other => Err(unexpected(Role::Motion, &other)),
    }
}

fn unexpected(role: Role, response: &Response) -> LinkError {
    match response {
        Response::Refused(refusal) => LinkError::Refused {
            role,
            refusal: *refusal,
        },
        _ => LinkError::Unexpected { role },
    }
}

fn lost(motion: &MotionStatus, tracker: &TrackerStatus) -> ByBoard {
    ByBoard {
        motion: motion.servo_lost.wrapping_add(motion.path_lost),
        tracker: tracker.lost,
    }
}

fn raise(largest: &mut Option<f64>, value: f64) {
    *largest = Some(largest.map_or(value, |before| before.max(value)));
}
