//! Lines of a program one after the other: loops, conditions and subroutines decide which is the next.

use super::block::{Block, Parsed, Word, parse};
use super::branches::Open;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::flow::OWord;
use super::interpreter::Interpreter;
use super::parameters::Parameter;
use super::program::Program;
use super::setup::Options;
use super::siemens::calls;
use super::siemens::jumps::{Jump, Place};
use super::source::{Lines, Source};
use super::subroutines::{self, Found, Name};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Deepest nesting of subroutines.
const DEEPEST: usize = 32;
/// Most lines that are read inside loops and subroutines, with those that are passed over.
const MOST_LINES: u64 = 1_000_000;

/// The main program, or a subroutine that runs.
#[derive(Clone)]
pub(super) struct Level {
    pub(super) source: Source,
    /// Bytes and lines before the next one.
    pub(super) offset: u64,
    pub(super) line: u32,
    pub(super) open: Vec<Open>,
    /// Up to this line lines may be run again by a jump.
    pub(super) repeats_to: u32,
    /// Name of the file, if that is not the program's.
    pub(super) file: Option<String>,
    /// How it was called; the main program was not.
    call: Option<Call>,
}

impl Level {
    /// Bytes and lines before it.
    pub(super) fn begins(&self) -> (u64, u32) {
        self.call.as_ref().map_or((0, 0), |call| call.begins)
    }

    /// The last line, if it ends before the text does.
    pub(super) fn last_line(&self) -> u32 {
        match self.called() {
            Some(Called::Part { last }) => *last,
            _ => u32::MAX,
        }
    }

    /// The arguments of the call, for its PROC.
    pub(super) fn take_arguments(&mut self) -> Vec<Option<f64>> {
        match self.call.as_mut().map(|call| &mut call.by) {
            Some(Called::Name { arguments, bound }) => {
                *bound = true;
                arguments.clone()
            }
            _ => Vec::new(),
        }
    }

    /// By what it was called.
    pub(super) fn called(&self) -> Option<&Called> {
        self.call.as_ref().map(|call| &call.by)
    }
}

#[derive(Clone)]
struct Call {
    by: Called,
    /// Where it begins, and how many times more it is to run (M98 L).
    begins: (u64, u32),
    again: u32,
}

/// By what a subroutine was called.
#[derive(Clone)]
pub(super) enum Called {
    /// M98.
    Number,
    /// An O word with this number or name.
    OWord(String),
    /// Its name, in a Siemens program, with arguments that its PROC takes.
    Name {
        arguments: Vec<Option<f64>>,
        bound: bool,
    },
    /// It is a part of the program around it, up to a line (REPEAT).
    Part { last: u32 },
}

impl Called {
    fn has_own_parameters(&self) -> bool {
        matches!(self, Self::OWord(_) | Self::Name { .. })
    }
}

/// How far a program has been run.
#[derive(Clone)]
pub(super) struct Position {
    /// The innermost subroutine last; the main program is always there.
    levels: Vec<Level>,
    found: BTreeMap<String, Found>,
    /// Where jumps lead, by file and line.
    pub(super) jumps: BTreeMap<(Option<String>, u32, Jump), Option<Place>>,
    /// Anything but blank lines was seen.
    seen: bool,
    /// Lines that were run.
    pub(super) executed: u64,
    /// Lines that were read inside loops and subroutines.
    repeated: u64,
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
    options: Options,
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
            jumps: BTreeMap::new(),
            seen: false,
            executed: 0,
            repeated: 0,
        };
        let interpreter = Interpreter::new(&options.setup, options.optional_stop);
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
    fn reopen(&mut self) {
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
        let level = self.level();
        let may_repeat = called || level.open.iter().any(Open::loops) || level.line < level.repeats_to;
        level.offset = offset;
        level.line += 1;
        let line = level.line;
        match read {
            Ok(Some(text)) => {
                self.interpreter.line = line;
                self.position.repeated += u64::from(may_repeat);
                if self.position.repeated > MOST_LINES {
                    return Err(Problem::Endless(MOST_LINES).at(SourcePosition { line, column: 1 }));
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
        let here = self.position.here();
        self.position.executed += 1;
        self.conditions_before = self.interpreter.conditions();
        let parsed = parse(&text, here.line, self.options.block_delete, &mut self.interpreter)?;
        let seen = self.position.seen;
        // Some archives have a tape mark behind the header of the program.
        self.position.seen |= parsed != Parsed::Blank && (seen || !calls::is_archive_header(&text));
        let mut ran = Ran {
            kind: Kind::of(&parsed, &text),
            text,
            settings: Vec::new(),
        };
        match parsed {
            Parsed::Blank => {}
            Parsed::Percent if seen && self.position.levels.len() == 1 => {
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

    /// Whether the innermost level is a subprogram of Siemens.
    pub(super) fn is_named(&mut self) -> bool {
        matches!(self.level().called(), Some(Called::Name { .. }))
    }

    /// The program that was read.
    pub(super) fn end(self) -> Program {
        self.interpreter.end()
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

    /// M98 and M99.
    fn call_of(&mut self, block: &Block) -> Result<(), NcError> {
        let Some(code) = block.code(Group::Call) else {
            return Ok(());
        };
        self.interpreter.branches = true;
        match code.code {
            Code::Return => return self.leave_numbered(code.place),
            Code::SubprogramEnd => return self.end_subprogram(code.name, code.place),
            _ => {}
        }
        let Some(p) = block.word("P") else {
            let (code_name, word) = ("M98", "P");
            return Err(Problem::Missing {
                code: code_name,
                word,
            }
            .at(code.place));
        };
        let times = |word: &Word| {
            let whole = word.value.fract() == 0.0 && (0.0..=1e6).contains(&word.value);
            let wrong = word.value_error("a subroutine is repeated 0 to 1000000 times");
            whole.then_some(word.value as u32).ok_or(wrong)
        };
        match block.word("L").map(times).transpose()?.unwrap_or(1) {
            0 => Ok(()),
            times => self.enter(&format!("{}", p.value.round()), Called::Number, times, code.place),
        }
    }

    /// A numbered subroutine or that of an O word begins.
    pub(super) fn enter(
        &mut self,
        label: &str,
        by: Called,
        times: u32,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let found = self.find(Name::OWord(label), place)?;
        self.enter_level(found, by, times, place)
    }

    /// A subroutine begins where it was found, a number of times.
    pub(super) fn enter_level(
        &mut self,
        found: Found,
        by: Called,
        times: u32,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        if self.position.levels.len() > DEEPEST {
            return Err(Problem::CallDepth(DEEPEST).at(place));
        }
        self.interpreter.branches = true;
        self.position.levels.push(Level {
            source: found.source,
            offset: found.offset,
            line: found.line,
            open: Vec::new(),
            repeats_to: 0,
            file: found.file,
            call: Some(Call {
                by,
                begins: (found.offset, found.line),
                again: times - 1,
            }),
        });
        self.reopen();
        Ok(())
    }

    /// A subroutine ends by its O word.
    pub(super) fn leave(&mut self, value: Option<f64>, word: &OWord) -> Result<(), NcError> {
        let label = word.label.clone();
        let level = self.level();
        let Some(called) = level.called() else {
            let (keyword, wanted) = ("return or endsub", "call that led here");
            return Err(no_end(label, keyword, wanted, word.place));
        };
        if let Called::OWord(open) = called
            && *open != label
        {
            // As LinuxCNC takes it; the name may be a slip.
            let line = level.begins().1;
            let text = format!("o{label} ends the subroutine o{open} that begins in line {line}");
            self.interpreter.notice(text, word.place);
        }
        self.pop()?;
        self.interpreter.set_result(value);
        Ok(())
    }

    /// A subroutine ends by M99, or begins again.
    fn leave_numbered(&mut self, place: SourcePosition) -> Result<(), NcError> {
        if self.position.levels.len() == 1 {
            return Err(Problem::EndlessProgram.at(place));
        }
        self.leave_again()
    }

    /// A subroutine has come to its end: it begins again as often as it was called for.
    pub(super) fn leave_again(&mut self) -> Result<(), NcError> {
        let here = self.position.here();
        let level = self.level();
        if let Some(Called::Name {
            arguments,
            bound: false,
        }) = level.called()
            && !arguments.is_empty()
        {
            let (given, most) = (arguments.len(), 0);
            return Err(Problem::Arguments { given, most }.at(here));
        }
        let begins = level.begins();
        let again = level.call.as_mut().filter(|call| call.again > 0);
        let Some(call) = again else {
            return self.pop();
        };
        call.again -= 1;
        level.open.clear();
        if self.is_named() {
            self.interpreter.leave()?;
            self.interpreter.parameters.enter(&[]);
        }
        self.jump(begins.0, begins.1);
        Ok(())
    }

    fn pop(&mut self) -> Result<(), NcError> {
        let level = self.position.levels.pop();
        if level
            .and_then(|level| level.call)
            .is_some_and(|call| call.by.has_own_parameters())
        {
            self.interpreter.leave()?;
        }
        self.reopen();
        Ok(())
    }

    /// Where a subroutine begins; the innermost text is searched first.
    pub(super) fn find(&mut self, name: Name, place: SourcePosition) -> Result<Found, NcError> {
        let key = name.key();
        if let Some(found) = self.position.found.get(key) {
            return Ok(found.clone());
        }
        let own = self.position.levels.iter().rev();
        let mut texts: Vec<_> = own
            .map(|level| (level.source.clone(), level.file.clone()))
            .collect();
        texts.dedup_by(|a, b| a.1 == b.1);
        let folders = &self.options.setup.folders;
        let found = subroutines::find(name, texts, folders, &mut self.interpreter, place)?;
        self.position.found.insert(key.to_owned(), found.clone());
        Ok(found)
    }
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
