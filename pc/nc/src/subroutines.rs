//! Where subroutines begin: in the texts that run, or in a file of their name.

use super::error::{NcError, Problem, SourcePosition};
use super::flow::{self, Keyword, OWord};
use super::interpreter::Interpreter;
use super::scanner::Scanner;
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

/// Where the subroutine `label` begins, which is called at `place`: in the first of `texts` that has it, else in `label.ngc` in
/// the first of `folders` with such a file.
pub(super) fn find(
    label: &str,
    mut texts: Vec<Text>,
    folders: &[PathBuf],
    interpreter: &mut Interpreter,
    place: SourcePosition,
) -> Result<Found, NcError> {
    let paths = folders.iter().map(|folder| folder.join(format!("{label}.ngc")));
    let opened = paths.map(|path| (File::open(&path), path));
    if let Some((file, path)) = opened.filter_map(|(file, path)| Some((file.ok()?, path))).next() {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        let unreadable = |error: io::Error| Problem::Unreadable(error.to_string()).at(place);
        texts.push((Source::of(file).map_err(unreadable)?, name));
    }
    let found = texts
        .into_iter()
        .find_map(|text| begins(text, label, interpreter));
    let label = label.to_owned();
    found.ok_or(Problem::NoSubroutine { label }.at(place))
}

/// Where a text has the subroutine `label`.
fn begins((source, file): Text, label: &str, interpreter: &mut Interpreter) -> Option<Found> {
    let mut lines = source.lines(0);
    let mut line = 0;
    while let Ok(Some(text)) = lines.next() {
        line += 1;
        let Some(word) = head(&text, line, interpreter) else {
            continue;
        };
        if word.label == label && matches!(word.keyword, Keyword::Sub | Keyword::Number) {
            let offset = lines.offset;
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
    if !matches!(first, 'O' | 'o' | 'N' | 'n' | '/') {
        return None;
    }
    let mut scanner = Scanner::new(text, line);
    scanner.skip_blanks();
    if first == '/' {
        scanner.step();
    }
    flow::o_word(&mut scanner, interpreter, false).ok().flatten()
}
