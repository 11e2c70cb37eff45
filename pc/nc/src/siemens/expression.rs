//! Values of Siemens programs behind `=`, in conditions and in arguments: `R1*2+5`, `SIN(30)`, `(R1 > 2) AND (R2 == 3)`.

use super::variables;
use crate::error::{NcError, Problem, SourcePosition};
use crate::expression as rs274;
use crate::parameters::Lookup;
use crate::scanner::Scanner;

/// Deepest nesting of brackets and signs.
const DEEPEST: u32 = 64;
/// Numbers that differ by a smaller part of the larger one are equal.
const EQUAL: f64 = 1e-12;

/// The value at the scanner, up to what does not go on with it. Nothing at the end of the line or before a comment.
pub(crate) fn terms(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<f64>, NcError> {
    scanner.skip_blanks();
    match scanner.peek() {
        None | Some(';') => Ok(None),
        _ => chain(scanner, lookup, 0).map(Some),
    }
}

/// A value that must be there.
pub(crate) fn value(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<f64, NcError> {
    let value = terms(scanner, lookup)?;
    value.ok_or(Problem::NoValue.at(scanner.place()))
}

/// A value and the bracket behind it, inside so many expressions.
pub(super) fn closed(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    open: SourcePosition,
    bracket: char,
    depth: u32,
) -> Result<f64, NcError> {
    let value = chain(scanner, lookup, depth + 1)?;
    close(scanner, open, bracket)?;
    Ok(value)
}

fn close(scanner: &mut Scanner, open: SourcePosition, bracket: char) -> Result<(), NcError> {
    scanner.skip_blanks();
    match scanner.peek() {
        Some(c) if c == bracket => {
            scanner.step();
            Ok(())
        }
        None | Some(';') => Err(Problem::OpenBracket.at(open)),
        Some(c) => Err(Problem::UnknownOperator(c.to_string()).at(scanner.place())),
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Operator {
    Times,
    Over,
    WholeOver,
    Modulo,
    Plus,
    Minus,
    And,
    Xor,
    Or,
    Equal,
    NotEqual,
    Less,
    AtMost,
    Greater,
    AtLeast,
}

impl Operator {
    /// How strongly it binds: on these controllers comparisons bind least.
    fn strength(self) -> u8 {
        match self {
            Self::Times | Self::Over | Self::WholeOver | Self::Modulo => 6,
            Self::Plus | Self::Minus => 5,
            Self::And => 4,
            Self::Xor => 3,
            Self::Or => 2,
            _ => 1,
        }
    }

    fn is_logical(self) -> bool {
        matches!(self, Self::And | Self::Xor | Self::Or)
    }

    fn compares(self) -> bool {
        self.strength() == 1
    }

    /// The operator at the scanner, if there is one.
    fn read(scanner: &mut Scanner) -> Option<Self> {
        scanner.skip_blanks();
        let start = scanner.mark();
        let first = scanner.peek()?;
        if first.is_ascii_alphabetic() {
            let found = match scanner.identifier().to_ascii_uppercase().as_str() {
                "DIV" => Some(Self::WholeOver),
                "MOD" => Some(Self::Modulo),
                "AND" => Some(Self::And),
                "XOR" => Some(Self::Xor),
                "OR" => Some(Self::Or),
                _ => None,
            };
            if found.is_none() {
                scanner.go_back(start);
            }
            return found;
        }
        scanner.step();
        let second = scanner.peek();
        let (found, both) = match (first, second) {
            ('*', _) => (Self::Times, false),
            ('/', _) => (Self::Over, false),
            ('+', _) => (Self::Plus, false),
            ('-', _) => (Self::Minus, false),
            ('=', Some('=')) => (Self::Equal, true),
            ('<', Some('>')) => (Self::NotEqual, true),
            ('<', Some('=')) => (Self::AtMost, true),
            ('>', Some('=')) => (Self::AtLeast, true),
            // << puts texts together.
            ('<', other) if other != Some('<') => (Self::Less, false),
            ('>', _) => (Self::Greater, false),
            _ => {
                scanner.go_back(start);
                return None;
            }
        };
        if both {
            scanner.step();
        }
        Some(found)
    }

    fn apply(self, a: f64, b: f64) -> Result<f64, Problem> {
        let truth = |holds: bool| Ok(f64::from(u8::from(holds)));
        let equal = (a - b).abs() <= EQUAL * a.abs().max(b.abs());
        match self {
            Self::Times => Ok(a * b),
            Self::Over | Self::WholeOver | Self::Modulo if b == 0.0 => Err(Problem::DivisionByZero),
            Self::Over => Ok(a / b),
            Self::WholeOver => Ok((a / b).trunc()),
            Self::Modulo if a < 0.0 || b < 0.0 => Err(Problem::NegativeRemainder),
            Self::Modulo => Ok(a % b),
            Self::Plus => Ok(a + b),
            Self::Minus => Ok(a - b),
            Self::And => truth(a != 0.0 && b != 0.0),
            Self::Xor => truth((a != 0.0) != (b != 0.0)),
            Self::Or => truth(a != 0.0 || b != 0.0),
            Self::Equal => truth(equal),
            Self::NotEqual => truth(!equal),
            Self::Less => truth(a < b && !equal),
            Self::AtMost => truth(a <= b || equal),
            Self::Greater => truth(a > b && !equal),
            Self::AtLeast => truth(a >= b || equal),
        }
    }
}

/// Operands and operators; those of one strength go from left to right.
fn chain(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<f64, NcError> {
    let begin = scanner.place();
    let mut logical = false;
    let mut compares = false;
    // Values and the operators behind them that wait for stronger ones.
    let mut waiting: Vec<(f64, Operator)> = Vec::new();
    loop {
        scanner.skip_blanks();
        let place = scanner.place();
        logical |= at_not(scanner);
        let operand = operand(scanner, lookup, depth)?;
        let mut value = operand.ok_or_else(|| no_value(scanner).at(place))?;
        scanner.skip_blanks();
        let place = scanner.place();
        let operator = Operator::read(scanner);
        logical |= operator.is_some_and(Operator::is_logical);
        compares |= operator.is_some_and(Operator::compares);
        if logical && compares {
            return Err(Problem::ComparisonBrackets.at(begin));
        }
        let strength = operator.map_or(0, Operator::strength);
        while let Some((before, waits)) = waiting.pop() {
            if waits.strength() < strength {
                waiting.push((before, waits));
                break;
            }
            value = waits.apply(before, value).map_err(|problem| problem.at(place))?;
        }
        if !value.is_finite() {
            return Err(Problem::NotFinite.at(begin));
        }
        match operator {
            Some(operator) => waiting.push((value, operator)),
            None => return Ok(value),
        }
    }
}

/// What is wrong where there is no value.
fn no_value(scanner: &Scanner) -> Problem {
    match scanner.peek() {
        Some('"') => Problem::TextValue,
        _ => Problem::NoValue,
    }
}

fn at_not(scanner: &mut Scanner) -> bool {
    let start = scanner.mark();
    let is_not = scanner.identifier().eq_ignore_ascii_case("NOT");
    scanner.go_back(start);
    is_not
}

fn operand(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<Option<f64>, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    if depth > DEEPEST {
        return Err(Problem::TooDeep { deepest: DEEPEST }.at(place));
    }
    match scanner.peek() {
        Some('(') => {
            scanner.step();
            closed(scanner, lookup, place, ')', depth).map(Some)
        }
        Some(sign @ ('+' | '-')) => {
            if let Some(number) = scanner.number()? {
                return Ok(Some(number));
            }
            scanner.step();
            let value = operand(scanner, lookup, depth + 1)?;
            Ok(value.map(|value| if sign == '-' { -value } else { value }))
        }
        Some(c) if c.is_ascii_alphabetic() || c == '_' => named(scanner, lookup, depth),
        Some('$') => constant(scanner),
        _ => rs274::value_at(scanner, lookup, depth + 1),
    }
}

/// `$PI`; other variables of the controller are not known.
fn constant(scanner: &mut Scanner) -> Result<Option<f64>, NcError> {
    let place = scanner.place();
    scanner.step();
    match scanner.identifier().eq_ignore_ascii_case("PI") {
        true => Ok(Some(std::f64::consts::PI)),
        false => Err(Problem::SystemVariable.at(place)),
    }
}

/// A function, variable, constant, or NOT.
fn named(scanner: &mut Scanner, lookup: &mut dyn Lookup, depth: u32) -> Result<Option<f64>, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    if let Some(parameter) = variables::numbered(scanner, lookup, depth)? {
        return Ok(lookup.value(&parameter));
    }
    let name = scanner.identifier().to_ascii_uppercase();
    match name.as_str() {
        "NOT" => {
            let value = operand(scanner, lookup, depth + 1)?;
            return Ok(value.map(|value| f64::from(u8::from(value == 0.0))));
        }
        "TRUE" => return Ok(Some(1.0)),
        "FALSE" => return Ok(Some(0.0)),
        _ => {}
    }
    scanner.skip_blanks();
    if scanner.peek() == Some('(') {
        scanner.step();
        return function(scanner, lookup, &name, place, depth).map(Some);
    }
    scanner.go_back(start);
    if name.starts_with('_') || name.len() > 1 && variables::is_defined(&name, lookup) {
        return variables::value(scanner, lookup, depth).map(Some);
    }
    if let Some(value) = rs274::value_at(scanner, lookup, depth + 1)? {
        return Ok(Some(value));
    }
    Err(Problem::Undefined(name).at(place))
}

/// The value of a function, behind its bracket.
fn function(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    name: &str,
    place: SourcePosition,
    depth: u32,
) -> Result<f64, NcError> {
    let mut arguments = vec![chain(scanner, lookup, depth + 1)?];
    scanner.skip_blanks();
    while scanner.peek() == Some(',') {
        scanner.step();
        arguments.push(chain(scanner, lookup, depth + 1)?);
        scanner.skip_blanks();
    }
    close(scanner, place, ')')?;
    let value = match (name, &arguments[..]) {
        ("POT", [x]) => x * x,
        ("TRUNC", [x]) => x.trunc(),
        ("ROUNDUP", [x]) => x.ceil(),
        ("ATAN2", [y, x]) => y.atan2(*x).to_degrees(),
        ("MINVAL", [a, b]) => a.min(*b),
        ("MAXVAL", [a, b]) => a.max(*b),
        (_, [x]) => match rs274::function_of(name, *x) {
            Some(value) => value.map_err(|problem| problem.at(place))?,
            None => return Err(Problem::UnknownFunction(name.to_owned()).at(place)),
        },
        _ => return Err(Problem::UnknownFunction(name.to_owned()).at(place)),
    };
    match value.is_finite() {
        true => Ok(value),
        false => Err(Problem::NotFinite.at(place)),
    }
}
