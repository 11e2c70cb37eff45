//! M62, M63, M67 and G4: what they do with the next motion.

use super::error::{NcError, Place, Problem};
use super::interpreter::{number_below, value_error};
use super::lexer::Word;
use super::parser::{Block, Code, CodeWord, Group};
use super::program::ProgramEvent;
use shared::protocol::PathAction;

/// M62, M63 or M67 that waits for its motion.
pub(super) struct Pending {
    pub(super) action: PathAction,
    pub(super) code: &'static str,
    pub(super) place: Place,
}

/// What waits for the next motion.
pub(super) enum Waiting {
    /// It takes effect when the motion starts.
    Output(Pending),
    /// The motion starts so much later \[s\].
    Dwell(f64, Place),
}

/// What `block` asks for with the next motion: M62, M63, M67 or G4, which share their words.
pub(super) fn waiting(block: &Block) -> Result<Option<Waiting>, NcError> {
    let dwell = block
        .code(Group::NonModal)
        .filter(|code| code.code == Code::Dwell);
    let (code, own): (_, &[&str]) = match (dwell, block.code(Group::Outputs)) {
        (Some(dwell), Some(output)) => {
            let (first, second) = (dwell.name, output.name);
            return Err(Problem::ModalGroup { first, second }.at(output.place));
        }
        (_, Some(output)) if output.code == Code::Analog => (Some(output), &["E", "Q"]),
        (_, Some(output)) => (Some(output), &["P"]),
        (Some(dwell), None) => (Some(dwell), &["P"]),
        (None, None) => (None, &[]),
    };
    let words = ["P", "E", "Q"].into_iter().filter(|w| !own.contains(w));
    if let Some(word) = words.filter_map(|w| block.word(w)).next() {
        return Err(Problem::Orphan(word.label()).at(word.place));
    }
    match code {
        Some(code) if code.code == Code::Dwell => {
            let p = need(block, code, "P")?;
            if p.value < 0.0 {
                return Err(value_error(p, "a time is 0 s or more"));
            }
            Ok(Some(Waiting::Dwell(p.value, code.place)))
        }
        Some(code) => Ok(Some(Waiting::Output(output(block, code)?))),
        None => Ok(None),
    }
}

fn need<'b>(block: &'b Block, code: &CodeWord, word: &'static str) -> Result<&'b Word, NcError> {
    let missing = Problem::Missing {
        code: code.name,
        word,
    };
    block.word(word).ok_or(missing.at(code.place))
}

fn output(block: &Block, code: &CodeWord) -> Result<Pending, NcError> {
    let action = if code.code == Code::Analog {
        let (e, q) = (need(block, code, "E")?, need(block, code, "Q")?);
        let Some(side) = number_below(e.value, 2) else {
            return Err(value_error(e, "E0 and E1 are the powers of beam 1 and 2"));
        };
        if q.value < 0.0 {
            return Err(value_error(q, "a power is 0 W or more"));
        }
        PathAction::Power { side, watt: q.value }
    } else {
        let p = need(block, code, "P")?;
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
    Ok(Pending {
        action,
        code: code.name,
        place: code.place,
    })
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
