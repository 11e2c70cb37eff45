//! Numbers of a line: literal, from parameters, or computed, as LinuxCNC does.

use super::error::{NcError, Problem};
use super::parameters::{Lookup, Parameter};
use super::scanner::Scanner;
use super::siemens::variables;

/// Deepest nesting of brackets and minus signs.
const DEEPEST: u32 = 64;
/// Numbers nearer than this are equal for EQ and NE.
const EQUAL: f64 = 1e-5;

/// Reads one number at the scanner: a literal, `#…`, `[…]`, a function, or one of these after a sign.
///
/// # Errors
/// What cannot be read or computed. Nothing but a letter, blank or other mark is `None`.
pub(super) fn value(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<f64>, NcError> {
    value_at(scanner, lookup, 0)
}

/// The same with operators behind it, as macros have them without brackets: `#2*3+1`. Only those that are marks, as letters begin
/// words.
pub(super) fn terms(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<f64>, NcError> {
    let start = scanner.mark();
    let first = value(scanner, lookup)?;
    scanner.skip_blanks();
    match (first, scanner.peek()) {
        (Some(_), Some('+' | '-' | '*' | '/')) => {
            scanner.go_back(start);
            chain(scanner, lookup, 0, Operator::read_mark).map(Some)
        }
        _ => Ok(first),
    }
}

/// `#` with its number or name; the scanner is behind the `#`.
pub(super) fn parameter(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Parameter, NcError> {
    parameter_at(scanner, lookup, 0)
}

/// The same inside so many expressions.
pub(super) fn value_at(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    depth: u32,
) -> Result<Option<f64>, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    if depth > DEEPEST {
        return Err(Problem::TooDeep { deepest: DEEPEST }.at(place));
    }
    let sign = match scanner.peek() {
        Some('-') => -1.0,
        Some('+') => 1.0,
        _ => return unsigned(scanner, lookup, depth),
    };
    if let Some(number) = scanner.number()? {
        return Ok(Some(number));
    }
    scanner.step();
    Ok(value_at(scanner, lookup, depth + 1)?.map(|value| sign * value))
}

fn unsigned(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<Option<f64>, NcError> {
    match scanner.peek() {
        Some('0'..='9' | '.') => scanner.number(),
        Some('[') => bracket(scanner, lookup, depth + 1).map(Some),
        Some('#') => {
            let place = scanner.place();
            scanner.step();
            let parameter = parameter_at(scanner, lookup, depth + 1)?;
            let value = lookup.value(&parameter);
            let value = value.ok_or_else(|| parameter.no_value().at(place))?;
            Ok(Some(value))
        }
        Some('_') => variables::value(scanner, lookup, depth).map(Some),
        Some('R' | 'r') if scanner.at_siemens_parameter(false) => {
            let parameter = variables::numbered(scanner, lookup, depth)?;
            Ok(parameter.and_then(|parameter| lookup.value(&parameter)))
        }
        Some(c) if c.is_ascii_alphabetic() => function(scanner, lookup, depth),
        _ => Ok(None),
    }
}

fn parameter_at(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<Parameter, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    if scanner.peek() == Some('<') {
        return scanner.name().map(Parameter::Named);
    }
    let number = value_at(scanner, lookup, depth + 1)?;
    let number = number.ok_or(Problem::NoNumber("#".to_owned()).at(place))?;
    Parameter::numbered(number).ok_or(Problem::ParameterNumber(number).at(place))
}

/// Operators by how strongly they bind, the strongest first.
#[derive(Clone, Copy, PartialEq)]
enum Operator {
    Power,
    Times,
    Over,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    AtLeast,
    Less,
    AtMost,
    And,
    Or,
    Xor,
    Close,
}

impl Operator {
    fn strength(self) -> u8 {
        match self {
            Self::Power => 5,
            Self::Times | Self::Over | Self::Modulo => 4,
            Self::Plus | Self::Minus => 3,
            Self::Equal | Self::NotEqual | Self::Greater | Self::AtLeast | Self::Less | Self::AtMost => 2,
            Self::And | Self::Or | Self::Xor => 1,
            Self::Close => 0,
        }
    }

    /// The operator at the scanner, outside of brackets: what is none ends the expression.
    fn read_mark(scanner: &mut Scanner) -> Result<Self, NcError> {
        match scanner.peek() {
            Some('+' | '-' | '*' | '/') => Self::read(scanner),
            _ => Ok(Self::Close),
        }
    }

    /// The operator at the scanner.
    fn read(scanner: &mut Scanner) -> Result<Self, NcError> {
        scanner.skip_blanks();
        let place = scanner.place();
        let unknown = |scanner: &Scanner| match scanner.peek() {
            Some(c) => Problem::UnknownOperator(c.to_string()).at(place),
            None => Problem::NoBracket.at(place),
        };
        let operator = match scanner.peek() {
            Some('+') => Self::Plus,
            Some('-') => Self::Minus,
            Some('/') => Self::Over,
            Some(']') => Self::Close,
            Some('*') => {
                scanner.step();
                if scanner.peek() != Some('*') {
                    return Ok(Self::Times);
                }
                Self::Power
            }
            Some(c) if c.is_ascii_alphabetic() => {
                let word = scanner.letters();
                return match word.as_str() {
                    "MOD" => Ok(Self::Modulo),
                    "EQ" => Ok(Self::Equal),
                    "NE" => Ok(Self::NotEqual),
                    "GT" => Ok(Self::Greater),
                    "GE" => Ok(Self::AtLeast),
                    "LT" => Ok(Self::Less),
                    "LE" => Ok(Self::AtMost),
                    "AND" => Ok(Self::And),
                    "OR" => Ok(Self::Or),
                    "XOR" => Ok(Self::Xor),
                    _ => Err(Problem::UnknownOperator(word).at(place)),
                };
            }
            _ => return Err(unknown(scanner)),
        };
        scanner.step();
        Ok(operator)
    }

    fn apply(self, a: f64, b: f64) -> Result<f64, Problem> {
        let truth = |holds: bool| Ok(f64::from(u8::from(holds)));
        let equal = (a - b).abs() < EQUAL;
        match self {
            Self::Power if a < 0.0 && b.fract() != 0.0 => Err(Problem::Power),
            Self::Power => Ok(a.powf(b)),
            Self::Times => Ok(a * b),
            Self::Over if b == 0.0 => Err(Problem::DivisionByZero),
            Self::Over => Ok(a / b),
            Self::Modulo if b == 0.0 => Err(Problem::DivisionByZero),
            // The remainder is never negative.
            Self::Modulo => Ok((a % b) + if a % b < 0.0 { b.abs() } else { 0.0 }),
            Self::Plus => Ok(a + b),
            Self::Minus => Ok(a - b),
            Self::Equal => truth(equal),
            Self::NotEqual => truth(!equal),
            Self::Greater => truth(a > b),
            Self::AtLeast => truth(a >= b),
            Self::Less => truth(a < b),
            Self::AtMost => truth(a <= b),
            Self::And => truth(a != 0.0 && b != 0.0),
            Self::Or => truth(a != 0.0 || b != 0.0),
            Self::Xor => truth((a != 0.0) != (b != 0.0)),
            Self::Close => Ok(a),
        }
    }
}

/// `[…]`, with the scanner at the bracket. Operators of one strength go from left to right.
fn bracket(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<f64, NcError> {
    let open = scanner.place();
    scanner.step();
    if let Some(holds) = vacancy(scanner, lookup)? {
        return Ok(f64::from(u8::from(holds)));
    }
    chain(scanner, lookup, depth, |scanner| match scanner.peek() {
        None => Err(Problem::OpenBracket.at(open)),
        Some(_) => Operator::read(scanner),
    })
}

/// `#1 EQ #0]` and `#1 NE #0]`, behind the bracket: whether the parameter has no value, or has one.
fn vacancy(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<bool>, NcError> {
    let place = scanner.place();
    let Some((number, operator)) = scanner.vacancy() else {
        return Ok(None);
    };
    let vacant = !lookup.has_value(number);
    if !vacant && lookup.value(&Parameter::Numbered(number)) == Some(0.0) {
        return Err(Problem::EqualsVacant(number).at(place));
    }
    Ok(Some(vacant == (operator == "EQ")))
}

/// Values and operators, up to the one that closes them.
fn chain(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    depth: u32,
    read: impl Fn(&mut Scanner) -> Result<Operator, NcError>,
) -> Result<f64, NcError> {
    let open = scanner.place();
    // Values and the operators behind them that wait for stronger ones.
    let mut waiting: Vec<(f64, Operator)> = Vec::new();
    loop {
        scanner.skip_blanks();
        let place = scanner.place();
        let mut value = value_at(scanner, lookup, depth + 1)?.ok_or(Problem::NoValue.at(place))?;
        scanner.skip_blanks();
        let place = scanner.place();
        let operator = read(scanner)?;
        while let Some((before, waits)) = waiting.pop() {
            if waits.strength() < operator.strength() {
                waiting.push((before, waits));
                break;
            }
            value = waits.apply(before, value).map_err(|problem| problem.at(place))?;
        }
        if !value.is_finite() {
            return Err(Problem::NotFinite.at(open));
        }
        if operator == Operator::Close {
            return Ok(value);
        }
        waiting.push((value, operator));
    }
}

/// A function with its argument in brackets; nothing if the letters are none.
fn function(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<Option<f64>, NcError> {
    let place = scanner.place();
    let start = scanner.mark();
    let name = scanner.letters();
    scanner.skip_blanks();
    if scanner.peek() != Some('[') {
        scanner.go_back(start);
        return Ok(None);
    }
    if name == "EXISTS" {
        return exists(scanner, lookup).map(Some);
    }
    let x = bracket(scanner, lookup, depth + 1)?;
    let value = match name.as_str() {
        "FIX" => x.floor(),
        "FUP" => x.ceil(),
        "ATAN" => {
            scanner.skip_blanks();
            if scanner.peek() != Some('/') {
                return Err(Problem::NoSlash.at(scanner.place()));
            }
            scanner.step();
            scanner.skip_blanks();
            if scanner.peek() != Some('[') {
                return Err(Problem::NoSlash.at(scanner.place()));
            }
            let under = bracket(scanner, lookup, depth + 1)?;
            x.atan2(under).to_degrees()
        }
        _ => match function_of(&name, x) {
            Some(value) => value.map_err(|problem| problem.at(place))?,
            None => return Err(Problem::UnknownFunction(name).at(place)),
        },
    };
    if value.is_finite() {
        Ok(Some(value))
    } else {
        Err(Problem::NotFinite.at(place))
    }
}

/// The value of a function of one argument, upper case; nothing if it is none.
pub(super) fn function_of(name: &str, x: f64) -> Option<Result<f64, Problem>> {
    let wrong = |reason| {
        let (name, value) = (name.to_owned(), x);
        Some(Err(Problem::Argument { name, value, reason }))
    };
    Some(Ok(match name {
        "ABS" => x.abs(),
        "ACOS" if x.abs() > 1.0 => return wrong("it must be from -1 to 1"),
        "ACOS" => x.acos().to_degrees(),
        "ASIN" if x.abs() > 1.0 => return wrong("it must be from -1 to 1"),
        "ASIN" => x.asin().to_degrees(),
        "COS" => x.to_radians().cos(),
        "EXP" => x.exp(),
        "LN" if x <= 0.0 => return wrong("it must be above 0"),
        "LN" => x.ln(),
        "ROUND" => x.round(),
        "SIN" => x.to_radians().sin(),
        "SQRT" if x < 0.0 => return wrong("it must not be negative"),
        "SQRT" => x.sqrt(),
        "TAN" => x.to_radians().tan(),
        _ => return None,
    }))
}

/// `EXISTS[#<name>]`: 1 if it has a value.
fn exists(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<f64, NcError> {
    let open = scanner.place();
    scanner.step();
    scanner.skip_blanks();
    if scanner.peek() != Some('#') {
        return Err(Problem::NoName.at(scanner.place()));
    }
    scanner.step();
    let parameter = parameter(scanner, lookup)?;
    if lookup.is_set_here(&parameter) {
        return Err(Problem::ExistsHere(parameter.to_string()).at(open));
    }
    scanner.skip_blanks();
    if scanner.peek() != Some(']') {
        return Err(Problem::OpenBracket.at(open));
    }
    scanner.step();
    Ok(f64::from(u8::from(lookup.value(&parameter).is_some())))
}
