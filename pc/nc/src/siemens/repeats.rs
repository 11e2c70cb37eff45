//! REPEAT and REPEATB with labels: lines that are run again.

use super::expression;
use super::labels::Target;
use crate::error::{NcError, Problem, SourcePosition};
use crate::levels::Called;
use crate::parameters::{InBlock, Lookup};
use crate::reader::Reader;
use crate::scanner::Scanner;
use crate::subroutines::Found;

/// Most passes of a REPEAT.
const MOST_PASSES: f64 = 9999.0;

/// REPEAT and REPEATB with labels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Repeat {
    from: String,
    to: Option<String>,
    /// REPEATB: the line of the label alone.
    line_alone: bool,
    times: u32,
}

/// Behind REPEAT and REPEATB: labels and P; nothing where REPEAT begins a loop.
pub(super) fn repeat(
    scanner: &mut Scanner,
    lookup: &mut InBlock,
    line_alone: bool,
) -> Result<Option<Repeat>, NcError> {
    let mut labels = Vec::new();
    loop {
        scanner.skip_blanks();
        let start = scanner.mark();
        let name = scanner.identifier().to_ascii_uppercase();
        if name.is_empty() || is_count(&name) {
            scanner.go_back(start);
            break;
        }
        labels.push(name);
    }
    let place = scanner.place();
    let times = count(scanner, lookup)?.unwrap_or(1);
    let most = if line_alone { 1 } else { 2 };
    match labels.len() {
        0 if !line_alone => Ok(None),
        0 => Err(Problem::NoTarget.at(place)),
        given if given > most => Err(Problem::StatementRest.at(place)),
        _ => {
            let mut labels = labels.into_iter();
            Ok(Some(Repeat {
                from: labels.next().unwrap_or_default(),
                to: labels.next(),
                line_alone,
                times,
            }))
        }
    }
}

/// `P` or `P3`.
fn is_count(name: &str) -> bool {
    name.strip_prefix('P')
        .is_some_and(|digits| digits.chars().all(|c| c.is_ascii_digit()))
}

/// `P3` or `P=…` behind a call or a REPEAT: how often.
pub(super) fn count(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<u32>, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    if !matches!(scanner.peek(), Some('P' | 'p')) {
        return Ok(None);
    }
    scanner.step();
    scanner.skip_blanks();
    if scanner.peek() == Some('=') {
        scanner.step();
    }
    let times = expression::value(scanner, lookup)?;
    match times.fract() == 0.0 && (0.0..=MOST_PASSES).contains(&times) {
        true => Ok(Some(times as u32)),
        false => Err(Problem::Passes(times).at(place)),
    }
}

impl Reader {
    /// REPEAT and REPEATB: the lines from a label on are run again.
    pub(super) fn repeat(&mut self, repeat: &Repeat, place: SourcePosition) -> Result<(), NcError> {
        let labels = self.labels(place)?;
        let missing = || {
            let to = repeat.to.iter().map(|to| format!(" or {to}"));
            Problem::NoLabel(format!("{}{}", repeat.from, to.collect::<String>())).at(place)
        };
        let places = |name: &str| labels.places(&Target::Label(name.to_owned()));
        let begin = places(&repeat.from).first().ok_or_else(missing)?;
        // The first line with a label from where the part begins on.
        let next = |name: &str| places(name).iter().find(|found| found.line >= begin.line);
        // Up to the line of the second label, of ENDLABEL, or before this one.
        let own = Some(place.line - 1).filter(|own| *own > begin.line);
        let last = match &repeat.to {
            _ if repeat.line_alone => Some(begin.line + 1),
            Some(to) => next(to).map(|found| found.line + 1),
            None => {
                let end = next("ENDLABEL").map(|found| found.line + 1);
                end.into_iter().chain(own).min()
            }
        };
        let last = last.ok_or_else(missing)?;
        match repeat.times {
            0 => Ok(()),
            times => self.enter_part((begin.offset, begin.line), last, times, place),
        }
    }

    /// Lines up to line `last` are run as a subroutine without variables of its own.
    fn enter_part(
        &mut self,
        begins: (u64, u32),
        last: u32,
        times: u32,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let level = self.level();
        let (source, file) = (level.source.clone(), level.file.clone());
        let (offset, line) = begins;
        let found = Found {
            source,
            offset,
            line,
            file,
        };
        self.enter_level(found, Called::Part { last }, times, place)
    }
}
