//! One case: boards at a moment of a job, and the messages sent to them from there on.

use super::corpus::{Message, Session, any, seldom};
use super::judge::Judge;
use super::random::{Random, mutate};
use super::wire::Wire;
use host_link::boards::Boards;
use shared::protocol::framing::{MAX_MESSAGE, decode_datagram, decode_message};
use shared::protocol::{Request, Role, SCHEMA_HASH};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use world::simulated::SimulatedBoards;

/// Messages of a case.
const MESSAGES: usize = 96;
/// Time after the last one, for what it did to show \[µs\].
const AFTER_US: u64 = 30_000;
/// The boards have a millisecond for all that a tick and the messages in it take; here a call may take so long, on a
/// PC that has other things to do.
const LONGEST_CALL: Duration = Duration::from_millis(400);

/// Something done to the boards.
#[derive(Clone, PartialEq)]
pub enum Step {
    /// The bytes of a request come in.
    Request(Role, Vec<u8>),
    /// The bytes of a datagram come in.
    Datagram(Role, Vec<u8>),
    /// Time passes \[µs\].
    Wait(u64),
    /// The emergency stop is pressed or released.
    EmergencyStop(bool),
}

impl std::fmt::Debug for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        match self {
            Self::Request(role, bytes) => match decode_message::<Request>(bytes) {
                Ok(request) => write!(f, "{role:?} <- {request:?}\n        {}", hex(bytes)),
                Err(error) => write!(f, "{role:?} <- {error}: {}", hex(bytes)),
            },
            Self::Datagram(role, bytes) => match decode_datagram(bytes) {
                Ok(datagram) => write!(f, "{role:?} <~ {datagram:?}\n        {}", hex(bytes)),
                Err(error) => write!(f, "{role:?} <~ {error}: {}", hex(bytes)),
            },
            Self::Wait(us) => write!(f, "{us} us pass"),
            Self::EmergencyStop(pressed) => write!(f, "emergency stop {pressed}"),
        }
    }
}

/// What messages became of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Requests that were one of the table.
    pub requests: u64,
    /// Those that were accepted.
    pub accepted: u64,
    /// Datagrams that were one of the table.
    pub datagrams: u64,
    /// Bytes that were no message.
    pub malformed: u64,
    /// Milliseconds of both boards.
    pub ticks: u64,
}

impl Tally {
    /// Messages in all.
    pub fn messages(&self) -> u64 {
        self.requests + self.datagrams + self.malformed
    }

    /// Adds another.
    pub fn add(&mut self, other: &Self) {
        self.requests += other.requests;
        self.accepted += other.accepted;
        self.datagrams += other.datagrams;
        self.malformed += other.malformed;
        self.ticks += other.ticks;
    }
}

/// A case: where it begins, and its steps.
pub struct Case<'a> {
    /// The job.
    pub session: &'a Session,
    /// Which moment of it.
    pub moment: usize,
    /// What is done then.
    pub steps: Vec<Step>,
}

impl<'a> Case<'a> {
    /// Makes one.
    pub fn new(random: &mut Random, sessions: &'a [Session]) -> Self {
        let session = random.of(sessions);
        let moment = random.below(session.moments.len());
        let mut next = session.moments[moment].1;
        let (mut steps, mut wire, mut bytes) = (Vec::new(), Wire::default(), Vec::new());
        let seldom = seldom();
        // Some cases keep to the job for the most part, others hardly.
        let (keeps, mutates) = ([90, 60, 20][random.below(3)], [3, 10, 50][random.below(3)]);
        let mut at_us = session.said.get(next).map_or(0, |said| said.at_us);
        for _ in 0..MESSAGES {
            let (to, message, wait) = if random.percent(keeps) && next < session.said.len() {
                let said = &session.said[next];
                let wait = said.at_us.saturating_sub(at_us).min(5000);
                at_us = said.at_us;
                // Some are lost, some come twice.
                next = (next + [0, 1, 1, 1, 1, 1, 1, 2][random.below(8)]).min(session.said.len());
                (said.to, said.message.clone(), wait)
            } else if random.percent(50) {
                let said = any(random, sessions);
                (said.to, said.message.clone(), wait(random))
            } else {
                let request = Box::new(random.of(&seldom).clone());
                (role(random), Message::Request(request), wait(random))
            };
            let to = if random.percent(5) { role(random) } else { to };
            message.write(&mut wire);
            if random.percent(mutates) {
                mutate(random, &wire, &mut bytes);
            } else {
                bytes.clone_from(&wire.bytes);
            }
            if wait > 0 {
                steps.push(Step::Wait(wait));
            }
            steps.push(match message {
                Message::Request(_) => Step::Request(to, bytes.clone()),
                Message::Datagram(_) => {
                    let mut datagram = (SCHEMA_HASH as u32).to_le_bytes().to_vec();
                    // Of the one session that simulated boards have.
                    datagram.extend_from_slice(&1_u32.to_le_bytes());
                    datagram.extend_from_slice(&bytes);
                    Step::Datagram(to, datagram)
                }
            });
            if random.percent(1) {
                steps.push(Step::EmergencyStop(random.percent(40)));
            }
        }
        steps.push(Step::Wait(AFTER_US));
        Self {
            session,
            moment,
            steps,
        }
    }

    /// Goes through it; an error says what was wrong after which step.
    pub fn run(&self, tally: &mut Tally) -> Result<(), (usize, String)> {
        self.run_steps(&self.steps, tally)
    }

    fn run_steps(&self, steps: &[Step], tally: &mut Tally) -> Result<(), (usize, String)> {
        let mut boards = self.session.moments[self.moment].0.clone();
        let mut judge = self.judge(&boards);
        for (index, step) in steps.iter().enumerate() {
            let done = catch_unwind(AssertUnwindSafe(|| {
                self.step(&mut boards, &mut judge, step, tally)
            }));
            match done {
                Ok(Ok(())) => {}
                Ok(Err(wrong)) => return Err((index, wrong)),
                Err(panic) => {
                    let text = panic
                        .downcast_ref::<String>()
                        .cloned()
                        .or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
                    let place = super::last_panic().unwrap_or_default();
                    return Err((index, format!("panic: {} {place}", text.unwrap_or_default())));
                }
            }
        }
        Ok(())
    }

    /// A judge who knows what was accepted before the moment.
    fn judge(&self, boards: &SimulatedBoards) -> Judge {
        let mut judge = Judge::default();
        let (_, next) = self.session.moments[self.moment];
        let shipped = (&self.session.motion, self.session.tracker.as_ref());
        for said in &self.session.said[..next] {
            if let Message::Request(request) = &said.message {
                // The job was a good one: nothing was refused.
                judge
                    .answered(said.to, request, &shared::protocol::Response::Done, shipped)
                    .expect("a good job");
            }
        }
        judge.begin(&boards.outputs());
        judge
    }

    fn step(
        &self,
        boards: &mut SimulatedBoards,
        judge: &mut Judge,
        step: &Step,
        tally: &mut Tally,
    ) -> Result<(), String> {
        match step {
            Step::Request(role, bytes) => {
                let decoded = (bytes.len() <= MAX_MESSAGE).then(|| decode_message::<Request>(bytes));
                let Some(Ok(request)) = decoded else {
                    tally.malformed += 1;
                    return Ok(());
                };
                tally.requests += 1;
                let response = timed("a request", || boards.ask(*role, &request))?;
                tally.accepted += u64::from(!matches!(response, shared::protocol::Response::Refused(_)));
                let shipped = (&self.session.motion, self.session.tracker.as_ref());
                judge.answered(*role, &request, &response, shipped)
            }
            Step::Datagram(role, bytes) => {
                let Ok((_, datagram)) = decode_datagram(bytes) else {
                    tally.malformed += 1;
                    return Ok(());
                };
                tally.datagrams += 1;
                boards.send(*role, &datagram).map_err(|error| error.to_string())
            }
            Step::Wait(us) => {
                let end_us = boards.outputs().now_us + us;
                tally.ticks += us / 1000;
                while timed("a tick", || boards.advance(end_us))? {
                    judge.look(&boards.outputs())?;
                }
                Ok(())
            }
            Step::EmergencyStop(pressed) => {
                boards.set_emergency_stop(*pressed);
                Ok(())
            }
        }
    }

    /// The fewest of its steps with which something is still wrong, and what that is; `None` if nothing is when they
    /// are done again: the PC was busy, and not the boards.
    pub fn shrink(&self) -> Option<(Vec<Step>, String)> {
        let wrong = |steps: &[Step]| self.run_steps(steps, &mut Tally::default()).err();
        let mut steps = self.steps.clone();
        let (last, mut what) = wrong(&steps)?;
        steps.truncate(last + 1);
        let mut chunk = steps.len() / 2;
        while chunk > 0 {
            let mut at = 0;
            while at < steps.len() {
                let mut fewer = steps.clone();
                fewer.drain(at..(at + chunk).min(steps.len()));
                match wrong(&fewer) {
                    Some((last, now)) => {
                        fewer.truncate(last + 1);
                        (steps, what) = (fewer, now);
                    }
                    None => at += chunk,
                }
            }
            chunk /= 2;
        }
        Some((steps, what))
    }
}

fn role(random: &mut Random) -> Role {
    *random.of(&[Role::Motion, Role::Motion, Role::Tracker])
}

/// Mostly none: many messages come between two ticks \[µs\].
fn wait(random: &mut Random) -> u64 {
    match random.below(100) {
        0..60 => 0,
        60..85 => 1000,
        85..98 => 250 * random.below(40) as u64,
        _ => 1000 * random.below(300) as u64,
    }
}

fn timed<T>(what: &str, act: impl FnOnce() -> T) -> Result<T, String> {
    let began = Instant::now();
    let result = act();
    let took = began.elapsed();
    if took > LONGEST_CALL {
        return Err(format!("{what} took {took:?}"));
    }
    Ok(result)
}
