//! Loops, jumps and conditions of Fanuc macros: `WHILE [#1 LT 5] DO1` … `END1`, `IF [#1 EQ 5] GOTO 100`, `GOTO 100` and
//! `IF [#1 EQ 5] THEN #2 = 1`. They are carried out as those of Siemens.

use super::jumps::{Direction, Jump};
use super::labels::Target;
use super::statement::What;
use crate::block::setting;
use crate::error::{NcError, Problem};
use crate::parameters::InBlock;
use crate::scanner::Scanner;

/// Numbers of loops: three may be inside each other.
const LOOPS: [(&str, &str); 3] = [("DO1", "END1"), ("DO2", "END2"), ("DO3", "END3")];

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
