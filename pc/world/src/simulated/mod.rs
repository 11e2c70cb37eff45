//! Both boards in this process: the controllers of the firmware in lockstep with the plant of the emulated
//! boards, no sockets, no wall clock, the same to the bit in every run.
//!
//! Time passes only in [`Boards::receive`] and [`Boards::request`]. Everything that happens has its place in
//! one queue: the ticks of both boards, and datagrams under way. The tracker's clock and tick are offset
//! from the motion board's, as on real boards, so that the relation of the clocks has to be found here too.

mod injected_fault;
mod motion;
mod outputs;
mod tracker;

pub use injected_fault::InjectedFault;
pub use outputs::Outputs;

use crate::emulated::BoardsError;
use host_link::boards::{Boards, LinkError};
use motion::MotionBoard;
use plant_file::{DEFAULT_MACHINE, PlantChoice, PlantFile};
use shared::io::ESTOP_CHANNELS;
use shared::protocol::{ClockReply, ClockRequest, Datagram, Identity, Request, Response, Role};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::time::{Duration, Instant};
use tracker::TrackerBoard;

/// Knots a simulated board has room for, as the real ones.
pub const KNOTS: usize = 512;

/// Time a datagram is under way \[µs\].
const TRANSIT_US: u64 = 300;
/// Time a request and its answer take \[µs\].
const REQUEST_US: u64 = 1000;
/// Servo tick of the motion board \[µs\].
const SERVO_US: u64 = 250;
/// Control tick of the tracker board \[µs\].
const CONTROL_US: u64 = 1000;
/// First control tick: not in phase with the motion board's ticks \[µs\].
const CONTROL_PHASE_US: u64 = 637;
/// What the tracker's clock shows when the motion board's shows 0 \[µs\].
const TRACKER_CLOCK_US: u64 = 40_123_456;

/// An event of the simulation.
#[derive(Clone, Debug)]
enum SimulationEvent {
    ServoTick,
    ControlTick,
    /// A datagram arrives at a board, or at the PC.
    Arrival {
        from: Node,
        to: Node,
        datagram: Box<Datagram>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Node {
    Pc,
    Board(Role),
}

/// Sorted by time, then by order of entry.
#[derive(Clone)]
struct Entry(Reverse<(u64, u64)>, SimulationEvent);

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.cmp(&other.0)
    }
}

/// Two simulated boards with their machine.
#[derive(Clone)]
pub struct SimulatedBoards {
    now_us: u64,
    entered: u64,
    queue: BinaryHeap<Entry>,
    inbox: VecDeque<(Role, Datagram)>,
    motion: MotionBoard,
    tracker: TrackerBoard,
    identities: [Identity; 2],
    cut_off: Option<Role>,
    pace: Option<Pace>,
}

/// What keeps simulated time from running ahead of a clock.
#[derive(Clone, Copy, Debug)]
struct Pace {
    began: Instant,
    /// Simulated time for each unit of the clock's.
    rate: f64,
}

impl Pace {
    /// Waits until the clock is where `now_us` of simulated time is. Time that the computer was too slow for is not made up.
    fn wait_for(&mut self, now_us: u64) {
        let (due, elapsed) = (
            Duration::from_micros(now_us).div_f64(self.rate),
            self.began.elapsed(),
        );
        std::thread::sleep(due.saturating_sub(elapsed));
        self.began += elapsed.saturating_sub(due);
    }
}

impl Default for SimulatedBoards {
    /// Wired to [`DEFAULT_MACHINE`] as shipped.
    fn default() -> Self {
        Self::new(DEFAULT_MACHINE).expect("a shipped plant; a test reads them all")
    }
}

impl SimulatedBoards {
    /// Boards that have just been switched on, wired to a machine called as its kinematics are.
    pub fn new(machine: &str) -> Result<Self, BoardsError> {
        Ok(Self::wired_to(&PlantChoice::Shipped.of(machine)?))
    }

    /// Boards that have just been switched on, wired to this machine.
    pub fn wired_to(plant: &PlantFile) -> Self {
        let identity = |role| Identity::new(role, env!("CARGO_PKG_VERSION"), "simulated", true);
        let mut boards = Self {
            now_us: 0,
            entered: 0,
            queue: BinaryHeap::new(),
            inbox: VecDeque::new(),
            motion: MotionBoard::new(plant.motion()),
            tracker: TrackerBoard::new(plant.slides()),
            identities: [identity(Role::Motion), identity(Role::Tracker)],
            cut_off: None,
            pace: None,
        };
        boards.enter(SERVO_US, SimulationEvent::ServoTick);
        boards.enter(CONTROL_PHASE_US, SimulationEvent::ControlTick);
        boards
    }

    /// Boards for somebody who watches: from now on their time does not run ahead of the clock's times `rate`, above 0. What they
    /// do stays the same to the bit.
    pub fn at_pace(mut self, rate: f64) -> Self {
        self.pace = Some(Pace {
            began: Instant::now(),
            rate,
        });
        self
    }

    /// Presses or releases the emergency stop of both boards.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        self.motion.estop = [pressed; ESTOP_CHANNELS];
        self.tracker.estop = [pressed; ESTOP_CHANNELS];
    }

    fn enter(&mut self, at_us: u64, happening: SimulationEvent) {
        self.entered += 1;
        self.queue.push(Entry(Reverse((at_us, self.entered)), happening));
    }

    fn post(&mut self, from: Node, to: Node, datagram: Datagram) {
        if self.cut_off(from) || self.cut_off(to) {
            return;
        }
        let arrival = SimulationEvent::Arrival {
            from,
            to,
            datagram: Box::new(datagram),
        };
        self.enter(self.now_us + TRANSIT_US, arrival);
    }

    /// The next happening, if it is due by `end_us`.
    fn step(&mut self, end_us: u64) -> bool {
        if self
            .queue
            .peek()
            .is_none_or(|Entry(Reverse((at_us, _)), _)| *at_us > end_us)
        {
            self.now_us = end_us;
            return false;
        }
        let Some(Entry(Reverse((at_us, _)), happening)) = self.queue.pop() else {
            return false;
        };
        self.now_us = at_us;
        match happening {
            SimulationEvent::ServoTick => self.servo_tick(),
            SimulationEvent::ControlTick => self.control_tick(),
            SimulationEvent::Arrival { from, to, datagram } => self.arrive(from, to, *datagram),
        }
        true
    }

    fn servo_tick(&mut self) {
        self.enter(self.now_us + SERVO_US, SimulationEvent::ServoTick);
        let motion = Node::Board(Role::Motion);
        if let Some(path_state) = self.motion.tick(self.now_us) {
            self.post(
                motion,
                Node::Board(Role::Tracker),
                Datagram::PathState(path_state),
            );
        }
        if let Some(telemetry) = self.motion.telemetry() {
            self.post(motion, Node::Pc, Datagram::MotionTelemetry(telemetry));
        }
    }

    fn control_tick(&mut self) {
        self.enter(self.now_us + CONTROL_US, SimulationEvent::ControlTick);
        let tracker = Node::Board(Role::Tracker);
        if self.tracker.frozen {
            self.tracker.plant.advance(&self.tracker.command);
            return;
        }
        let output = self.tracker.tick(self.now_us + TRACKER_CLOCK_US);
        let motion = Node::Board(Role::Motion);
        if let Some(permit) = output.permit {
            self.post(tracker, motion, Datagram::Permit(permit));
        }
        if let Some(capture) = output.capture {
            self.post(tracker, Node::Pc, Datagram::Capture(capture));
        }
        if output.clock_request {
            let asked_us = output.sample.time_us;
            self.tracker.controller.asks_clock(asked_us);
            let request = ClockRequest { asked_us };
            self.post(tracker, motion, Datagram::ClockRequest(request));
        }
        if let Some(telemetry) = self.tracker.telemetry() {
            self.post(tracker, Node::Pc, Datagram::TrackerTelemetry(telemetry));
        }
    }

    /// What a board answers, in no time.
    fn answer(&mut self, role: Role, request: &Request) -> Response {
        match (role, request) {
            (_, Request::Hello { .. }) => {
                Response::Identity(self.identities[usize::from(role == Role::Tracker)].clone())
            }
            (_, Request::Subscribe { .. }) => Response::Session { number: 1 },
            (Role::Motion, Request::PathStatesTo { .. }) => Response::Done,
            (Role::Motion, request) => self.motion.handle(request),
            (Role::Tracker, request) => self.tracker.controller.handle(request, 0),
        }
    }

    /// A datagram has arrived; clock requests are answered as the boards' network does.
    fn arrive(&mut self, from: Node, to: Node, datagram: Datagram) {
        let clock_us = match to {
            Node::Board(Role::Tracker) => self.now_us + TRACKER_CLOCK_US,
            Node::Board(Role::Motion) | Node::Pc => self.now_us,
        };
        match (to, from, datagram) {
            (Node::Board(_), _, Datagram::ClockRequest(request)) => {
                let reply = ClockReply {
                    asked_us: request.asked_us,
                    received_us: clock_us,
                    replied_us: clock_us,
                };
                self.post(to, from, Datagram::ClockReply(reply));
            }
            (Node::Board(Role::Tracker), _, datagram) => {
                self.tracker.controller.datagram(&datagram, clock_us)
            }
            (Node::Board(Role::Motion), _, datagram) => self.motion.datagram(&datagram, clock_us),
            (Node::Pc, Node::Board(role), datagram) => self.inbox.push_back((role, datagram)),
            // The PC does not write to itself.
            (Node::Pc, Node::Pc, _) => {}
        }
    }
}

impl Boards for SimulatedBoards {
    fn wait(&self) -> bool {
        true
    }

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        let end_us = self.now_us + REQUEST_US;
        while self.step(end_us) {}
        Ok(self.answer(role, request))
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let end_us = self.now_us + timeout.as_micros() as u64;
        while self.inbox.is_empty() && self.step(end_us) {}
        if let Some(pace) = &mut self.pace {
            pace.wait_for(self.now_us);
        }
        Ok(self.inbox.pop_front())
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        self.post(Node::Pc, Node::Board(role), datagram.clone());
        Ok(())
    }

    fn now(&self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    fn identity(&self, role: Role) -> Option<&Identity> {
        Some(&self.identities[usize::from(role == Role::Tracker)])
    }

    fn path_states_target(&self) -> Option<Request> {
        Some(Request::PathStatesTo {
            address: [0; 4],
            port: 0,
            session: 1,
        })
    }
}
