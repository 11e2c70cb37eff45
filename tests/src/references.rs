//! Whether boards put out what a dry run does: the planner by itself, given the same elements at the same ticks.

use host_link::boards::{Boards, LinkError};
use host_link::pass_on;
use shared::motion::Machine;
use shared::protocol::{MotionStatus, PathElement, PathLimits, Request, Response, Role};
use shared::state::State;
use shared::trajectory::{BoardPlanner, PathSpace, Played};

/// Boards of which every path that runs from its beginning to its end untouched is played again by a planner of its own.
pub struct RecordedBoards<'a> {
    boards: &'a mut dyn Boards,
    machine: Option<Machine>,
    factor: f64,
    path: Option<RecordedPath>,
    /// Paths whose references were the same to the bit.
    same: u32,
    /// Paths in which the PC had a hand: holds and overrides have no recorded tick.
    touched: u32,
}

/// What the motion board was told of a path.
struct RecordedPath {
    space: PathSpace,
    start_s: f64,
    limits: PathLimits,
    /// Feed override from the beginning on.
    factor: f64,
    /// Elements, and how many path ticks there were before they came.
    arrivals: Vec<(u32, Vec<PathElement>)>,
    touched: bool,
}

impl<'a> RecordedBoards<'a> {
    /// Of a session that has run nothing yet.
    pub fn new(boards: &'a mut dyn Boards) -> Self {
        Self {
            boards,
            machine: None,
            factor: 1.0,
            path: None,
            same: 0,
            touched: 0,
        }
    }

    /// How many paths were the same to the bit, and how many could not be compared.
    pub fn paths(&self) -> (u32, u32) {
        (self.same, self.touched)
    }

    fn told(&mut self, request: &Request) {
        match request {
            Request::ConfigureMotion(config) => {
                let (machine, _) = Machine::build(config).expect("the board took it");
                self.machine = Some(machine);
            }
            Request::BeginPath {
                space,
                start_s_mm,
                limits,
                ..
            } => {
                self.path = Some(RecordedPath {
                    space: *space,
                    start_s: *start_s_mm,
                    limits: *limits,
                    factor: self.factor,
                    arrivals: Vec::new(),
                    touched: false,
                });
            }
            Request::Override { factor } => self.factor = *factor,
            _ => {}
        }
        let touches = matches!(
            request,
            Request::Override { .. } | Request::Hold | Request::Resume | Request::Back | Request::Stop
        );
        if let (true, Some(path)) = (touches, &mut self.path) {
            path.touched = true;
        }
    }

    /// The machine stands: if it has run a path, that is compared.
    fn stands(&mut self, status: &MotionStatus) {
        if status.state != State::Idle || status.fault.is_some() || status.played.ticks == 0 {
            return;
        }
        let (Some(path), Some(machine)) = (self.path.take(), &self.machine) else {
            return;
        };
        if path.touched {
            self.touched += 1;
            return;
        }
        let again = path.play(machine, &status.played);
        assert_eq!(again, status.played, "path {}", status.path_id);
        self.same += 1;
    }
}

impl RecordedPath {
    /// Plays it as a dry run does, for as long as it was played.
    fn play(&self, machine: &Machine, played: &Played) -> Played {
        let mut planner = Box::new(BoardPlanner::new());
        let limits = machine.plan_limits(&self.limits);
        planner.start(&limits, self.space, self.start_s, &played.start);
        planner.set_override(self.factor);
        let mut arrivals = self.arrivals.iter().peekable();
        loop {
            let ticks = planner.played().ticks;
            while let Some((_, elements)) = arrivals.next_if(|(tick, _)| *tick <= ticks) {
                for element in elements {
                    let element = element.build().expect("the board took it");
                    planner.push(element).expect("the board had room");
                }
            }
            if ticks == played.ticks {
                return planner.played();
            }
            planner.tick(&machine.kinematics).expect("the board went there");
        }
    }
}

impl Boards for RecordedBoards<'_> {
    pass_on!(boards: receive, send, now, identity, path_states_target, last_stall, dropped_datagrams);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        let response = self.boards.request(role, request)?;
        match (request, &response) {
            (_, Response::MotionStatus(status)) => self.stands(status),
            (Request::LoadElements { elements, .. }, Response::Room(room)) => {
                if let (false, Some(path)) = (elements.is_empty(), &mut self.path) {
                    path.arrivals.push((room.tick, elements.to_vec()));
                }
            }
            (_, Response::Done) if role == Role::Motion => self.told(request),
            _ => {}
        }
        Ok(response)
    }
}
