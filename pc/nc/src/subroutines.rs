//! Where subroutines begin: in the texts that run, or in a file of their name.

use super::error::{NcError, Problem, SourcePosition};
use super::flow::{self, Keyword, OWord};
use super::interpreter::Interpreter;
use super::line_parts;
use super::scanner::Scanner;
use super::siemens::calls;
use super::source::Source;
use std::fs::File;
use std::io;
use std::path::PathBuf;

/// A text with subroutines, and the name of its file, if that is not the program's.
pub(super) type Text = (Source, Option<String>);

/// Where a subroutine begins.
#[derive(Clone)]
pub(super) struct Found {
    pub(super) source: Source,
    /// Bytes and lines up to the first one behind its O word.
    pub(super) offset: u64,
    pub(super) line: u32,
    pub(super) file: Option<String>,
}

/// What a subroutine is called by.
#[derive(Clone, Copy)]
pub(super) enum Name<'n> {
    /// Number or name of an O word, which M98 has too.
    OWord(&'n str),
    /// Of a subprogram of Siemens, as it is written and in upper case.
    Siemens(&'n str, &'n str),
}

impl Name<'_> {
    /// To keep by; the one is in lower, the other in upper case.
    pub(super) fn key(&self) -> &str {
        match self {
            Self::OWord(name) | Self::Siemens(_, name) => name,
        }
    }

    /// Names of files that it may be in.
    fn files(&self) -> Vec<String> {
        match self {
            Self::OWord(name) => vec![format!("{name}.ngc")],
            Self::Siemens(written, upper) => calls::files(written, upper),
        }
    }

    /// Whether it begins at the line `text`, and if so, whether that belongs to it.
    fn begins(&self, text: &str, line: u32, interpreter: &mut Interpreter) -> Option<bool> {
        match self {
            Self::Siemens(_, upper) => calls::begins(text, upper),
            Self::OWord(name) => {
                let word = head(text, line, interpreter)?;
                let begins = matches!(word.keyword, Keyword::Sub | Keyword::Number);
                // Words behind its number are its first ones.
                (begins && word.label == *name).then(|| line_parts::of(text).is_some())
            }
        }
    }

    fn nowhere(&self) -> Problem {
        match self {
            Self::OWord(label) => Problem::NoSubroutine {
                label: (*label).to_owned(),
            },
            Self::Siemens(written, _) => Problem::NoSubprogram((*written).to_owned()),
        }
    }
}

/// Where the subroutine `name` begins, which is called at `place`: in the first of `texts` that has it, else in a file of its name in
/// the first of `folders` with such a file.
pub(super) fn find(
    name: Name,
    texts: Vec<Text>,
    folders: &[PathBuf],
    interpreter: &mut Interpreter,
    place: SourcePosition,
) -> Result<Found, NcError> {
    let mut texts = texts.into_iter();
    if let Some(found) = texts.find_map(|text| begins(text, name, interpreter)) {
        return Ok(found);
    }
    let files = name.files();
    let paths = folders
        .iter()
        .flat_map(|folder| files.iter().map(|file| folder.join(file)));
    let opened = paths.map(|path| (File::open(&path), path));
    let Some((file, path)) = opened.filter_map(|(file, path)| Some((file.ok()?, path))).next() else {
        return Err(name.nowhere().at(place));
    };
    let file_name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let unreadable = |error: io::Error| Problem::Unreadable(error.to_string()).at(place);
    let source = Source::of(file).map_err(unreadable)?;
    let found = begins((source.clone(), file_name.clone()), name, interpreter);
    match (found, name) {
        (Some(found), _) => Ok(found),
        // A file of Siemens needs no header.
        (None, Name::Siemens(..)) => Ok(Found {
            source,
            offset: 0,
            line: 0,
            file: file_name,
        }),
        (None, Name::OWord(_)) => Err(name.nowhere().at(place)),
    }
}

/// Where a text has a subroutine.
fn begins((source, file): Text, name: Name, interpreter: &mut Interpreter) -> Option<Found> {
    let mut lines = source.lines(0);
    let mut line = 0;
    while let Ok(Some(text)) = lines.next() {
        line += 1;
        if let Some(with_line) = name.begins(&text, line, interpreter) {
            let (offset, line) = match with_line {
                true => (lines.line_start, line - 1),
                false => (lines.offset, line),
            };
            return Some(Found {
                source,
                offset,
                line,
                file,
            });
        }
    }
    None
}

/// The O word of a line, without its values. Of a line that is not understood nothing.
pub(super) fn head(text: &str, line: u32, interpreter: &mut Interpreter) -> Option<OWord> {
    let start = text.trim_start();
    let first = start.chars().next()?;
    if !matches!(first, 'O' | 'o' | ':' | 'N' | 'n' | '/') {
        return None;
    }
    let mut scanner = Scanner::new(text, line);
    scanner.skip_blanks();
    if first == '/' {
        scanner.step();
    }
    flow::o_word(&mut scanner, interpreter, false).ok().flatten()
}
