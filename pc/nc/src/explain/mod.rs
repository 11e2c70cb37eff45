//! What each block of a program does, in words: the state of the interpreter after it, compared with that before.
//!
//! ```text
//! reader carries out a block → Before and after → modes, events, motions in words → Told
//! ```

mod before;
mod events;
mod modes;
mod motions;
mod words;

pub(super) use modes::{system, system_name};

use super::error::{NcError, Problem, SourcePosition};
use super::program::Program;
use super::reader::{Kind, Ran, Reader};
use super::reading::{KEPT, keep};
use super::setup::Options;
use super::source::Source;
use before::Before;
use std::fs::File;

/// What a block, or a line that decides which one is next, was understood to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Line of its file; the first is 1.
    pub line: u32,
    /// The file of the subroutine that it is in, if that is not the program's.
    pub file: Option<String>,
    /// How many subroutines it is in.
    pub depth: usize,
    /// The line as it is written.
    pub text: String,
    /// What it does, a phrase each, in the order of execution: values set, modes, outputs and dwells, motions, messages, and
    /// where the program goes on. Lengths are in mm but where they are said to be inches.
    pub facts: Vec<String>,
}

/// Reads a program as [`crate::interpret`] does, and hands each of its blocks to `tell`, in the order of execution: those
/// of subroutines and loops as often as they are run. Lines that are blank or nothing but a comment are left out, but for
/// messages.
///
/// # Errors
/// As of [`crate::interpret`]; what comes before has been told.
pub fn explain(text: &str, options: Options, tell: impl FnMut(Told)) -> Result<Program, NcError> {
    read(&Source::Text(text.as_bytes().into()), options, tell)
}

/// The same for a file, which is read as [`crate::interpret_file`] does.
///
/// # Errors
/// As of [`crate::interpret_file`]; what comes before has been told.
pub fn explain_file(file: File, options: Options, tell: impl FnMut(Told)) -> Result<Program, NcError> {
    let first = SourcePosition { line: 1, column: 1 };
    let source = Source::of(file).map_err(|error| Problem::Unreadable(error.to_string()).at(first))?;
    read(&source, options, tell)
}

fn read(source: &Source, options: Options, mut tell: impl FnMut(Told)) -> Result<Program, NcError> {
    let mut reader = Reader::new(source, options.clone());
    loop {
        let before = Before::of(&reader);
        let goes_on = reader.block()?;
        if let Some(ran) = reader.take_ran()
            && let Some(told) = told(&before, &reader, ran)
        {
            tell(told);
        }
        if !goes_on {
            return Ok(reader.end());
        }
        keep(&mut reader, &options, KEPT);
    }
}

/// What the line that was run did; nothing of one that is empty.
fn told(before: &Before, reader: &Reader, ran: Ran) -> Option<Told> {
    let after = &reader.interpreter;
    let mut facts: Vec<String> = ran
        .settings
        .iter()
        .map(|(parameter, value)| format!("{parameter} = {}", words::figure(*value)))
        .collect();
    let moves = motions::count(before, after) > 0;
    facts.extend(modes::changes(before, after, moves));
    facts.extend(motions::facts(before, after));
    facts.extend(
        after.notices[before.notices..]
            .iter()
            .map(|notice| notice.text.clone()),
    );
    facts.extend(goes_on(before, reader));
    if facts.is_empty() {
        let nothing = match ran.kind {
            Kind::Blank => return None,
            Kind::Deleted => "left out: block delete",
            Kind::Flow => "goes on with the next line",
            Kind::Block => "changes nothing",
        };
        facts.push(nothing.to_owned());
    }
    Some(Told {
        line: before.line + 1,
        file: before.file.clone(),
        depth: before.depth,
        text: ran.text.trim().to_owned(),
        facts,
    })
}

/// Where the program goes on, if that is not the next line.
fn goes_on(before: &Before, reader: &Reader) -> Option<String> {
    let (line, depth) = (reader.position.here().line, reader.position.depth());
    let next = line + 1;
    if reader.interpreter.ended {
        return Some("the program ends".to_owned());
    }
    if depth > before.depth {
        let of_file = reader.position.file().map(|file| format!(" of {file}"));
        return Some(format!(
            "calls the subroutine from line {next}{}",
            of_file.unwrap_or_default()
        ));
    }
    if depth < before.depth {
        return Some(format!("returns to line {next}"));
    }
    (next != before.line + 2).then(|| format!("goes on at line {next}"))
}
