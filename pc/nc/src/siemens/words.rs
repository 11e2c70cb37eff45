//! Parts of blocks: labels, `MSG("…")`, `X=IC(…)`, `T="…"`.

use super::expression;
use crate::arc::CENTRE_WORDS;
use crate::block::{Block, Distance, Word};
use crate::error::{NcError, Problem, SourcePosition};
use crate::parameters::{Lookup, Parameter};
use crate::program::AXIS_WORDS;
use crate::scanner::Scanner;

/// `NAME:` at the start of a block.
pub(super) fn label(scanner: &mut Scanner) -> bool {
    let start = scanner.mark();
    let named = !scanner.identifier().is_empty();
    scanner.skip_blanks();
    let is_label = named && scanner.peek() == Some(':');
    if is_label {
        scanner.step();
    } else {
        scanner.go_back(start);
    }
    is_label
}

/// `MSG("…")`, as `(MSG,…)`; `MSG()` takes one away, which here nothing shows. Texts and values are put together by `<<`.
pub(super) fn message(
    scanner: &mut Scanner,
    block: &mut Block,
    lookup: &mut dyn Lookup,
) -> Result<bool, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let is_message = scanner.identifier().eq_ignore_ascii_case("MSG");
    scanner.skip_blanks();
    if !is_message || scanner.peek() != Some('(') {
        scanner.go_back(start);
        return Ok(false);
    }
    scanner.step();
    scanner.skip_blanks();
    let text = match scanner.peek() {
        Some(')') => None,
        _ => Some(parts(scanner, lookup, place)?),
    };
    if scanner.peek() != Some(')') {
        return Err(Problem::NoMessage.at(place));
    }
    scanner.step();
    block
        .comments
        .extend(text.map(|text| (format!("MSG,{text}"), place)));
    Ok(true)
}

/// Texts in quotes, and values, with `<<` between them.
fn parts(scanner: &mut Scanner, lookup: &mut dyn Lookup, place: SourcePosition) -> Result<String, NcError> {
    let mut text = String::new();
    loop {
        scanner.skip_blanks();
        match scanner.peek() {
            Some('"') => {
                scanner.step();
                text.push_str(scanner.take(|c| c != '"'));
                scanner.step();
            }
            Some('<') if text.is_empty() => {}
            _ => match expression::value(scanner, lookup) {
                Ok(value) => text.push_str(&value.to_string()),
                Err(error) if matches!(error.problem, Problem::Undefined(_)) => {
                    return Err(Problem::NoMessage.at(place));
                }
                Err(error) => return Err(error),
            },
        }
        scanner.skip_blanks();
        if scanner.peek() != Some('<') {
            return Ok(text);
        }
        scanner.take(|c| c == '<');
    }
}

/// Behind `=`: the value, and how `IC(…)` and its like say it is meant.
pub(crate) fn value(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
) -> Result<(Option<f64>, Option<Distance>), NcError> {
    scanner.skip_blanks();
    let (place, start) = (scanner.place(), scanner.mark());
    let distance = match scanner.letters().as_str() {
        "IC" => Some(Distance::Step),
        "AC" => Some(Distance::Absolute),
        "DC" => Some(Distance::Shortest),
        "ACP" => Some(Distance::Upward),
        "ACN" => Some(Distance::Downward),
        _ => None,
    };
    if distance.is_some() && scanner.peek() == Some('(') {
        scanner.step();
        let value = expression::closed(scanner, lookup, place, ')', 0)?;
        return Ok((Some(value), distance));
    }
    scanner.go_back(start);
    Ok((expression::terms(scanner, lookup)?, None))
}

/// Behind `T=`: the name of a tool in quotation marks.
pub(crate) fn tool_name(scanner: &mut Scanner) -> Result<Option<String>, NcError> {
    let start = scanner.mark();
    scanner.skip_blanks();
    if scanner.peek() != Some('"') {
        scanner.go_back(start);
        return Ok(None);
    }
    let place = scanner.place();
    scanner.step();
    let name = scanner.take(|c| c != '"').trim().to_owned();
    if name.is_empty() || scanner.peek().is_none() {
        return Err(Problem::ToolName.at(place));
    }
    scanner.step();
    Ok(Some(name))
}

/// Refuses what these words do not go together with.
pub(crate) fn check(block: &Block, place: SourcePosition) -> Result<(), NcError> {
    for word in &block.words {
        let Some(distance) = word.distance else { continue };
        if distance.turns() && !["A", "B", "C"].contains(&word.address.as_str()) {
            return Err(word.value_error("DC( ), ACP( ) and ACN( ) are for A B C"));
        }
        let address = word.address.as_str();
        let centre = CENTRE_WORDS.contains(&address) || super::keywords::POINT_WORDS.contains(&address);
        if !AXIS_WORDS.contains(&address) && !centre && address != "AP" && address != "RP" {
            return Err(word.value_error("IC( ) and AC( ) are for X Y Z A B C, I J K, AP and RP"));
        }
    }
    let own = |parameter: &Parameter| matches!(parameter, Parameter::Siemens(_) | Parameter::Variable { .. });
    let sets = block.settings.iter().any(|(parameter, _)| own(parameter));
    if sets && !block.settings_alone() {
        return Err(Problem::SiemensAlone.at(place));
    }
    Ok(())
}

impl Block {
    /// The first axis word that says by IC( ) or its like how it is meant.
    pub(crate) fn own_distance(&self) -> Option<&Word> {
        let mut words = self.words.iter();
        words.find(|word| word.distance.is_some() && AXIS_WORDS.contains(&word.address.as_str()))
    }
}
