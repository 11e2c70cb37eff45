//! A session with the boards while a job runs: takes what they send and asks for their state.

use crate::countdown::Countdown;
use crate::feed_override::FeedOverride;
use crate::recentring::Recentring;
use crate::run_record::ByBoard;
use crate::surroundings::Surroundings;
use crate::{JobError, Tracking};
use config::machine::MachineFile;
use host_link::Control;
use host_link::boards::{Boards, LinkError, Stall};
use host_link::events::{Event, Phase, Question};
use host_link::geometry::MachineGeometry;
use host_link::record::Record;
use host_link::spool::Spooling;
use nc::ProbeInput;
use shared::protocol::{Datagram, MotionStatus, Request, Response, Role};
use shared::state::{Fault, State, TrackerFault};
use std::time::Duration;

/// Interval of the status requests to the boards; they also keep the session alive.
const STATUS_PERIOD: Duration = Duration::from_millis(100);
/// A motion board whose clock has stood still for so long is broken.
const STANDSTILL: Duration = Duration::from_secs(10);
/// An error of the boards is due to a stall of this program that ended no longer ago, and no longer than the stall was: their
/// state is asked for at once after it, and comes behind what the boards sent meanwhile.
const JUST_BEFORE: Duration = Duration::from_secs(1);
/// Longest and shortest wait for a datagram.
const LONGEST_WAIT: Duration = Duration::from_millis(10);
const SHORTEST_WAIT: Duration = Duration::from_micros(200);

/// A session and everything that was learned in it.
pub(super) struct Session<'a> {
    pub boards: &'a mut dyn Boards,
    pub control: &'a mut Control,
    /// What was published last of the two.
    pub(super) phase: Option<Phase>,
    pub(super) question: Option<Question>,
    /// What went wrong while a board was asked for something.
    trouble: Option<JobError>,
    pub machine: MachineGeometry,
    /// The tracker board, if the machine has one.
    pub tracking: Option<Tracking>,
    /// What watches its slides.
    pub recentring: Option<Recentring>,
    pub record: Record,
    pub motion: MotionStatus,
    /// The probe, if the machine has one.
    pub probe: Option<ProbeInput>,
    pub(super) feed_override: FeedOverride,
    pub began: Duration,
    lost_before: u32,
    next_status: Duration,
    /// When the motion board's clock was last seen to continue.
    ticked: Duration,
    /// A PC that does nothing for so long is missed by the motion board.
    missed: Duration,
}

impl<'a> Session<'a> {
    /// Begins with the boards as they are, before the cameras of `around`. `spooling` is for the record.
    pub fn begin(
        boards: &'a mut dyn Boards,
        machine: &MachineFile,
        around: &dyn Surroundings,
        spooling: Spooling,
        control: &'a mut Control,
    ) -> Result<Self, JobError> {
        let geometry = around.geometry(&machine.motion)?;
        let began = boards.now();
        let unit = machine.tracking.as_ref();
        let tracking = unit
            .map(|unit| Tracking::begin(boards, unit, around, &spooling, control))
            .transpose()?;
        let motion = motion(boards.request(Role::Motion, &Request::Status)?)?;
        let identity = |role| boards.identity(role).cloned();
        control.publish(Event::Connected {
            motion: identity(Role::Motion),
            tracker: unit.and_then(|_| identity(Role::Tracker)),
        });
        Ok(Self {
            boards,
            control,
            phase: None,
            question: None,
            trouble: None,
            machine: geometry,
            tracking,
            recentring: unit
                .map(|unit| Recentring::new(unit, machine.motion.kinematics.fitted()))
                .transpose()?,
            record: Record::new(spooling),
            lost_before: lost(&motion),
            motion,
            probe: None,
            feed_override: FeedOverride::NONE,
            began,
            next_status: began,
            ticked: began,
            missed: Duration::from_millis(machine.motion.link_timeout_ms.into())
                .saturating_sub(STATUS_PERIOD),
        })
    }

    /// The boards of the machine.
    pub fn roles(&self) -> &'static [Role] {
        match self.tracking {
            Some(_) => &[Role::Motion, Role::Tracker],
            None => &[Role::Motion],
        }
    }

    /// A request that is answered by "done".
    pub fn command(&mut self, role: Role, request: &Request) -> Result<(), LinkError> {
        match self.request(role, request)? {
            Response::Done => Ok(()),
            other => Err(unexpected(role, &other)),
        }
    }

    /// Asks a board, and continues with everything else until it answers: what boards send is taken, and
    /// measurements leave for the tracker board. What goes wrong with that meanwhile is for the next turn: a
    /// stop needs the motion board only.
    pub fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        if let (Role::Tracker, Some(tracking)) = (role, &mut self.tracking) {
            tracking.forget_question();
        }
        let mut answer = self.boards.ask(role, request)?;
        loop {
            if let Some(answer) = answer {
                return Ok(answer);
            }
            if let Err(error) = self.attend(LONGEST_WAIT) {
                self.trouble.get_or_insert(error);
            }
            answer = self.boards.answer(role)?;
        }
    }

    /// Takes what comes within `wait`, at most one datagram, and sends what is to be sent.
    fn attend(&mut self, wait: Duration) -> Result<(), JobError> {
        let now = self.boards.now();
        let due = self.tracking.as_ref().map(|tracking| tracking.next_due(now));
        let wait = due.map_or(wait, |due| wait.min(due.saturating_sub(now)));
        if let Some((role, datagram)) = self.boards.receive(wait.max(SHORTEST_WAIT))? {
            self.take(role, datagram);
        }
        match &mut self.tracking {
            Some(tracking) => tracking.turn(self.boards, &self.machine, &self.record, self.control),
            None => Ok(()),
        }
    }

    /// The same request to every board of the machine, to each even if the other one is lost.
    pub fn command_all(&mut self, request: &Request) -> Result<(), LinkError> {
        let mut result = Ok(());
        for role in self.roles() {
            result = result.and(self.command(*role, request));
        }
        result
    }

    /// Asks the boards for their state now, and waits for both.
    pub fn refresh(&mut self) -> Result<(), LinkError> {
        self.refresh_motion()?;
        if self.tracking.is_some() {
            let answer = self.request(Role::Tracker, &Request::Status)?;
            let welding = self.welding();
            if let Some(tracking) = &mut self.tracking {
                tracking.take_status(answer, welding)?;
            }
        }
        self.publish_status();
        self.next_status = self.boards.now() + STATUS_PERIOD;
        Ok(())
    }

    fn refresh_motion(&mut self) -> Result<(), LinkError> {
        let ticks = self.motion.path_ticks;
        self.motion = motion(self.request(Role::Motion, &Request::Status)?)?;
        if self.motion.path_ticks != ticks {
            self.ticked = self.boards.now();
        }
        Ok(())
    }

    /// Asks for the states that are due. The motion board is never left waiting for the tracker board, whose answer is
    /// taken when it comes.
    fn poll(&mut self) -> Result<(), LinkError> {
        let due = self.boards.now() >= self.next_status;
        if due {
            self.refresh_motion()?;
        }
        let welding = self.welding();
        if let Some(tracking) = &mut self.tracking {
            tracking.poll(self.boards, due, welding)?;
        }
        if due {
            self.publish_status();
            self.next_status = self.boards.now() + STATUS_PERIOD;
        }
        Ok(())
    }

    fn publish_status(&self) {
        self.control.publish(Event::Status {
            motion: Box::new(self.motion.clone()),
            tracker: self.tracking.as_ref().map(|tracking| tracking.status.clone()),
        });
    }

    /// Control ticks lost since the session began.
    pub fn lost_ticks(&self) -> ByBoard {
        ByBoard {
            motion: lost(&self.motion).wrapping_sub(self.lost_before),
            tracker: self.tracking.as_ref().map(Tracking::lost_ticks),
        }
    }

    /// Newest known path tick of the motion board, one a millisecond: the clock of the job.
    pub fn tick(&self) -> u32 {
        let asked = self.motion.path_ticks;
        let told = self.record.motion().back().map_or(asked, |sample| sample.tick);
        // The newer one, where the count starts again, too.
        if told.wrapping_sub(asked) < 1 << 31 {
            told
        } else {
            asked
        }
    }

    /// Goes on until `done`; a fault or the operator end it early.
    pub fn go_on_until(
        &mut self,
        mut done: impl FnMut(&mut Self) -> Result<bool, JobError>,
    ) -> Result<(), JobError> {
        let mut go_on = || {
            while !done(self)? {
                self.turn()?;
                self.check()?;
            }
            Ok(())
        };
        let ended = go_on();
        ended.map_err(|error| {
            match &error {
                JobError::Motion(fault) => self.control.publish(Event::MotionFault(*fault)),
                JobError::Tracker(fault) => self.control.publish(Event::TrackerFault(*fault)),
                _ => {}
            }
            self.explained(error)
        })
    }

    /// Asks the operator, and waits for the answer; `None` when nobody answers any more.
    pub fn answer(&mut self, question: Question) -> Result<Option<String>, JobError> {
        self.question(question);
        let mut said = None;
        self.go_on_until(|session| {
            said = session.control.answer();
            Ok(said.is_some() || session.control.unattended())
        })?;
        Ok(said)
    }

    /// An error of the boards, with the reason if this program was not there for them just before.
    fn explained(&self, error: JobError) -> JobError {
        let Some(missed) = self.missed_after(&error) else {
            return error;
        };
        match self.boards.last_stall() {
            Some(Stall { ended, lasted })
                if lasted >= missed && self.boards.now() < ended + JUST_BEFORE + lasted =>
            {
                JobError::Absent {
                    seconds: lasted.as_secs_f64(),
                    source: Box::new(error),
                }
            }
            _ => error,
        }
    }

    /// How long a stall of this program has to be to lead to `error`; `None` if it does not come from stalls.
    fn missed_after(&self, error: &JobError) -> Option<Duration> {
        use TrackerFault::{BesideSeam, LostSeam, SeamNotSeen};
        match error {
            // The measurements are missing at once: at speed, the tip passes what was seen ahead of it in less than 0.1 s.
            JobError::Tracker(SeamNotSeen { .. } | LostSeam { .. } | BesideSeam { .. }) => {
                Some(Duration::ZERO)
            }
            JobError::Link(_) | JobError::Motion(_) | JobError::Tracker(_) | JobError::TooLong { .. } => {
                Some(self.missed)
            }
            _ => None,
        }
    }

    /// Goes on until `done`, at most for `limit` by the motion board's clock; a fault or the operator end it
    /// early.
    pub fn wait_until(
        &mut self,
        what: &'static str,
        limit: Duration,
        mut done: impl FnMut(&mut Self) -> Result<bool, JobError>,
    ) -> Result<(), JobError> {
        let mut limit_ms = Countdown::new(self.tick(), limit.as_millis() as u64);
        self.go_on_until(|s| {
            let over = done(s)?;
            if limit_ms.is_over(s.tick()) && !over {
                let seconds = limit.as_secs();
                return Err(JobError::TooLong { what, seconds });
            }
            Ok(over)
        })
    }

    /// Goes on for `seconds` by the motion board's clock, unless a fault or the operator end it early.
    pub fn dwell(&mut self, seconds: f64) -> Result<(), JobError> {
        self.refresh()?;
        let mut dwell = Countdown::new(self.tick(), (seconds * 1e3).ceil() as u64);
        self.go_on_until(|s| Ok(dwell.is_over(s.tick())))
    }

    /// The first reason not to continue.
    pub fn check(&self) -> Result<(), JobError> {
        let tracking = self.tracking.as_ref();
        let of_tracker = tracking.and_then(|tracking| tracking.fault(&self.record));
        match (self.motion.fault, of_tracker) {
            // The tracker knows why it gave no permit.
            (Some(Fault::PermitLost { .. } | Fault::NotLocked { .. }) | None, Some(fault)) => {
                return Err(JobError::Tracker(fault));
            }
            (Some(fault), _) => return Err(JobError::Motion(fault)),
            (None, None) => {}
        }
        if self.control.stopped() {
            return Err(JobError::Interrupted);
        }
        if self.boards.now() > self.ticked + STANDSTILL {
            let seconds = STANDSTILL.as_secs();
            let what = "the next tick of the motion board";
            return Err(JobError::TooLong { what, seconds });
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
            self.motion = motion(self.request(Role::Motion, &Request::Status)?)?;
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
    pub fn turn(&mut self) -> Result<(), JobError> {
        let wait = self.next_status.saturating_sub(self.boards.now());
        self.attend(wait.clamp(SHORTEST_WAIT, LONGEST_WAIT))?;
        if let Some(trouble) = self.trouble.take() {
            return Err(trouble);
        }
        Ok(self.poll()?)
    }

    fn take(&mut self, role: Role, datagram: Datagram) {
        let arrived_us = self.boards.now().as_micros() as u64;
        let welding = self.welding();
        match (datagram, &mut self.tracking) {
            (Datagram::MotionTelemetry(telemetry), tracking) => {
                if let (Some(newest), Some(tracking)) = (telemetry.samples.last(), tracking) {
                    tracking.saw_motion(newest.time_us, arrived_us);
                    tracking.cameras.motion(&telemetry.samples);
                }
                self.record.add_motion(&telemetry.samples);
                let samples = telemetry.samples.as_slice().into();
                self.control.publish(Event::MotionSamples(samples));
            }
            (Datagram::TrackerTelemetry(telemetry), _) => {
                self.record.add_tracker(&telemetry.samples);
                let samples = telemetry.samples.as_slice().into();
                self.control.publish(Event::TrackerSamples(samples));
            }
            (Datagram::ClockReply(reply), Some(tracking)) => tracking.clock_reply(role, &reply, arrived_us),
            (Datagram::Capture(capture), Some(tracking)) => {
                self.control.publish(Event::Capture(capture));
                tracking.strobe(&self.machine, capture, welding);
            }
            // Left over from another session, or what boards send to each other only.
            (Datagram::ClockReply(_) | Datagram::Capture(_), None)
            | (
                Datagram::PathState(_)
                | Datagram::Permit(_)
                | Datagram::Measurement(_)
                | Datagram::ClockRequest(_),
                _,
            ) => {}
        }
    }

    fn welding(&self) -> bool {
        self.record
            .motion()
            .back()
            .is_some_and(|sample| sample.beams.contains(&true))
    }
}

/// Whether the machine is moving along a path, or may be.
pub(super) fn on_path(state: State) -> bool {
    matches!(state, State::Running | State::Holding | State::Stopping)
}

fn motion(answer: Response) -> Result<MotionStatus, LinkError> {
    match answer {
        Response::MotionStatus(status) => Ok(status),
        other => Err(unexpected(Role::Motion, &other)),
    }
}

pub(super) fn unexpected(role: Role, response: &Response) -> LinkError {
    match response {
        Response::Refused(refusal) => LinkError::Refused {
            role,
            refusal: *refusal,
        },
        _ => LinkError::Unexpected { role },
    }
}

fn lost(motion: &MotionStatus) -> u32 {
    motion.servo_lost.wrapping_add(motion.path_lost)
}
