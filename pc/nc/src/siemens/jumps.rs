//! GOTOF, GOTOB, GOTO, GOTOC, GOTOS and CASE.

use super::calls;
use super::expression;
use super::structures::{Edge, edge};
use super::words;
use crate::branches::Open;
use crate::error::{NcError, Problem, SourcePosition};
use crate::parameters::Lookup;
use crate::reader::Reader;
use crate::scanner::Scanner;

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

/// A line that a jump leads to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Place {
    /// Bytes and lines before it.
    pub(super) offset: u64,
    pub(super) line: u32,
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

/// The block number and the label of a line.
pub(super) fn names(text: &str) -> (Option<u32>, Option<String>) {
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
}

/// Whether a line is more than a comment or a header.
pub(super) fn says_something(text: &str) -> bool {
    !text.trim_start().is_empty() && !text.trim_start().starts_with([';', '%'])
}

/// Hands the lines of the innermost program to `takes`, with the structures around them, until that is enough.
pub(super) fn for_each_line(
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
        seen |= says_something(&text);
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
