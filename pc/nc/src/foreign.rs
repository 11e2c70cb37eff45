//! Blocks as other controllers have them, made into those of the dialect.

use super::block::{Block, CodeWord, Word};
use super::codes::{Code, Group};
use super::error::NcError;

/// Codes that change nothing here, with the words that they may have.
const HINTS: [(&str, &[&str]); 2] = [("G103", &["P"]), ("G187", &["P", "E"])];

/// Gives `block` the codes and words of the dialect where another controller has others for the same.
pub(super) fn adapt(block: &mut Block) -> Result<(), NcError> {
    high_speed(block)?;
    hint(block);
    no_length(block);
    dwell(block);
    Ok(())
}

/// G5.1 with Q, and R or without, is no curve but what other controllers call high-speed machining, as are G5 and G8 with P.
fn high_speed(block: &mut Block) -> Result<(), NcError> {
    let ([code], [first, others @ ..]) = (&block.codes[..], &block.words[..]) else {
        return Ok(());
    };
    let (name, values, why) = match (code.code, first.address.as_str(), others) {
        (Code::CubicSpline, "P", []) => (
            "G5 P",
            [0.0, 10_000.0],
            "P10000 begins high-speed machining, P0 ends it",
        ),
        (Code::Radii, "P", []) => ("G8 P", [0.0, 1.0], "P1 begins high-speed machining, P0 ends it"),
        (Code::QuadraticSpline, "Q", others) if others.iter().all(|word| word.address == "R") => {
            ("G5.1 Q", [0.0, 1.0], "Q1 begins high-speed machining, Q0 ends it")
        }
        _ => return Ok(()),
    };
    if !values.contains(&first.value) {
        return Err(first.value_error(why));
    }
    let place = code.place;
    block.codes = vec![CodeWord::new(name, Code::Hint, Group::Hint, place)];
    block.words.clear();
    Ok(())
}

/// One of [`HINTS`] alone in its block has no use for its words.
fn hint(block: &mut Block) {
    let [code] = &block.codes[..] else {
        return;
    };
    if let Some((_, own)) = HINTS.iter().find(|(name, _)| *name == code.name) {
        block.words.retain(|word| !own.contains(&word.address.as_str()));
    }
}

/// H0 is no length of a tool, with G49 or as a word of its own.
fn no_length(block: &mut Block) {
    let none = |word: &Word| word.address == "H" && word.value == 0.0;
    let Some(place) = block.words.iter().find(|word| none(word)).map(|word| word.place) else {
        return;
    };
    match block.code(Group::ToolLength).map(|code| code.code) {
        Some(Code::TipOff) => {}
        Some(_) => return,
        None => {
            let code = CodeWord::new("H0", Code::TipOff, Group::ToolLength, place);
            block.codes.push(code);
        }
    }
    block.words.retain(|word| !none(word));
}

/// X of G4 is P.
fn dwell(block: &mut Block) {
    let alone = block.codes.iter().all(|code| code.code == Code::Dwell) && !block.codes.is_empty();
    if let [time] = &mut block.words[..]
        && alone
        && time.address == "X"
        && time.distance.is_none()
    {
        "P".clone_into(&mut time.address);
        time.named = false;
    }
}
