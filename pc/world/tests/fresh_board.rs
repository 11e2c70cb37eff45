//! The first look at a board: what is wired is found, and what is not is named.

use host_link::boards::{Boards, LinkError};
use job::fresh_board::{Hands, Progress, Step, Verdict, look_at};
use shared::protocol::{Datagram, Identity, Inputs, Request, Response, Role};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;
use world::simulated::SimulatedBoards;

/// Simulated boards whose connectors hands can reach.
struct Reached {
    boards: SimulatedBoards,
    inputs: Rc<RefCell<Inputs>>,
}

impl Boards for Reached {
    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        match self.boards.request(role, request)? {
            Response::Inputs(_) => Ok(Response::Inputs(*self.inputs.borrow())),
            other => Ok(other),
        }
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        self.boards.receive(timeout)
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

/// Moves of the hands for a task, one a look.
type Move = fn(&mut Inputs);

/// Someone who does what `moves` has for a task, and leaves out the others.
struct Person {
    inputs: Rc<RefCell<Inputs>>,
    moves: Vec<(&'static str, Vec<Move>)>,
    left: Option<std::vec::IntoIter<Move>>,
}

impl Hands for Person {
    fn begin(&mut self, task: &str) {
        let moves = self.moves.iter().find(|(of, _)| task.contains(of));
        self.left = moves.map(|(_, moves)| moves.clone().into_iter());
    }

    fn progress(&mut self) -> Progress {
        let Some(left) = &mut self.left else {
            return Progress::NotDone;
        };
        match left.next() {
            Some(next) => {
                next(&mut self.inputs.borrow_mut());
                Progress::Doing
            }
            None => Progress::Done,
        }
    }
}

fn looked_at(role: Role, inputs: Inputs, moves: Vec<(&'static str, Vec<Move>)>) -> Vec<Step> {
    let inputs = Rc::new(RefCell::new(inputs));
    let mut boards = Reached {
        boards: SimulatedBoards::default(),
        inputs: Rc::clone(&inputs),
    };
    let mut person = Person {
        inputs,
        moves,
        left: None,
    };
    let mut told = Vec::new();
    let protocol = look_at(&mut boards, role, None, &mut person, |step| {
        told.push(step.clone())
    });
    let steps = protocol.unwrap_or_else(|error| panic!("{error}")).steps;
    assert_eq!(told, steps);
    steps
}

#[track_caller]
fn step<'a>(steps: &'a [Step], what: &str) -> &'a Step {
    let found = steps.iter().find(|step| step.what == what);
    found.unwrap_or_else(|| panic!("no step {what}: {steps:?}"))
}

#[track_caller]
fn assert_bad(steps: &[Step], what: &str, because: &str) {
    let step = step(steps, what);
    assert_eq!(step.verdict, Verdict::Bad, "{step:?}");
    assert!(step.found.contains(because), "{step:?}");
}

const ALL_OF_Y: [Move; 7] = [
    |inputs| inputs.counts[2] += 3000,
    |inputs| inputs.marks[2] = Some(1200),
    |inputs| inputs.limit_plus |= 1 << 2,
    |inputs| inputs.limit_plus &= !(1 << 2),
    |inputs| inputs.limit_minus |= 1 << 2,
    |inputs| inputs.limit_minus &= !(1 << 2),
    |inputs| inputs.drive_fault ^= 1 << 2,
];

fn all_of_y(last: Move) -> Vec<Move> {
    ALL_OF_Y.into_iter().chain([last]).collect()
}

#[test]
fn a_board_that_is_wired_as_it_should_be_has_no_bad_step() {
    let estop: Vec<Move> = vec![
        |inputs| inputs.estop[0] = true,
        |inputs| inputs.estop[0] = false,
        |inputs| inputs.estop[1] = true,
        |inputs| inputs.estop[1] = false,
    ];
    let moves = vec![
        ("emergency stop", estop),
        ("Y: ", all_of_y(|inputs| inputs.drive_fault ^= 1 << 2)),
    ];
    let steps = looked_at(Role::Motion, Inputs::NONE, moves);
    for what in [
        "requests",
        "converters",
        "ticks",
        "emergency stop",
        "Y",
        "drives off",
    ] {
        let step = step(&steps, what);
        assert_eq!(step.verdict, Verdict::Good, "{step:?}");
    }
    assert!(step(&steps, "Y").found.contains("+3000 counts"));
    for what in ["X1", "Z", "source 2", "input 4"] {
        assert_eq!(step(&steps, what).verdict, Verdict::NotDone);
    }
}

#[test]
fn what_does_not_change_and_what_should_not_are_named() {
    // Channel 2 of the emergency stop is bridged; the ready loop of Y stays open, and the switch of Z is on its wire.
    let estop: Vec<Move> = vec![|inputs| inputs.estop[0] = true, |inputs| inputs.estop[0] = false];
    let moves: Vec<(&str, Vec<Move>)> = vec![
        ("emergency stop", estop),
        ("X1: ", vec![|inputs| inputs.counts[0] -= 500]),
        ("Y: ", all_of_y(|inputs| inputs.limit_plus ^= 1 << 3)),
    ];
    let steps = looked_at(Role::Motion, Inputs::NONE, moves);
    assert_bad(&steps, "emergency stop", "channel 2 did not change");
    assert_bad(&steps, "X1", "no mark of X1 was seen");
    assert_bad(&steps, "Y", "ready of Y changed once and not back");
    assert_bad(&steps, "Y", "limit + of Z changed, too");
}

#[test]
fn slides_are_looked_at_on_the_tracker_board() {
    let steps = looked_at(Role::Tracker, Inputs::NONE, vec![("V1: ", vec![])]);
    assert_bad(&steps, "V1", "encoder of V1 did not change");
    assert_eq!(step(&steps, "ticks").verdict, Verdict::Good);
    assert_eq!(step(&steps, "U2").verdict, Verdict::NotDone);
    assert!(steps.iter().all(|step| step.what != "X1"));
}

#[test]
fn a_converter_that_failed_is_told() {
    let failed = Inputs {
        converter_failed: true,
        ..Inputs::NONE
    };
    let steps = looked_at(Role::Motion, failed, Vec::new());
    assert_bad(&steps, "converters", "reads back something else");
}
