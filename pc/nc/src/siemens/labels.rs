//! Labels and block numbers of a program: the lines that jumps lead to.

use super::calls;
use super::structures::{Edge, edge};
use super::words;
use crate::error::{NcError, Problem, SourcePosition};
use crate::levels::Level;
use crate::reader::Reader;
use crate::scanner::Scanner;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A label, or the number of a block.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Target {
    Start,
    Label(String),
    Number(u32),
}

/// A line that a jump leads to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Place {
    /// Bytes and lines before it.
    pub(super) offset: u64,
    pub(super) line: u32,
    /// Lines that open the structures around it.
    pub(super) inside: Vec<u32>,
}

/// All labels of a program, and of its block numbers those that its jumps name.
#[derive(Debug, Default)]
pub(crate) struct Labels(BTreeMap<Target, Vec<Place>>);

impl Labels {
    fn read(level: &Level, place: SourcePosition) -> Result<Self, NcError> {
        let mut wanted = BTreeSet::new();
        for_each_line(level, place, |_, text| {
            wanted.extend(numbers_of_jumps(text));
            false
        })?;
        let mut labels = Self::default();
        for_each_line(level, place, |found, text| {
            let (number, label) = names(text);
            let number = number
                .filter(|number| wanted.contains(number))
                .map(Target::Number);
            for target in number.into_iter().chain(label.map(Target::Label)) {
                labels.0.entry(target).or_default().push(found.clone());
            }
            false
        })?;
        Ok(labels)
    }

    /// Lines with a label or number, from first to last.
    pub(super) fn places(&self, target: &Target) -> &[Place] {
        self.0.get(target).map_or(&[], Vec::as_slice)
    }
}

impl Reader {
    /// The labels of the innermost program, which is read for them once.
    pub(super) fn labels(&mut self, place: SourcePosition) -> Result<Arc<Labels>, NcError> {
        let level = self.level();
        let key = (level.file.clone(), level.begins().1, level.last_line());
        if let Some(labels) = self.position.labels.get(&key) {
            return Ok(labels.clone());
        }
        let labels = Arc::new(Labels::read(self.level(), place)?);
        self.position.labels.insert(key, labels.clone());
        Ok(labels)
    }
}

/// Block numbers behind the words of jumps in a line.
fn numbers_of_jumps(text: &str) -> Vec<u32> {
    let upper = text.to_ascii_uppercase();
    let behind = upper.split("GOTO").skip(1);
    let numbers = behind.filter_map(|rest| {
        let number = rest.trim_start_matches(['F', 'B', 'C']).trim_start();
        let number = number.strip_prefix('N').unwrap_or(number);
        let end = number.find(|c: char| !c.is_ascii_digit());
        number[..end.unwrap_or(number.len())].parse().ok()
    });
    numbers.collect()
}

/// The block number and the label of a line.
fn names(text: &str) -> (Option<u32>, Option<String>) {
    let mut scanner = Scanner::new(text, 0);
    let number = scanner.skip_block_number();
    scanner.skip_blanks();
    let start = scanner.mark();
    let name = scanner.identifier().to_ascii_uppercase();
    scanner.go_back(start);
    (number, words::label(&mut scanner).then_some(name))
}

/// Whether a line is more than a comment or a header.
pub(super) fn says_something(text: &str) -> bool {
    !text.trim_start().is_empty() && !text.trim_start().starts_with([';', '%'])
}

/// Hands the lines of a program to `takes`, with the structures around them, until that is enough.
pub(super) fn for_each_line(
    level: &Level,
    place: SourcePosition,
    mut takes: impl FnMut(&Place, &str) -> bool,
) -> Result<(), NcError> {
    let (begin, mut line) = level.begins();
    let last = level.last_line();
    let mut lines = level.source.lines(begin);
    let mut inside = Vec::new();
    let mut seen = false;
    while line < last {
        let unreadable = |error: std::io::Error| Problem::Unreadable(error.to_string()).at(place);
        let Some(text) = lines.next().map_err(unreadable)? else {
            break;
        };
        if seen && calls::begins_program(&text) {
            break;
        }
        seen |= says_something(&text);
        let edge = edge(&text);
        if edge == Some(Edge::Closes) {
            inside.pop();
        }
        let found = Place {
            offset: lines.line_start,
            line,
            inside: inside.clone(),
        };
        if takes(&found, &text) {
            break;
        }
        line += 1;
        if edge == Some(Edge::Opens) {
            inside.push(line);
        }
    }
    Ok(())
}
