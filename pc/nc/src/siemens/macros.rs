//! Loops, jumps and conditions of Fanuc macros: `WHILE [#1 LT 5] DO1` … `END1`, `IF [#1 EQ 5] GOTO 100`, `GOTO 100` and
//! `IF [#1 EQ 5] THEN #2 = 1`. They are carried out as those of Siemens. Calls with arguments: `G65 P1000 A1. B2.`.

use super::jumps::{Direction, Jump};
use super::labels::Target;
use super::statement::{self, Statement, What};
use crate::block::setting;
use crate::error::{NcError, Problem, SourcePosition};
use crate::expression;
use crate::levels::Called;
use crate::parameters::InBlock;
use crate::reader::Reader;
use crate::scanner::Scanner;

/// Numbers of loops: three may be inside each other.
const LOOPS: [(&str, &str); 3] = [("DO1", "END1"), ("DO2", "END2"), ("DO3", "END3")];

/// Letters of arguments, and the numbers of their parameters.
const ARGUMENTS: [(char, u32); 21] = [
    ('A', 1),
    ('B', 2),
    ('C', 3),
    ('I', 4),
    ('J', 5),
    ('K', 6),
    ('D', 7),
    ('E', 8),
    ('F', 9),
    ('H', 11),
    ('M', 13),
    ('Q', 17),
    ('R', 18),
    ('S', 19),
    ('T', 20),
    ('U', 21),
    ('V', 22),
    ('W', 23),
    ('X', 24),
    ('Y', 25),
    ('Z', 26),
];

/// G65.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MacroCall {
    /// P and L.
    number: f64,
    times: f64,
    /// Parameters with their values.
    arguments: Vec<(u32, f64)>,
}

/// What opens and what ends the loop `number`, from 1.
pub(super) fn words(number: u8) -> (&'static str, &'static str) {
    LOOPS
        .get(usize::from(number).wrapping_sub(1))
        .copied()
        .unwrap_or(("WHILE", "ENDWHILE"))
}

/// The number of the loop that `name`, in upper case, ends.
pub(super) fn end_of_loop(name: &str) -> Option<u8> {
    (1..=3).find(|number| words(*number).1 == name)
}

/// Behind the condition of WHILE: the number of its loop, 0 without DO.
pub(super) fn number_of_loop(scanner: &mut Scanner) -> Result<u8, NcError> {
    scanner.skip_blanks();
    let (place, start) = (scanner.place(), scanner.mark());
    if !scanner.letters().eq("DO") {
        scanner.go_back(start);
        return Ok(0);
    }
    scanner.skip_blanks();
    let number = scanner.take(|c| c.is_ascii_digit()).parse().ok();
    number
        .filter(|number| (1..=3).contains(number))
        .ok_or(Problem::MacroLoop.at(place))
}

/// The jump `GOTO 100` or `GOTO100`, whose word and all that is written to it is `name`.
pub(super) fn jump(name: &str, scanner: &mut Scanner) -> Option<Jump> {
    let digits = name.strip_prefix("GOTO")?;
    let start = scanner.mark();
    scanner.skip_blanks();
    let behind = scanner.take(|c| c.is_ascii_digit());
    let number = if digits.is_empty() { behind } else { digits };
    let (direction, number) = (Direction::Either, number.parse().ok());
    let Some(number) = number else {
        scanner.go_back(start);
        return None;
    };
    let target = Target::Number(number);
    Some(Jump { direction, target })
}

/// Behind THEN: parameters that are set, if the condition holds.
pub(super) fn then(scanner: &mut Scanner, lookup: &mut InBlock, holds: bool) -> Result<What, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    if scanner.peek() != Some('#') {
        return Err(Problem::MacroThen.at(place));
    }
    if !holds {
        scanner.take(|c| c != ';' && c != '(');
        return Ok(What::Nothing);
    }
    scanner.step();
    let before = lookup.settings.len();
    setting(scanner, lookup)?;
    Ok(What::Set(lookup.settings.drain(before..).collect()))
}

/// G65 with its arguments, at the scanner.
pub(super) fn call(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<Statement, NcError> {
    let place = scanner.place();
    (0..3).for_each(|_| scanner.step());
    let (mut number, mut times) = (None, None);
    let mut arguments: Vec<(u32, f64)> = Vec::new();
    loop {
        scanner.skip_blanks();
        let place = scanner.place();
        let letter = match scanner.peek() {
            Some('(') => {
                scanner.comment()?;
                continue;
            }
            Some(letter) if letter.is_ascii_alphabetic() => letter.to_ascii_uppercase(),
            _ => break,
        };
        scanner.step();
        let value = expression::value(scanner, lookup)?;
        let value = value.ok_or_else(|| Problem::NoNumber(letter.to_string()).at(place))?;
        let twice = match letter {
            'P' => number.replace(value).is_some(),
            'L' => times.replace(value).is_some(),
            letter => {
                let own = ARGUMENTS.iter().find(|(own, _)| *own == letter);
                let parameter = own.ok_or(Problem::MacroArgument(letter).at(place))?.1;
                let twice = arguments.iter().any(|(own, _)| *own == parameter);
                arguments.push((parameter, value));
                twice
            }
        };
        if twice {
            return Err(Problem::Twice(letter.to_string()).at(place));
        }
    }
    statement::end(scanner)?;
    let (code, word) = ("G65", "P");
    let what = What::CallMacro(MacroCall {
        number: number.ok_or(Problem::Missing { code, word }.at(place))?,
        times: times.unwrap_or(1.0),
        arguments,
    });
    Ok(Statement { what, place })
}

impl Reader {
    /// G65.
    pub(super) fn call_macro(&mut self, call: MacroCall, place: SourcePosition) -> Result<(), NcError> {
        let times = call.times;
        if times.fract() != 0.0 || !(0.0..=9999.0).contains(&times) {
            return Err(Problem::Passes(times).at(place));
        }
        if times == 0.0 {
            return Ok(());
        }
        let by = Called::Macro(call.arguments.clone());
        self.enter(&format!("{}", call.number.round()), by, times as u32, place)?;
        self.interpreter.parameters.enter_macro(&call.arguments);
        Ok(())
    }
}
