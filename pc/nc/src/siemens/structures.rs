//! IF, WHILE, FOR, LOOP and REPEAT … UNTIL of Siemens programs: which line is the next one.

use super::macros;
use super::statement::{Statement, What};
use crate::branches::Open;
use crate::error::{NcError, Problem, SourcePosition};
use crate::line_parts;
use crate::parameters::{Lookup, Parameter};
use crate::reader::Reader;
use crate::scanner::Scanner;

/// A loop or condition that is open.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    form: Form,
    /// Line that opens it.
    pub(crate) opened: u32,
    /// Bytes and lines before where the next pass begins.
    back: (u64, u32),
    /// What conditions depended on there.
    conditions: u64,
}

#[derive(Clone, Debug, PartialEq)]
enum Form {
    If,
    /// With the number of its DO, or 0.
    While(u8),
    /// The counter, and its last value.
    For(Parameter, f64),
    Loop,
    Repeat,
}

impl Form {
    /// What opens and what ends it.
    fn words(&self) -> (&'static str, &'static str) {
        match self {
            Self::If => ("IF", "ENDIF"),
            Self::While(number) => macros::words(*number),
            Self::For(..) => ("FOR", "ENDFOR"),
            Self::Loop => ("LOOP", "ENDLOOP"),
            Self::Repeat => ("REPEAT", "UNTIL"),
        }
    }
}

impl Structure {
    pub(crate) fn loops(&self) -> bool {
        self.form != Form::If
    }

    /// Its end is missing.
    pub(crate) fn no_end(&self, place: SourcePosition) -> NcError {
        let (keyword, wanted) = self.form.words();
        Problem::StructureEnd { keyword, wanted }.at(place)
    }
}

/// What a line means for the structures around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    Opens,
    Else,
    Closes,
}

/// What the statement of a line, if there is one, means for the structures around it.
pub(super) fn edge(text: &str) -> Option<Edge> {
    match line_parts::of(text) {
        Some(parts) => parts.iter().find_map(|part| edge_of_statement(part)),
        None => edge_of_statement(text),
    }
}

fn edge_of_statement(text: &str) -> Option<Edge> {
    let mut scanner = Scanner::new(text, 0);
    scanner.skip_block_number();
    super::words::label(&mut scanner);
    scanner.skip_blanks();
    let name = scanner.identifier();
    let is = |names: &[&str]| names.iter().any(|own| name.eq_ignore_ascii_case(own));
    if is(&["ELSE"]) {
        return Some(Edge::Else);
    }
    if is(&[
        "ENDIF", "ENDWHILE", "ENDFOR", "ENDLOOP", "UNTIL", "END1", "END2", "END3",
    ]) {
        return Some(Edge::Closes);
    }
    if is(&["WHILE", "WH", "FOR", "LOOP"]) {
        return Some(Edge::Opens);
    }
    let (is_if, is_repeat) = (is(&["IF"]), is(&["REPEAT"]));
    let rest = scanner.take(|c| c != ';').to_ascii_uppercase();
    // With a jump or with labels both are a line of their own.
    let line = rest.contains("GOTO") || rest.contains("THEN");
    let opens = is_if && !line || is_repeat && rest.trim().is_empty();
    opens.then_some(Edge::Opens)
}

impl Reader {
    /// What a statement about structures does.
    pub(super) fn structure(&mut self, statement: Statement) -> Result<(), NcError> {
        let place = statement.place;
        let here = (self.level().offset, self.level().line);
        let itself = (self.start_of_line(), here.1 - 1);
        let before = self.conditions_before;
        match statement.what {
            What::If(holds) => self.begin_if(holds, place)?,
            What::Else => {
                self.close_structure(&Form::If, "ELSE", place)?;
                // A second ELSE would be its next part.
                while self.skip(Form::If, place)? == Edge::Else {}
            }
            What::EndIf => drop(self.close_structure(&Form::If, "ENDIF", place)?),
            What::While(true, number) => self.open(Form::While(number), itself, before),
            What::While(false, number) => drop(self.skip(Form::While(number), place)?),
            What::EndWhile(number) => self.again(Form::While(number), macros::words(number).1, place)?,
            What::For(counter, first, last) => {
                let now = self.interpreter.set(&counter, first);
                now.map_err(|problem| problem.at(place))?;
                let form = Form::For(counter, last);
                match first <= last {
                    true => self.open(form, here, before),
                    false => drop(self.skip(form, place)?),
                }
            }
            What::EndFor => self.next_count(place)?,
            What::Loop => self.open(Form::Loop, here, before),
            What::EndLoop => self.again(Form::Loop, "ENDLOOP", place)?,
            What::RepeatUntil => self.open(Form::Repeat, here, before),
            What::Until(false) => self.again(Form::Repeat, "UNTIL", place)?,
            What::Until(true) => drop(self.close_structure(&Form::Repeat, "UNTIL", place)?),
            _ => {}
        }
        Ok(())
    }

    /// The part behind IF is run, or that behind its ELSE, if there is one.
    fn begin_if(&mut self, holds: bool, place: SourcePosition) -> Result<(), NcError> {
        if holds || self.skip(Form::If, place)? == Edge::Else {
            // A condition is not gone back to.
            self.open(Form::If, (0, 0), 0);
        }
        Ok(())
    }

    fn open(&mut self, form: Form, back: (u64, u32), conditions: u64) {
        let opened = self.position.here().line;
        self.level().open.push(Open::Structure(Structure {
            form,
            opened,
            back,
            conditions,
        }));
    }

    /// Takes the innermost structure, which must be of the form that `keyword` ends.
    fn close_structure(
        &mut self,
        form: &Form,
        keyword: &'static str,
        place: SourcePosition,
    ) -> Result<Structure, NcError> {
        let wanted = form.words().0;
        match self.level().open.pop() {
            Some(Open::Structure(own)) if own.form.words().0 == wanted => Ok(own),
            _ => Err(Problem::StructureEnd { keyword, wanted }.at(place)),
        }
    }

    /// A loop ends with another pass; one that would go on without end, as nothing was set in it, is refused.
    fn again(&mut self, form: Form, keyword: &'static str, place: SourcePosition) -> Result<(), NcError> {
        let open = self.close_structure(&form, keyword, place)?;
        let now = self.interpreter.conditions();
        if now == open.conditions {
            return Err(Problem::SameAgain(open.form.words().0.to_owned()).at(place));
        }
        let (offset, line) = open.back;
        if !matches!(open.form, Form::While(_)) {
            // WHILE opens itself again.
            let conditions = now;
            self.level()
                .open
                .push(Open::Structure(Structure { conditions, ..open }));
        }
        self.jump(offset, line);
        Ok(())
    }

    /// ENDFOR.
    fn next_count(&mut self, place: SourcePosition) -> Result<(), NcError> {
        let any = Form::For(Parameter::Siemens(0), 0.0);
        let open = self.close_structure(&any, "ENDFOR", place)?;
        let Form::For(counter, last) = &open.form else {
            return Ok(());
        };
        let value = self.interpreter.value(counter).unwrap_or(0.0) + 1.0;
        self.interpreter
            .set(counter, value)
            .map_err(|problem| problem.at(place))?;
        if value <= *last {
            let (offset, line) = open.back;
            self.level().open.push(Open::Structure(open));
            self.jump(offset, line);
        }
        Ok(())
    }

    /// Goes over lines to the end of a structure that begins in this one, or to its ELSE, and behind it.
    fn skip(&mut self, form: Form, place: SourcePosition) -> Result<Edge, NcError> {
        let mut inside = 0;
        while let Some(text) = self.next_line()? {
            match edge(&text) {
                Some(Edge::Opens) => inside += 1,
                Some(Edge::Closes) if inside == 0 => return Ok(Edge::Closes),
                Some(Edge::Closes) => inside -= 1,
                Some(Edge::Else) if inside == 0 => return Ok(Edge::Else),
                _ => {}
            }
        }
        let (keyword, wanted) = form.words();
        Err(Problem::StructureEnd { keyword, wanted }.at(place))
    }
}
