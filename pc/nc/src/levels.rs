//! Subroutines that run inside each other: how they are entered and left.

use super::block::{Block, Word};
use super::branches::Open;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::flow::OWord;
use super::reader::{Reader, no_end};
use super::source::Source;
use super::subroutines::{self, Found, Name};

/// Deepest nesting of subroutines.
const DEEPEST: usize = 32;

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
    pub(super) call: Option<Call>,
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
pub(super) struct Call {
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
    /// G65, with arguments by the numbers of their parameters.
    Macro(Vec<(u32, f64)>),
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
        matches!(self, Self::Macro(_) | Self::OWord(_) | Self::Name { .. })
    }
}

impl Reader {
    /// Whether the innermost level is a subprogram of Siemens.
    pub(super) fn is_named(&mut self) -> bool {
        matches!(self.level().called(), Some(Called::Name { .. }))
    }

    /// M98 and M99.
    pub(super) fn call_of(&mut self, block: &Block) -> Result<(), NcError> {
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
        if self.position.depth() == 0 {
            if self.position.in_subroutine {
                return Err(Problem::EndlessProgram.at(place));
            }
            let text = "M99 in the main program ends it: it is not repeated here";
            self.interpreter.notice(text.to_owned(), place);
            return self.interpreter.finish("M99", place);
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
        if let Some(Called::Macro(arguments)) = self.level().called().cloned() {
            self.interpreter.leave()?;
            self.interpreter.parameters.enter_macro(&arguments);
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
