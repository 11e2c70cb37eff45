//! M62, M63 and M67: what they switch, and when.

use super::error::{NcError, Place, Problem};
use super::interpreter::{number_below, value_error};
use super::parser::{Block, Code, Group};
use super::program::ProgramEvent;
use shared::protocol::PathAction;

/// M62, M63 or M67 that waits for its motion.
pub(super) struct Pending {
    pub(super) action: PathAction,
    pub(super) code: &'static str,
    pub(super) place: Place,
}

/// The output that `block` asks for, if any.
pub(super) fn output(block: &Block) -> Result<Option<Pending>, NcError> {
    let Some(code) = block.code(Group::Outputs) else {
        return Ok(None);
    };
    let need = |word: &'static str| {
        let missing = Problem::Missing {
            code: code.name,
            word,
        };
        block.word(word).ok_or(missing.at(code.place))
    };
    let foreign: &[&str] = if code.code == Code::Analog {
        &["P"]
    } else {
        &["E", "Q"]
    };
    if let Some(word) = foreign.iter().find_map(|w| block.word(w)) {
        return Err(Problem::Orphan(word.label()).at(word.place));
    }
    let action = if code.code == Code::Analog {
        let (e, q) = (need("E")?, need("Q")?);
        let Some(side) = number_below(e.value, 2) else {
            return Err(value_error(e, "E0 and E1 are the powers of beam 1 and 2"));
        };
        if q.value < 0.0 {
            return Err(value_error(q, "a power is 0 W or more"));
        }
        PathAction::Power { side, watt: q.value }
    } else {
        let p = need("P")?;
        let on = code.code == Code::OutputOn;
        match number_below(p.value, 3) {
            Some(2) => PathAction::Tracking { on },
            Some(side) => PathAction::Beam { side, on },
            None => {
                return Err(value_error(
                    p,
                    "P0 and P1 are the beam gates 1 and 2, P2 is tracking",
                ));
            }
        }
    };
    Ok(Some(Pending {
        action,
        code: code.name,
        place: code.place,
    }))
}

/// The waiting events, which take effect at the start of the motion to target `with_target`.
pub(super) fn take_events(pending: &mut Vec<Pending>, with_target: usize) -> Vec<ProgramEvent> {
    pending
        .drain(..)
        .map(|event| ProgramEvent {
            with_target,
            action: event.action,
            line: event.place.line,
        })
        .collect()
}
