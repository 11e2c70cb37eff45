//! What programs of Siemens controllers have besides: `R1=…`, `_NAME=…`, `X=IC(…)`, `MSG("…")` and labels. None of it means anything
//! in RS274/NGC.

use super::block::{Block, Word};
use super::error::{NcError, Problem, SourcePosition};
use super::expression;
use super::parameters::{InBlock, Lookup, Parameter};
use super::program::AXIS_WORDS;
use super::scanner::Scanner;

/// What of Siemens stands at the scanner, if that is no word.
pub(super) fn read(scanner: &mut Scanner, block: &mut Block, lookup: &mut InBlock) -> Result<bool, NcError> {
    if scanner.at_siemens_parameter() {
        return setting(scanner, lookup);
    }
    let start = scanner.mark();
    let letters = scanner.skip_letters();
    scanner.go_back(start);
    if letters < 2 {
        // A word of RS274/NGC.
        return Ok(false);
    }
    let is_read = (block.is_empty() && label(scanner)) || message(scanner, block)? || no_cycle(scanner);
    Ok(is_read || definition(scanner, lookup)?)
}

/// `_NAME=…`.
pub(super) fn variable(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<(), NcError> {
    let place = scanner.place();
    let parameter = expression::variable(scanner);
    scanner.skip_blanks();
    if scanner.peek() != Some('=') {
        return Err(Problem::LooseParameter(parameter.to_string()).at(place));
    }
    scanner.step();
    let value = expression::terms(scanner, lookup, None)?;
    let value = value.ok_or(Problem::NoValue.at(scanner.place()))?;
    lookup.settings.push((parameter, value));
    Ok(())
}

/// `DEF REAL _A, _B=1`: variables, 0 where nothing is said.
fn definition(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<bool, NcError> {
    let start = scanner.mark();
    if scanner.letters() != "DEF" {
        scanner.go_back(start);
        return Ok(false);
    }
    scanner.skip_blanks();
    let place = scanner.place();
    if !["REAL", "INT", "BOOL"].contains(&scanner.letters().as_str()) {
        return Err(Problem::NoDefinition.at(place));
    }
    loop {
        scanner.skip_blanks();
        let place = scanner.place();
        if scanner.peek() != Some('_') {
            return Err(Problem::NoDefinition.at(place));
        }
        let begin = scanner.mark();
        let parameter = expression::variable(scanner);
        scanner.skip_blanks();
        if scanner.peek() == Some('=') {
            scanner.go_back(begin);
            variable(scanner, lookup)?;
            scanner.skip_blanks();
        } else {
            lookup.settings.push((parameter, 0.0));
        }
        if scanner.peek() != Some(',') {
            return Ok(true);
        }
        scanner.step();
    }
}

/// `CYCLE832(…)`, high-speed settings: the speed is planned ahead anyway, within the tolerance of G64. `CYCLE800()` ends
/// a tilted plane, and there is none.
fn no_cycle(scanner: &mut Scanner) -> bool {
    let start = scanner.mark();
    let is_cycle = scanner.letters() == "CYCLE";
    let number = scanner.take(|c| c.is_ascii_digit()).to_owned();
    scanner.skip_blanks();
    if is_cycle && scanner.peek() == Some('(') {
        scanner.step();
        let within = scanner.take(|c| c != ')').trim().len();
        scanner.step();
        if number == "832" || number == "800" && within == 0 {
            return true;
        }
    }
    scanner.go_back(start);
    false
}

/// `NAME:` at the start of a block; there is nothing that jumps to it.
fn label(scanner: &mut Scanner) -> bool {
    let start = scanner.mark();
    scanner.skip_letters();
    scanner.take(|c| c.is_ascii_alphanumeric() || c == '_');
    scanner.skip_blanks();
    let is_label = scanner.peek() == Some(':');
    if is_label {
        scanner.step();
    } else {
        scanner.go_back(start);
    }
    is_label
}

/// `R1=…`.
fn setting(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<bool, NcError> {
    let place = scanner.place();
    let Some(name) = scanner.address() else {
        return Ok(false);
    };
    let digits = name[1..].to_owned();
    let parameter = Parameter::siemens(&digits).ok_or(Problem::SiemensNumber(digits).at(place))?;
    let value = expression::terms(scanner, lookup, None)?;
    let value = value.ok_or(Problem::NoValue.at(scanner.place()))?;
    lookup.settings.push((parameter, value));
    Ok(true)
}

/// `MSG("…")`, as `(MSG,…)`; `MSG()` takes one away, which here nothing shows.
fn message(scanner: &mut Scanner, block: &mut Block) -> Result<bool, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let is_message = scanner.letters() == "MSG";
    scanner.skip_blanks();
    if !is_message || scanner.peek() != Some('(') {
        scanner.go_back(start);
        return Ok(false);
    }
    scanner.step();
    scanner.skip_blanks();
    if scanner.peek() == Some('"') {
        scanner.step();
        let text = scanner.take(|c| c != '"').to_owned();
        block.comments.push((format!("MSG,{text}"), place));
        scanner.step();
        scanner.skip_blanks();
    }
    if scanner.peek() != Some(')') {
        return Err(Problem::NoMessage.at(place));
    }
    scanner.step();
    Ok(true)
}

/// Behind `=`: the value, and whether `IC(…)` makes it a step, or `AC(…)` a coordinate.
pub(super) fn value(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
) -> Result<(Option<f64>, Option<bool>), NcError> {
    scanner.skip_blanks();
    let start = scanner.mark();
    let step = match scanner.letters().as_str() {
        "IC" => Some(true),
        "AC" => Some(false),
        _ => None,
    };
    if step.is_some() && scanner.peek() == Some('(') {
        scanner.step();
        let value = expression::terms(scanner, lookup, Some(')'))?;
        return Ok((value, step));
    }
    scanner.go_back(start);
    Ok((expression::terms(scanner, lookup, None)?, None))
}

/// Behind `T=`: a number in quotation marks, as the name of a tool.
pub(super) fn tool_name(scanner: &mut Scanner) -> Result<Option<f64>, NcError> {
    let start = scanner.mark();
    scanner.skip_blanks();
    if scanner.peek() != Some('"') {
        scanner.go_back(start);
        return Ok(None);
    }
    let place = scanner.place();
    scanner.step();
    let number: Option<u32> = scanner.take(|c| c != '"').trim().parse().ok();
    match number.filter(|_| scanner.peek().is_some()) {
        Some(number) => {
            scanner.step();
            Ok(Some(f64::from(number)))
        }
        None => Err(Problem::ToolName.at(place)),
    }
}

/// Refuses what these words do not go together with.
pub(super) fn check(block: &Block, place: SourcePosition) -> Result<(), NcError> {
    let wrong = block
        .words
        .iter()
        .find(|word| word.step.is_some() && !AXIS_WORDS.contains(&word.address.as_str()));
    if let Some(word) = wrong {
        return Err(word.value_error("IC( ) and AC( ) are for X Y Z A B C"));
    }
    let sets = block
        .settings
        .iter()
        .any(|(parameter, _)| matches!(parameter, Parameter::Siemens(_)));
    if sets && !block.settings_alone() {
        return Err(Problem::SiemensAlone.at(place));
    }
    Ok(())
}

impl Block {
    /// The first word whose IC( ) or AC( ) says how it is meant.
    pub(super) fn own_distance(&self) -> Option<&Word> {
        self.words.iter().find(|word| word.step.is_some())
    }
}
