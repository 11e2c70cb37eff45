//! Programs of any length: the first blocks of a path are kept, the others are read again whenever they are needed.

use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::program::{Move, Program, ProgramEvent, ProgramPath};
use super::reader::{Position, Reader};
use super::setup::Options;
use super::source::Source;
use std::collections::VecDeque;
use std::fmt;
use std::fs::File;
use std::sync::Arc;

/// Blocks of a path that are kept.
pub const KEPT: usize = 1024;

/// Reads a whole program.
///
/// Consecutive blocks that feed make one path, and every G0 one of its own. M62, M63 and M67 take effect at the start
/// of the next motion; M3, M4, M5, M64, M65 and M68 end a path and take effect at rest; G4 ends a path and delays the
/// next one.
///
/// # Errors
/// The first problem, with its position.
pub fn interpret(text: &str, options: Options) -> Result<Program, NcError> {
    read(&Source::Text(text.as_bytes().into()), options, KEPT)
}

/// Reads a whole program from a file. Of long paths no more than [`KEPT`] blocks are kept; a file of more than 1 MiB
/// must stay as it is while the others are needed, or they are an error.
///
/// # Errors
/// As of [`interpret`], and what keeps the file from being read.
pub fn interpret_file(file: File, options: Options) -> Result<Program, NcError> {
    let first = SourcePosition { line: 1, column: 1 };
    let source = Source::of(file).map_err(|error| Problem::Unreadable(error.to_string()).at(first))?;
    read(&source, options, KEPT)
}

/// Reads a program and keeps no more than `kept` blocks of a path.
pub(super) fn read(source: &Source, options: Options, kept: usize) -> Result<Program, NcError> {
    let mut reader = Reader::new(source, options.clone());
    while reader.block()? {
        keep(&mut reader, &options, kept);
    }
    Ok(reader.end())
}

/// Keeps no more than `kept` blocks of the path that was read last.
pub(super) fn keep(reader: &mut Reader, options: &Options, kept: usize) {
    let position = &reader.position;
    reader.interpreter.trim(kept, |state, kept| RemainingBlocks {
        kept,
        options: options.clone(),
        position: position.clone(),
        state: Arc::new(state),
    });
}

/// The blocks of a path that are not kept in memory: where they are in the source, and the state of the
/// interpreter there.
#[derive(Clone)]
pub struct RemainingBlocks {
    /// Blocks of the path before these.
    kept: usize,
    options: Options,
    /// Where they begin.
    position: Position,
    /// Its state there.
    state: Arc<Interpreter>,
}

impl RemainingBlocks {
    /// How many blocks of the path come before these.
    pub(super) fn kept(&self) -> usize {
        self.kept
    }
}

impl fmt::Debug for RemainingBlocks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RemainingBlocks(after line {})", self.position.here().line)
    }
}

impl PartialEq for RemainingBlocks {
    fn eq(&self, other: &Self) -> bool {
        self.position.executed == other.position.executed
    }
}

impl ProgramPath {
    /// Its blocks one after the other.
    ///
    /// # Errors
    /// What keeps the program from being read again; it is not as it was then.
    pub fn moves(self: &Arc<Self>) -> impl Iterator<Item = Result<Move, NcError>> + use<> {
        let path = self.clone();
        let kept = (0..self.kept_count()).map(move |index| Ok(path.kept(index)));
        let rest = self.rest.as_ref().map(RereadBlocks::new);
        kept.chain(rest.into_iter().flatten())
    }

    /// The same path with all of its blocks kept.
    ///
    /// # Errors
    /// As for [`Self::moves`].
    pub fn whole(&self) -> Result<Self, NcError> {
        let mut whole = self.clone();
        if let Some(rest) = whole.rest.take() {
            let count = self.kept_count();
            whole.targets.truncate(count);
            whole.events.retain(|event| event.with_target < count);
            for next in RereadBlocks::new(&rest) {
                let Move { target, events } = next?;
                let with_target = whole.targets.len();
                whole.targets.push(target);
                whole.events.extend(events.into_iter().map(|mut event| {
                    event.with_target = with_target;
                    event
                }));
            }
        }
        Ok(whole)
    }

    /// How many blocks are kept of it, of all that are here.
    fn kept_count(&self) -> usize {
        let most = self.rest.as_ref().map_or(usize::MAX, |rest| rest.kept);
        self.targets.len().min(most)
    }

    /// The same path without any of its blocks.
    pub(super) fn without_blocks(&self) -> Self {
        Self {
            waits_before: Vec::new(),
            targets: Vec::new(),
            events: Vec::new(),
            rest: None,
            ..*self
        }
    }

    fn kept(&self, index: usize) -> Move {
        let events = self.events.iter().filter(|event| event.with_target == index);
        Move {
            target: self.targets[index].clone(),
            events: events
                .map(|event| ProgramEvent {
                    with_target: 0,
                    ..*event
                })
                .collect(),
        }
    }
}

/// Iterator over [`RemainingBlocks`]: reads and interprets them again.
struct RereadBlocks {
    reader: Reader,
    waiting: VecDeque<Move>,
    ended: bool,
}

impl RereadBlocks {
    fn new(rest: &RemainingBlocks) -> Self {
        Self {
            reader: Reader::at(rest.position.clone(), (*rest.state).clone(), rest.options.clone()),
            waiting: VecDeque::new(),
            ended: false,
        }
    }

    fn more(&mut self) -> Result<(), NcError> {
        self.ended = !self.reader.block()?;
        let (path, goes_on) = self.reader.interpreter.take_blocks();
        let blocks = path
            .iter()
            .flat_map(|path| (0..path.targets.len()).map(|index| path.kept(index)));
        self.waiting.extend(blocks);
        self.ended |= !goes_on;
        Ok(())
    }
}

impl Iterator for RereadBlocks {
    type Item = Result<Move, NcError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.waiting.is_empty() && !self.ended {
            if let Err(error) = self.more() {
                self.ended = true;
                return Some(Err(error));
            }
        }
        self.waiting.pop_front().map(Ok)
    }
}
