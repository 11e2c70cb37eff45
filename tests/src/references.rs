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
    /// Path ticks by which motion took longer, as elements came late.
    late_ticks: u32,
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
            late_ticks: 0,
        }
    }

    /// By how many ticks the paths that could be compared would have been shorter, had elements come as soon as the board had
    /// room for them: what the PC was too slow for.
    pub fn late_ticks(&self) -> u32 {
        self.late_ticks
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
            Request::Compensate(deviation) => {
                let machine = self.machine.as_mut().expect("it was told before");
                machine.compensate(deviation).expect("the board took it");
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
        let (again, in_motion) = path.play(machine, &status.played, false);
        assert_eq!(again, status.played, "path {}", status.path_id);
        self.same += 1;
        let (_, in_motion_promptly) = path.play(machine, &status.played, true);
        self.late_ticks += in_motion.saturating_sub(in_motion_promptly);
    }
}

impl RecordedPath {
    /// Plays it as a dry run does, for as long as it was played: with elements that come when they came, or `promptly`, as
    /// soon as there is room for them. What was put out, and how many ticks of it were not at rest.
    fn play(&self, machine: &Machine, played: &Played, promptly: bool) -> (Played, u32) {
        let mut planner = Box::new(BoardPlanner::new());
        let limits = machine.plan_limits(&self.limits);
        planner.start(&limits, self.space, self.start_s, &played.start);
        planner.set_override(self.factor);
        let arrivals = self.arrivals.iter();
        let mut coming = arrivals
            .flat_map(|(tick, elements)| elements.iter().map(move |element| (*tick, element)))
            .peekable();
        let mut in_motion = 0;
        loop {
            let ticks = planner.played().ticks;
            let comes = |planner: &BoardPlanner, tick: u32| {
                if promptly {
                    planner.room() > 0
                } else {
                    tick <= ticks
                }
            };
            while let Some((_, element)) = coming.next_if(|(tick, _)| comes(&planner, *tick)) {
                let element = element.build().expect("the board took it");
                planner.push(element).expect("the board had room");
            }
            if ticks == played.ticks {
                return (planner.played(), in_motion);
            }
            let output = planner.tick(&machine.kinematics).expect("the board went there");
            if !output.at_rest {
                in_motion = ticks + 1;
            }
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
