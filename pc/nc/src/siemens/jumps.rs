//! GOTOF, GOTOB, GOTO, GOTOC, GOTOS and CASE.

use super::expression;
use super::labels::{Place, Target};
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

/// A jump.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Jump {
    pub(super) direction: Direction,
    pub(super) target: Target,
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
            _ => self.find_target(jump, here, place)?,
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

    /// The target of the jump in line `here`.
    fn find_target(
        &mut self,
        jump: &Jump,
        here: u32,
        place: SourcePosition,
    ) -> Result<Option<Place>, NcError> {
        let labels = self.labels(place)?;
        let places = labels.places(&jump.target);
        let behind = places.partition_point(|found| found.line < here);
        let forward = places.get(behind);
        let backward = places[..behind].last();
        let found = match jump.direction {
            Direction::Forward => forward,
            Direction::Backward => backward,
            Direction::Either | Direction::OrOn | Direction::Start => forward.or(backward),
        };
        Ok(found.cloned())
    }
}
