//! Statements of Siemens programs, each alone in its line behind a block number or a label.

use super::calls::{self, Call, Header};
use super::drilling::{self, Drilling};
use super::expression;
use super::holes::{self, Holes};
use super::jumps::{self, Jump};
use super::keywords;
use super::macros::{self, MacroCall};
use super::repeats::{self, Repeat};
use super::swivel::{self, Swivel};
use super::variables;
use crate::error::{NcError, Problem, SourcePosition};
use crate::parameters::{InBlock, Parameter, Variable};
use crate::reader::Reader;
use crate::scanner::Scanner;

/// A statement with its values, and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    pub(crate) what: What,
    pub(crate) place: SourcePosition,
}

/// What a statement says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    /// What changes nothing here, and a conditional jump whose condition does not hold.
    Nothing,
    /// THEN with parameters.
    Set(Vec<(Parameter, f64)>),
    /// DEF.
    Define(Vec<(String, Variable)>),
    /// IF, with its condition.
    If(bool),
    Else,
    EndIf,
    /// WHILE with its condition, and the number of its DO, or 0.
    While(bool, u8),
    EndWhile(u8),
    /// FOR: the counter, its first and its last value.
    For(Parameter, f64, f64),
    EndFor,
    Loop,
    EndLoop,
    RepeatUntil,
    Until(bool),
    /// GOTOF and its like, with or without IF.
    Jump(Jump),
    /// REPEAT with labels, and REPEATB.
    Repeat(Repeat),
    Call(Call),
    /// G65.
    CallMacro(MacroCall),
    /// PROC.
    Header(Header),
    /// RET.
    Return,
    /// CYCLE81 and its like, here.
    Drill(Drilling),
    /// MCALL: after every motion, or none any more.
    DrillAfterMotions(Option<Drilling>),
    /// HOLES1 and HOLES2.
    DrillAll(Holes),
    /// CYCLE800.
    Swivel(Swivel),
}

/// The statement at the scanner, if there is one.
pub(super) fn read(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<Option<Statement>, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let name = scanner.identifier().to_ascii_uppercase();
    let what = match name.as_str() {
        "DEF" => What::Define(variables::definitions(scanner, lookup)?),
        "IF" => condition(scanner, lookup)?,
        "ELSE" => What::Else,
        "ENDIF" => What::EndIf,
        "WH" if scanner.peek() != Some('[') => {
            scanner.go_back(start);
            return Ok(None);
        }
        // Fanuc's need two letters only.
        "WHILE" | "WH" => {
            let holds = expression::value(scanner, lookup)? != 0.0;
            What::While(holds, macros::number_of_loop(scanner)?)
        }
        "ENDWHILE" => What::EndWhile(0),
        "FOR" => counter(scanner, lookup)?,
        "ENDFOR" => What::EndFor,
        "LOOP" => What::Loop,
        "ENDLOOP" => What::EndLoop,
        "REPEAT" | "REPEATB" => {
            let repeat = repeats::repeat(scanner, lookup, name == "REPEATB")?;
            repeat.map_or(What::RepeatUntil, What::Repeat)
        }
        "UNTIL" => What::Until(expression::value(scanner, lookup)? != 0.0),
        "CASE" => jumps::case(scanner, lookup)?.map_or(What::Nothing, What::Jump),
        "PROC" => What::Header(calls::header(scanner, lookup)?),
        "RET" => What::Return,
        "EXTERN" => {
            scanner.take(|c| c != ';');
            What::Nothing
        }
        "CYCLE800" => What::Swivel(swivel::read(scanner, lookup)?),
        "MCALL" => What::DrillAfterMotions(drilling::modal(scanner, lookup)?),
        name if macros::end_of_loop(name).is_some() => {
            What::EndWhile(macros::end_of_loop(name).unwrap_or_default())
        }
        name if name.starts_with("GOTO")
            && let Some(jump) = macros::jump(name, scanner) =>
        {
            What::Jump(jump)
        }
        name => match jumps::direction(name) {
            Some(direction) => What::Jump(jumps::target(scanner, direction)?),
            None if keywords::cycle_without_effect(name, scanner)? => What::Nothing,
            None => match cycle(name, scanner, lookup, place)? {
                Some(cycle) => cycle,
                None => {
                    scanner.go_back(start);
                    return Ok(None);
                }
            },
        },
    };
    end(scanner)?;
    Ok(Some(Statement { what, place }))
}

/// The cycle or pattern of holes `name`, if it is one.
fn cycle(
    name: &str,
    scanner: &mut Scanner,
    lookup: &mut InBlock,
    place: SourcePosition,
) -> Result<Option<What>, NcError> {
    if let Some(holes) = holes::pattern(name, scanner, lookup, place)? {
        return Ok(Some(What::DrillAll(holes)));
    }
    Ok(drilling::cycle(name, scanner, lookup, place)?.map(What::Drill))
}

/// Nothing but a comment may follow.
pub(super) fn end(scanner: &mut Scanner) -> Result<(), NcError> {
    scanner.skip_blanks();
    match scanner.peek() {
        None | Some(';') => Ok(()),
        Some('(') => {
            scanner.comment()?;
            end(scanner)
        }
        Some(_) => Err(Problem::StatementRest.at(scanner.place())),
    }
}

/// Behind IF: a condition alone, or with a jump.
fn condition(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<What, NcError> {
    let holds = expression::value(scanner, lookup)? != 0.0;
    scanner.skip_blanks();
    let name = scanner.identifier().to_ascii_uppercase();
    if let Some(jump) = macros::jump(&name, scanner) {
        return Ok(if holds { What::Jump(jump) } else { What::Nothing });
    }
    match jumps::direction(&name) {
        Some(direction) => {
            let jump = jumps::target(scanner, direction)?;
            Ok(if holds { What::Jump(jump) } else { What::Nothing })
        }
        None if name == "THEN" => macros::then(scanner, lookup, holds),
        None if name.is_empty() => Ok(What::If(holds)),
        None => Err(Problem::StatementRest.at(scanner.place())),
    }
}

/// Behind FOR: `NAME=1 TO 5`.
fn counter(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<What, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    let wrong = || Problem::NoCounter.at(place);
    let before = lookup.settings.len();
    if !variables::assignment(scanner, lookup)? {
        return Err(wrong());
    }
    scanner.skip_blanks();
    if !scanner.identifier().eq_ignore_ascii_case("TO") {
        return Err(wrong());
    }
    let last = expression::value(scanner, lookup)?;
    let (counter, first) = lookup.settings.drain(before..).next().ok_or_else(wrong)?;
    Ok(What::For(counter, first, last))
}

impl Reader {
    /// What a statement does.
    pub(crate) fn statement(&mut self, statement: Statement) -> Result<(), NcError> {
        let place = statement.place;
        let branches = !matches!(
            statement.what,
            What::Define(_)
                | What::Drill(_)
                | What::DrillAfterMotions(_)
                | What::DrillAll(_)
                | What::Swivel(_)
        );
        self.interpreter.branches |= branches;
        match statement.what {
            What::Nothing => Ok(()),
            What::Set(settings) => settings.into_iter().try_for_each(|(parameter, value)| {
                let set = self.interpreter.set(&parameter, value);
                set.map_err(|problem| problem.at(place))
            }),
            What::Define(variables) => {
                for (name, variable) in variables {
                    self.interpreter.parameters.define(name, variable);
                }
                Ok(())
            }
            What::Jump(jump) => self.jump_to(&jump, place),
            What::Repeat(repeat) => self.repeat(&repeat, place),
            What::Call(call) => self.call_named(call, place),
            What::CallMacro(call) => self.call_macro(call, place),
            What::Header(header) => self.bind(header, place),
            What::Return => self.end_subprogram("RET", place),
            What::Drill(drilling) => self.interpreter.drill(&drilling, place),
            What::DrillAll(holes) => self.interpreter.drill_all(&holes, place),
            What::Swivel(swivel) => self.interpreter.swivel(&swivel, place),
            What::DrillAfterMotions(drilling) => {
                self.interpreter.modal_drilling = drilling;
                Ok(())
            }
            _ => self.structure(statement),
        }
    }
}
