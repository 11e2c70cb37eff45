//! The first look at a board that has been flashed: its link, its clocks, its converters, and what it reads while hands move
//! encoders and switches. Nothing is ever enabled.

mod hands;
mod own;

pub use hands::{Hands, Progress, Task};

use config::machine::MachineFile;
use host_link::boards::{Boards, LinkError};
use shared::protocol::{Identity, Inputs, Request, Response, Role};

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As it should be.
    Good,
    /// Not as it should be.
    Bad,
    /// Nobody did it.
    NotDone,
}

/// One step, and what was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// What was looked at.
    pub what: String,
    /// What was found, and what to do if it is bad.
    pub found: String,
    /// Whether that is as it should be.
    pub verdict: Verdict,
}

impl Step {
    fn new(what: &str, good: bool, found: String) -> Self {
        Self {
            what: what.to_owned(),
            found,
            verdict: if good { Verdict::Good } else { Verdict::Bad },
        }
    }
}

/// What was found of one board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoardProtocol {
    /// Who it says it is.
    pub identity: Identity,
    /// All steps, in their order.
    pub steps: Vec<Step>,
}

/// Goes through all steps of a board; `told` hears of each as it ends. With a `machine` only its motors or slides are asked
/// for, and their directions are compared with it.
pub fn look_at(
    boards: &mut dyn Boards,
    role: Role,
    machine: Option<&MachineFile>,
    hands: &mut dyn Hands,
    mut told: impl FnMut(&Step),
) -> Result<BoardProtocol, LinkError> {
    let identity = boards.identity(role).ok_or(LinkError::Absent { role })?.clone();
    let mut steps = Vec::new();
    let mut took = |step: Step| {
        told(&step);
        steps.push(step);
    };
    for step in own::steps(boards, role)? {
        took(step);
    }
    for task in hands::tasks(role, machine) {
        took(hands::watch(boards, role, &task, hands)?);
    }
    took(own::drives_off(boards, role)?);
    Ok(BoardProtocol { identity, steps })
}

fn inputs(boards: &mut dyn Boards, role: Role) -> Result<Inputs, LinkError> {
    match boards.request(role, &Request::Inputs)? {
        Response::Inputs(inputs) => Ok(inputs),
        Response::Refused(refusal) => Err(LinkError::Refused { role, refusal }),
        _ => Err(LinkError::Unexpected { role }),
    }
}
