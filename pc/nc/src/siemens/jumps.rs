//! GOTOF, GOTOB, GOTO, GOTOC, GOTOS, CASE, and REPEAT with labels.

use super::calls;
use super::expression;
use super::structures::{Edge, edge};
use super::words;
use crate::branches::Open;
use crate::error::{NcError, Problem, SourcePosition};
use crate::parameters::{InBlock, Lookup};
use crate::reader::{Called, Reader};
use crate::scanner::Scanner;
use crate::subroutines::Found;

/// Most passes of a REPEAT.
const MOST_PASSES: f64 = 9999.0;

/// Where the target of a jump is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Direction {
    Forward,
    Backward,
    /// Forward, then backward.
    Either,
    /// The same; without a target the program goes on (GOTOC).
    OrOn,
    /// The start of the program (GOTOS).
    Start,
}

/// A label, or the number of a block.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Target {
    Start,
    Label(String),
    Number(u32),
}

/// A jump.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Jump {
    direction: Direction,
    target: Target,
}

/// REPEAT and REPEATB with labels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Repeat {
    from: String,
    to: Option<String>,
    /// REPEATB: the line of the label alone.
    line_alone: bool,
    times: u32,
}

/// A line that a jump leads to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Place {
    /// Bytes and lines before it.
    offset: u64,
    line: u32,
    /// Lines that open the structures around it.
    inside: Vec<u32>,
}

/// What a word of a jump says.
pub(super) fn direction(name: &str) -> Option<Direction> {
    Some(match name {
        "GOTOF" => Direction::Forward,
        "GOTOB" => Direction::Backward,
        "GOTO" => Direction::Either,
        "GOTOC" => Direction::OrOn,
        "GOTOS" => Direction::Start,
        _ => return None,
    })
}

/// The label or block number behind a word of a jump.
pub(super) fn target(scanner: &mut Scanner, direction: Direction) -> Result<Jump, NcError> {
    let target = match direction {
        Direction::Start => Target::Start,
        _ => {
            scanner.skip_blanks();
            let place = scanner.place();
            let name = scanner.identifier().to_ascii_uppercase();
            let number = name.strip_prefix('N').and_then(|digits| digits.parse().ok());
            match number {
                Some(number) => Target::Number(number),
                None if name.len() > 1 => Target::Label(name),
                None => return Err(Problem::NoTarget.at(place)),
            }
        }
    };
    Ok(Jump { direction, target })
}

/// Behind CASE: `(value) OF 1 GOTOF A 2 GOTOF B DEFAULT GOTOF C`; the jump of the value, if there is one.
pub(super) fn case(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<Jump>, NcError> {
    let place = scanner.place();
    let value = expression::value(scanner, lookup)?;
    scanner.skip_blanks();
    if !scanner.identifier().eq_ignore_ascii_case("OF") {
        return Err(Problem::NoTarget.at(place));
    }
    let mut taken = None;
    loop {
        scanner.skip_blanks();
        let start = scanner.mark();
        let otherwise = scanner.identifier().eq_ignore_ascii_case("DEFAULT");
        let fits = if otherwise {
            true
        } else {
            scanner.go_back(start);
            match expression::terms(scanner, lookup)? {
                Some(own) => own == value,
                None => return Ok(taken),
            }
        };
        scanner.skip_blanks();
        let name = scanner.identifier().to_ascii_uppercase();
        let direction = direction(&name).ok_or(Problem::NoTarget.at(scanner.place()))?;
        let jump = target(scanner, direction)?;
        if fits && taken.is_none() {
            taken = Some(jump);
        }
        if otherwise {
            return Ok(taken);
        }
    }
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

/// The block number and the label of a line.
fn names(text: &str) -> (Option<u32>, Option<String>) {
    let mut scanner = Scanner::new(text, 0);
    let number = scanner.skip_block_number();
    scanner.skip_blanks();
    let start = scanner.mark();
    let name = scanner.identifier().to_ascii_uppercase();
    scanner.go_back(start);
    (number, words::label(&mut scanner).then_some(name))
}

impl Reader {
    /// The program goes on at the target of a jump.
    pub(super) fn jump_to(&mut self, jump: &Jump, place: SourcePosition) -> Result<(), NcError> {
        let here = place.line;
        let found = match jump.target {
            Target::Start => {
                let (offset, line) = self.level().begins();
                let inside = Vec::new();
                Some(Place { offset, line, inside })
            }
            _ => self.known_target(jump, here, place)?,
        };
        let Some(found) = found else {
            return match jump.direction {
                Direction::OrOn => Ok(()),
                _ => Err(self.no_target(&jump.target, place)),
            };
        };
        self.stay_inside(&found, place)?;
        if found.line < here {
            let level = self.level();
            level.repeats_to = level.repeats_to.max(here);
        }
        self.jump(found.offset, found.line);
        Ok(())
    }

    fn no_target(&self, target: &Target, place: SourcePosition) -> NcError {
        let target = match target {
            Target::Label(name) => name.clone(),
            Target::Number(number) => format!("N{number}"),
            Target::Start => String::new(),
        };
        Problem::NoLabel(target).at(place)
    }

    /// Leaves the structures that are not around the target, which must not be in another one.
    fn stay_inside(&mut self, found: &Place, place: SourcePosition) -> Result<(), NcError> {
        let open = &mut self.level().open;
        let is_open = |(index, line): (usize, &u32)| match open.get(index) {
            Some(Open::Structure(own)) => own.opened == *line,
            _ => false,
        };
        let structures = open.iter().all(|open| matches!(open, Open::Structure(_)));
        if !structures || !found.inside.iter().enumerate().all(is_open) {
            return Err(Problem::JumpInside.at(place));
        }
        open.truncate(found.inside.len());
        Ok(())
    }

    /// The target of the jump in line `here`, which is looked for once.
    fn known_target(
        &mut self,
        jump: &Jump,
        here: u32,
        place: SourcePosition,
    ) -> Result<Option<Place>, NcError> {
        let key = (self.position.file().map(str::to_owned), here, jump.clone());
        if let Some(found) = self.position.jumps.get(&key) {
            return Ok(found.clone());
        }
        let found = self.find_target(jump, here, place)?;
        self.position.jumps.insert(key, found.clone());
        Ok(found)
    }

    fn find_target(
        &mut self,
        jump: &Jump,
        here: u32,
        place: SourcePosition,
    ) -> Result<Option<Place>, NcError> {
        let mut before = None;
        let forward = !matches!(jump.direction, Direction::Backward);
        for_each_line(self, place, |found, text| {
            let (number, label) = names(text);
            let fits = match &jump.target {
                Target::Label(name) => label.as_ref() == Some(name),
                Target::Number(own) => number == Some(*own),
                Target::Start => false,
            };
            let behind = found.line >= here;
            if behind && !forward {
                return true;
            }
            if fits {
                before = Some((behind, found.clone()));
            }
            fits && behind
        })?;
        Ok(before.and_then(|(behind, found)| match jump.direction {
            Direction::Forward if !behind => None,
            _ => Some(found),
        }))
    }

    /// REPEAT and REPEATB: the lines from a label on are run again.
    pub(super) fn repeat(&mut self, repeat: &Repeat, place: SourcePosition) -> Result<(), NcError> {
        let mut part: Option<(Place, u32)> = None;
        let mut closed = false;
        for_each_line(self, place, |found, text| {
            let label = names(text).1;
            let is = |name: &str| label.as_deref() == Some(name);
            let own = found.line + 1 == place.line;
            match &mut part {
                None if is(&repeat.from) => {
                    // Up to the line itself, the one with the second label, or that of ENDLABEL.
                    let last = found.line + 1;
                    part = Some((found.clone(), last));
                    closed = repeat.line_alone || repeat.to.as_ref() == Some(&repeat.from);
                }
                Some((_, last)) if !own => {
                    *last = found.line + 1;
                    closed = match &repeat.to {
                        Some(name) => is(name),
                        None => is("ENDLABEL"),
                    };
                }
                Some(_) => closed = repeat.to.is_none(),
                None => {}
            }
            closed
        })?;
        let Some((begin, last)) = part.filter(|_| closed) else {
            let missing = match &repeat.to {
                Some(to) => format!("{} or {to}", repeat.from),
                None => repeat.from.clone(),
            };
            return Err(Problem::NoLabel(missing).at(place));
        };
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

/// Hands the lines of the innermost program to `takes`, with the structures around them, until that is enough.
fn for_each_line(
    reader: &mut Reader,
    place: SourcePosition,
    mut takes: impl FnMut(&Place, &str) -> bool,
) -> Result<(), NcError> {
    let level = reader.level();
    let (begin, mut line) = level.begins();
    let last = level.last_line();
    let mut lines = level.source.lines(begin);
    let mut inside = Vec::new();
    let mut seen = false;
    while line < last {
        let read = lines
            .next()
            .map_err(|error| Problem::Unreadable(error.to_string()).at(place))?;
        let Some(text) = read else { break };
        if seen && calls::begins_program(&text) {
            break;
        }
        seen |= !text.trim_start().is_empty() && !text.trim_start().starts_with([';', '%']);
        let edge = edge(&text);
        if edge == Some(Edge::Closes) {
            inside.pop();
        }
        let offset = lines.line_start;
        let found = Place {
            offset,
            line,
            inside: inside.clone(),
        };
        if takes(&found, &text) {
            break;
        }
        line += 1;
        if edge == Some(Edge::Opens) {
            inside.push(line);
        }
    }
    Ok(())
}
