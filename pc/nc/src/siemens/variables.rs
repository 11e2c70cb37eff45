//! Variables of Siemens programs: R parameters, and those that DEF gives a name and a type.

use super::expression;
use crate::error::{NcError, Problem};
use crate::parameters::{InBlock, Kind, Lookup, Parameter, Variable};
use crate::scanner::Scanner;

/// Most elements of an array.
const MOST_ELEMENTS: f64 = 10_000.0;

/// `R1` or `R[…]`, if one stands at the scanner.
pub(crate) fn numbered(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    depth: u32,
) -> Result<Option<Parameter>, NcError> {
    if !scanner.at_siemens_parameter(true) {
        return Ok(None);
    }
    let place = scanner.place();
    scanner.step();
    let digits = if scanner.peek() == Some('[') {
        scanner.step();
        expression::closed(scanner, lookup, place, ']', depth)?
            .round()
            .to_string()
    } else {
        scanner.take(|c| c.is_ascii_digit()).to_owned()
    };
    let parameter = Parameter::siemens(&digits);
    parameter
        .ok_or(Problem::SiemensNumber(digits).at(place))
        .map(Some)
}

/// Whether the program has defined a variable of this name, in upper case.
pub(super) fn is_defined(name: &str, lookup: &mut dyn Lookup) -> bool {
    let (name, index) = (name.to_owned(), 0);
    lookup.value(&Parameter::Variable { name, index }).is_some()
}

/// `NAME` or `NAME[…]`.
pub(crate) fn named(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    depth: u32,
) -> Result<Parameter, NcError> {
    let name = scanner.identifier().to_ascii_uppercase();
    let mut index = 0;
    if scanner.peek() == Some('[') {
        let place = scanner.place();
        scanner.step();
        let value = expression::closed(scanner, lookup, place, ']', depth)?.round();
        if !(0.0..MOST_ELEMENTS).contains(&value) {
            return Err(Problem::ArrayIndex(value).at(place));
        }
        index = value as u32;
    }
    Ok(Parameter::Variable { name, index })
}

/// `NAME=…`, `_NAME=…`, `NAME[…]=…` or `R1=…`, if one of them stands at the scanner.
pub(super) fn assignment(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<bool, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let parameter = if scanner.at_siemens_parameter(true) {
        // R[…] may be a word of RS274/NGC.
        if !scanner.is_assignment() {
            return Ok(false);
        }
        numbered(scanner, lookup, 0)?
    } else {
        let name = scanner.identifier().to_ascii_uppercase();
        scanner.go_back(start);
        match name.starts_with('_') || name.len() > 1 && is_defined(&name, lookup) {
            true => Some(named(scanner, lookup, 0)?),
            false => None,
        }
    };
    let Some(parameter) = parameter else {
        return Ok(false);
    };
    scanner.skip_blanks();
    if scanner.peek() != Some('=') {
        return Err(Problem::LooseParameter(parameter.to_string()).at(place));
    }
    scanner.step();
    let value = expression::value(scanner, lookup)?;
    lookup.settings.push((parameter, value));
    Ok(true)
}

/// What follows DEF: a type, names, and their values; 0 where nothing is said.
pub(super) fn definitions(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
) -> Result<Vec<(String, Variable)>, NcError> {
    let kind = kind(scanner)?;
    let mut defined = Vec::new();
    loop {
        let name = new_name(scanner)?;
        let place = scanner.place();
        let mut values = vec![0.0];
        if scanner.peek() == Some('[') {
            scanner.step();
            let count = expression::closed(scanner, lookup, place, ']', 0)?;
            if count.fract() != 0.0 || !(1.0..=MOST_ELEMENTS).contains(&count) {
                return Err(Problem::ArrayIndex(count).at(place));
            }
            values = vec![0.0; count as usize];
        }
        scanner.skip_blanks();
        if scanner.peek() == Some('=') {
            scanner.step();
            first_values(scanner, lookup, &mut values)?;
        }
        defined.push((name, Variable::new(kind, values)));
        scanner.skip_blanks();
        if scanner.peek() != Some(',') {
            return Ok(defined);
        }
        scanner.step();
    }
}

/// A value, or several in brackets for the elements of an array.
fn first_values(scanner: &mut Scanner, lookup: &mut dyn Lookup, values: &mut [f64]) -> Result<(), NcError> {
    scanner.skip_blanks();
    let open = scanner.place();
    if values.len() == 1 || scanner.peek() != Some('(') {
        values[0] = expression::value(scanner, lookup)?;
        return Ok(());
    }
    for (index, value) in values.iter_mut().enumerate() {
        scanner.skip_blanks();
        match scanner.peek() {
            Some('(') if index == 0 => scanner.step(),
            Some(',') if index > 0 => scanner.step(),
            _ => break,
        }
        *value = expression::value(scanner, lookup)?;
    }
    scanner.skip_blanks();
    if scanner.peek() != Some(')') {
        return Err(Problem::OpenBracket.at(open));
    }
    scanner.step();
    Ok(())
}

/// A type.
pub(super) fn kind(scanner: &mut Scanner) -> Result<Kind, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    match scanner.identifier().to_ascii_uppercase().as_str() {
        "REAL" => Ok(Kind::Real),
        "INT" => Ok(Kind::Whole),
        "BOOL" => Ok(Kind::Truth),
        _ => Err(Problem::NoDefinition.at(place)),
    }
}

/// A name for a variable: two letters or `_` at least, so that it is no word.
pub(super) fn new_name(scanner: &mut Scanner) -> Result<String, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    let name = scanner.identifier().to_ascii_uppercase();
    let letters = name.chars().take_while(|c| c.is_ascii_alphabetic() || *c == '_');
    match letters.count() {
        0 | 1 => Err(Problem::NoDefinition.at(place)),
        _ => Ok(name),
    }
}

/// The value of a variable that must have one.
pub(crate) fn value(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<f64, NcError> {
    let place = scanner.place();
    let parameter = named(scanner, lookup, depth)?;
    let value = lookup.value(&parameter);
    value.ok_or_else(|| parameter.no_value().at(place))
}
