//! Lines of a program one after the other: loops, conditions and subroutines decide which is the next.

use super::answers::Again;
use super::block::{Parsed, Skipped, parse};
use super::branches::Open;
use super::effort::Effort;
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::levels::{Called, Level};
use super::line_parts;
use super::parameters::Parameter;
use super::program::Program;
use super::setup::Options;
use super::siemens::calls;
use super::siemens::labels::Labels;
use super::source::{Lines, Source};
use super::subroutines::Found;
use std::collections::BTreeMap;
use std::sync::Arc;

/// How far a program has been run.
#[derive(Clone)]
pub(super) struct Position {
    /// The innermost subroutine last; the main program is always there.
    pub(super) levels: Vec<Level>,
    pub(super) found: BTreeMap<String, Found>,
    /// Labels of programs, by file, the lines before them and their last one.
    pub(super) labels: BTreeMap<(Option<String>, u32, u32), Arc<Labels>>,
    /// Anything but blank lines was seen.
    seen: bool,
    /// The main program has come to the number of a subroutine.
    pub(super) in_subroutine: bool,
    /// Lines that were run.
    pub(super) executed: u64,
    effort: Effort,
}

impl Position {
    /// The line that was read last.
    pub(super) fn here(&self) -> SourcePosition {
        let line = self.levels.last().map_or(0, |level| level.line);
        SourcePosition { line, column: 1 }
    }

    /// How many subroutines run.
    pub(super) fn depth(&self) -> usize {
        self.levels.len() - 1
    }

    /// Name of the file of the innermost one, if it has one of its own.
    pub(super) fn file(&self) -> Option<&str> {
        self.levels.last()?.file.as_deref()
    }
}

/// The line that was carried out last.
pub(super) struct Ran {
    pub(super) text: String,
    /// Parameters that it set.
    pub(super) settings: Vec<(Parameter, f64)>,
    pub(super) kind: Kind,
}

/// What a line is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing but blanks, comments or a tape mark.
    Blank,
    /// Left out by block delete.
    Deleted,
    /// An O word, or a statement of Siemens.
    Flow,
    /// All else.
    Block,
}

impl Kind {
    fn of(parsed: &Parsed, text: &str) -> Self {
        match (parsed, text.trim_start().chars().next()) {
            (Parsed::Blank, None | Some(';')) | (Parsed::Percent, _) => Self::Blank,
            (Parsed::Blank, _) if text.trim_start().starts_with("//") => Self::Blank,
            (Parsed::Blank, Some('/')) => Self::Deleted,
            (Parsed::Block(block), _) if block.is_comment() => Self::Blank,
            (Parsed::Flow(_) | Parsed::Statement(_), _) => Self::Flow,
            _ => Self::Block,
        }
    }
}

/// A program on its way through the interpreter.
pub(super) struct Reader {
    pub(super) position: Position,
    /// Of the innermost level.
    lines: Lines,
    pub(super) options: Options,
    pub(super) interpreter: Interpreter,
    /// What conditions could depend on before the line that is read.
    pub(super) conditions_before: u64,
    ran: Option<Ran>,
}

impl Reader {
    /// At the start of a program.
    pub(super) fn new(source: &Source, options: Options) -> Self {
        let main = Level {
            source: source.clone(),
            offset: 0,
            line: 0,
            open: Vec::new(),
            repeats_to: 0,
            file: None,
            call: None,
        };
        let position = Position {
            levels: vec![main],
            found: BTreeMap::new(),
            labels: BTreeMap::new(),
            seen: false,
            in_subroutine: false,
            executed: 0,
            effort: Effort::default(),
        };
        let interpreter = Interpreter::new(&options);
        Self::at(position, interpreter, options)
    }

    /// In the middle of one.
    pub(super) fn at(position: Position, interpreter: Interpreter, options: Options) -> Self {
        let mut reader = Self {
            lines: Source::Text(Arc::default()).lines(0),
            position,
            options,
            interpreter,
            conditions_before: 0,
            ran: None,
        };
        reader.reopen();
        reader
    }

    /// Goes on reading where the innermost level is.
    pub(super) fn reopen(&mut self) {
        if let Some(level) = self.position.levels.last() {
            self.lines = level.source.lines(level.offset);
        }
    }

    pub(super) fn level(&mut self) -> &mut Level {
        // The main program is never left.
        self.position.levels.last_mut().expect("the main program")
    }

    /// The next line of this level.
    pub(super) fn next_line(&mut self) -> Result<Option<String>, NcError> {
        let called = self.position.depth() > 0;
        if called && self.level().line >= self.level().last_line() {
            return Ok(None);
        }
        let read = self.lines.next();
        let offset = self.lines.offset;
        // The main program is never left.
        let level = self.position.levels.last_mut().expect("the main program");
        let may_repeat = called || level.open.iter().any(Open::loops) || level.line < level.repeats_to;
        level.offset = offset;
        level.line += 1;
        let line = level.line;
        match read {
            Ok(Some(text)) => {
                self.interpreter.line = line;
                let effort = &mut self.position.effort;
                if may_repeat {
                    effort.motions(std::mem::take(&mut self.interpreter.motions));
                }
                effort.line(level.file.as_deref(), line, text.len(), may_repeat);
                if let Some(most) = effort.exceeded() {
                    return Err(Problem::Endless(most).at(SourcePosition { line, column: 1 }));
                }
                Ok(Some(text))
            }
            Ok(None) => {
                level.line -= 1;
                Ok(None)
            }
            Err(error) => Err(Problem::Unreadable(error.to_string()).at(SourcePosition { line, column: 1 })),
        }
    }

    /// Carries out the next line; whether there was one.
    pub(super) fn block(&mut self) -> Result<bool, NcError> {
        let file = |reader: &Self| reader.position.file().map(str::to_owned);
        let before = file(self);
        self.ran = None;
        self.line_of_level().map_err(|error| match file(self).or(before) {
            Some(file) if !matches!(error.problem, Problem::InFile { .. }) => {
                let problem = Box::new(error.problem);
                Problem::InFile { file, problem }.at(error.place)
            }
            _ => error,
        })
    }

    fn line_of_level(&mut self) -> Result<bool, NcError> {
        if self.interpreter.ended {
            return Ok(false);
        }
        let Some(text) = self.next_line()? else {
            return self.end_of_text();
        };
        self.position.executed += 1;
        self.conditions_before = self.interpreter.conditions();
        let deleted = self.options.block_delete && text.trim_start().starts_with('/');
        let Some(parts) = line_parts::of(&text).filter(|_| !deleted) else {
            return self.part_of_line(text);
        };
        let mut settings = Vec::new();
        let before = self.next_place();
        for part in parts {
            let goes_on = self.part_of_line(part)?;
            settings.extend(self.ran.take().into_iter().flat_map(|ran| ran.settings));
            if !goes_on {
                return Ok(false);
            }
            // A loop that is over, or a jump, leaves the rest of the line out.
            if self.next_place() != before {
                break;
            }
        }
        self.ran = Some(Ran {
            kind: Kind::Flow,
            text,
            settings,
        });
        Ok(true)
    }

    /// How many programs run inside each other, and where the next line of the innermost begins.
    fn next_place(&mut self) -> (usize, u64) {
        let depth = self.position.depth();
        (depth, self.level().offset)
    }

    /// Carries out a line, or a statement of one.
    fn part_of_line(&mut self, text: String) -> Result<bool, NcError> {
        let here = self.position.here();
        let skipped = Skipped {
            blocks: self.options.block_delete,
            functions: &self.options.setup.passed_over,
            commands: self.options.setup.grbl_commands,
            moved: self.interpreter.has_moved(),
        };
        let parsed = parse(&text, here.line, skipped, &mut self.interpreter)?;
        let seen = self.position.seen;
        // Comments may stand before the tape mark, and some archives have it behind the header of the program.
        let says_nothing = match &parsed {
            Parsed::Blank => true,
            Parsed::Block(block) => block.is_comment(),
            _ => !seen && calls::is_archive_header(&text),
        };
        self.position.seen |= !says_nothing;
        let mut ran = Ran {
            kind: Kind::of(&parsed, &text),
            text,
            settings: Vec::new(),
        };
        match parsed {
            Parsed::Blank => {}
            Parsed::Percent if seen && self.position.levels.len() == 1 => {
                if !ends_tape(&ran.text) {
                    return Err(Problem::TextBehindTapeMark.at(here));
                }
                self.interpreter.finish("%", here)?;
                return Ok(false);
            }
            Parsed::Percent if self.is_named() => self.leave_again()?,
            Parsed::Percent => {}
            Parsed::Flow(word) => self.flow(&word)?,
            Parsed::Statement(statement) => self.statement(statement)?,
            Parsed::Block(mut block) => {
                if self.is_named() {
                    block.end_as_subprogram();
                }
                self.look_behind_corner(&block);
                self.look_along_contour(&block);
                self.interpreter.block(&block)?;
                self.call_of(&block)?;
                ran.settings = block.settings;
            }
        }
        self.ran = Some(ran);
        Ok(!self.interpreter.ended)
    }

    /// The line that was carried out last, if there was one.
    pub(super) fn take_ran(&mut self) -> Option<Ran> {
        self.ran.take()
    }

    /// The text of the main program ends without an M2, which is told; that of a subroutine must not, but in Siemens programs.
    /// Whether the program goes on.
    fn end_of_text(&mut self) -> Result<bool, NcError> {
        let here = self.position.here();
        if let Some(open) = self.level().open.last() {
            return Err(open.no_end(here));
        }
        if matches!(
            self.level().called(),
            Some(Called::Name { .. } | Called::Part { .. })
        ) {
            self.leave_again()?;
            return Ok(true);
        }
        if self.position.levels.len() > 1 {
            let (label, keyword, wanted) = (String::new(), "sub", "endsub, return or M99");
            return Err(no_end(label, keyword, wanted, here));
        }
        if self.position.seen {
            let text = "the program ends without M2 or M30: it is taken to end here".to_owned();
            self.interpreter.notice(text, here);
        }
        self.interpreter.finish("the end of the program", here)?;
        Ok(false)
    }

    /// The program that was read.
    pub(super) fn end(self) -> Program {
        let main = self
            .position
            .levels
            .first()
            .filter(|_| self.interpreter.asked > 0);
        let looked = self.interpreter.looked.clone();
        let again = main.map(|main| {
            Box::new(Again {
                source: main.source.clone(),
                options: self.options,
                found: self.interpreter.found,
                looked,
            })
        });
        Program {
            again,
            ..self.interpreter.end()
        }
    }

    /// Bytes before the line that was read last.
    pub(super) fn start_of_line(&self) -> u64 {
        self.lines.line_start
    }

    /// Goes to `offset` of this level.
    pub(super) fn jump(&mut self, offset: u64, line: u32) {
        let level = self.level();
        (level.offset, level.line) = (offset, line);
        self.reopen();
    }
}

/// Whether the tape mark of `text` stands alone, or is the header of the next program of an archive.
fn ends_tape(text: &str) -> bool {
    let behind = text.trim_start().trim_start_matches('%').trim_start();
    behind.is_empty() || behind.starts_with(['(', ';']) || calls::is_archive_header(text)
}

/// The other end of a loop, condition or subroutine is missing.
pub(super) fn no_end(
    label: String,
    keyword: &'static str,
    wanted: &'static str,
    place: SourcePosition,
) -> NcError {
    Problem::FlowEnd {
        label,
        keyword,
        wanted,
    }
    .at(place)
}
