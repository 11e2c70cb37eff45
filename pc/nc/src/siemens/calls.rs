//! Subprograms of Siemens programs: `NAME`, `NAME(1, 2) P3`, `L123`, PROC, RET and M17.

use super::expression;
use super::keywords;
use super::labels::{for_each_line, says_something};
use super::repeats::count;
use super::statement::{self, Statement, What};
use super::variables;
use crate::block::{Block, CodeWord};
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem, SourcePosition};
use crate::levels::Called;
use crate::parameters::{Kind, Lookup, Variable};
use crate::reader::Reader;
use crate::scanner::Scanner;
use crate::subroutines::Name;

/// A call.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Call {
    /// As it is written.
    name: String,
    /// Values in brackets; between two commas there is none.
    arguments: Vec<Option<f64>>,
    times: u32,
}

/// PROC with what it says of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Header {
    /// Name, type and the value without an argument.
    parameters: Vec<(String, Kind, f64)>,
    /// SAVE: the modes of before come back at its end.
    saves: bool,
}

/// Words behind PROC that only concern the display and single block.
const DISPLAY: [&str; 6] = ["DISPLOF", "DISPLON", "ACTBLOCNO", "SBLOF", "SBLON", "ICYCOF"];

/// A name alone in its line, with arguments and P or without them.
pub(super) fn by_name(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<Statement>, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let name = scanner.identifier().to_owned();
    if let Some(problem) = keywords::refused_word(&name) {
        return Err(problem.at(place));
    }
    scanner.skip_blanks();
    let arguments = match scanner.peek() {
        None | Some(';' | 'P' | 'p') => Vec::new(),
        Some('(') => arguments(scanner, lookup)?,
        _ => {
            scanner.go_back(start);
            return Ok(None);
        }
    };
    call(scanner, lookup, place, name, arguments).map(Some)
}

/// `L123` or `L123(1, 2)`, where nothing but P follows. Zeros before the number belong to the name.
pub(super) fn by_number(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
) -> Result<Option<Statement>, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let name = scanner.identifier().to_owned();
    scanner.skip_blanks();
    let arguments = match scanner.peek() {
        _ if name.len() < 2 => None,
        None | Some(';' | 'P' | 'p') => Some(Vec::new()),
        Some('(') => Some(arguments(scanner, lookup)?),
        _ => None,
    };
    let Some(arguments) = arguments else {
        scanner.go_back(start);
        return Ok(None);
    };
    call(scanner, lookup, place, name, arguments).map(Some)
}

fn call(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    place: SourcePosition,
    name: String,
    arguments: Vec<Option<f64>>,
) -> Result<Statement, NcError> {
    let times = count(scanner, lookup)?.unwrap_or(1);
    statement::end(scanner)?;
    let what = What::Call(Call {
        name,
        arguments,
        times,
    });
    Ok(Statement { what, place })
}

/// Values between brackets and commas, with the scanner at the bracket.
pub(super) fn arguments(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Vec<Option<f64>>, NcError> {
    arguments_by(scanner, |scanner, _| expression::value(scanner, lookup))
}

/// The same, each read by `value` with its index.
pub(super) fn arguments_by(
    scanner: &mut Scanner,
    mut value: impl FnMut(&mut Scanner, usize) -> Result<f64, NcError>,
) -> Result<Vec<Option<f64>>, NcError> {
    let place = scanner.place();
    scanner.step();
    let mut values = Vec::new();
    loop {
        scanner.skip_blanks();
        let value = match scanner.peek() {
            Some(',' | ')') => None,
            _ => Some(value(scanner, values.len())?),
        };
        scanner.skip_blanks();
        let end = scanner.peek();
        if value.is_some() || end == Some(',') || !values.is_empty() {
            values.push(value);
        }
        match end {
            Some(',') => scanner.step(),
            Some(')') => {
                scanner.step();
                return Ok(values);
            }
            _ => return Err(Problem::OpenBracket.at(place)),
        }
    }
}

/// Behind PROC: `NAME(REAL DEPTH, INT COUNT=1) DISPLOF`.
pub(super) fn header(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Header, NcError> {
    scanner.skip_blanks();
    scanner.identifier();
    scanner.skip_blanks();
    let mut parameters = Vec::new();
    if scanner.peek() == Some('(') {
        let open = scanner.place();
        scanner.step();
        scanner.skip_blanks();
        while scanner.peek() != Some(')') {
            let kind = variables::kind(scanner)?;
            let name = variables::new_name(scanner)?;
            scanner.skip_blanks();
            let default = if scanner.peek() == Some('=') {
                scanner.step();
                expression::value(scanner, lookup)?
            } else {
                0.0
            };
            parameters.push((name, kind, default));
            scanner.skip_blanks();
            match scanner.peek() {
                Some(',') => scanner.step(),
                Some(')') => {}
                _ => return Err(Problem::OpenBracket.at(open)),
            }
        }
        scanner.step();
    }
    let mut saves = false;
    loop {
        scanner.skip_blanks();
        let (place, word) = (scanner.place(), scanner.identifier().to_ascii_uppercase());
        match word.as_str() {
            "" => return Ok(Header { parameters, saves }),
            "SAVE" => saves = true,
            word if DISPLAY.contains(&word) => {}
            word => {
                let problem = keywords::refused_word(word).unwrap_or(Problem::StatementRest);
                return Err(problem.at(place));
            }
        }
    }
}

/// Names of files with the subprogram.
pub(crate) fn files(written: &str, upper: &str) -> Vec<String> {
    let lower = upper.to_ascii_lowercase();
    let names = [written, upper, &lower];
    let endings = ["SPF", "spf", "MPF", "mpf"];
    let files = endings
        .iter()
        .flat_map(|ending| names.map(|name| format!("{name}.{ending}")));
    files.collect()
}

/// Whether the subprogram `name`, in upper case, begins at the line `text`: behind the header of an archive, or with the line if that is
/// its PROC.
pub(crate) fn begins(text: &str, name: &str) -> Option<bool> {
    if let Some(header) = archive_header(text) {
        let name_of = header.rsplit_once('_').map(|(name, _)| name);
        return (name_of? == name).then_some(false);
    }
    (proc_name(text)? == name).then_some(true)
}

/// Whether another program begins at the line `text`.
pub(super) fn begins_program(text: &str) -> bool {
    is_archive_header(text) || proc_name(text).is_some()
}

/// Whether the line `text` is a header of an archive.
pub(crate) fn is_archive_header(text: &str) -> bool {
    archive_header(text).is_some()
}

/// `NAME_SPF` of `%_N_NAME_SPF`.
fn archive_header(text: &str) -> Option<String> {
    let upper = text.trim().strip_prefix('%')?.trim_start().to_ascii_uppercase();
    upper.strip_prefix("_N_").map(str::to_owned)
}

/// The name behind PROC.
fn proc_name(text: &str) -> Option<String> {
    let mut scanner = Scanner::new(text, 0);
    scanner.skip_block_number();
    if !scanner.identifier().eq_ignore_ascii_case("PROC") {
        return None;
    }
    scanner.skip_blanks();
    Some(scanner.identifier().to_ascii_uppercase())
}

impl Block {
    /// In a subprogram the end of a program is its end.
    pub(crate) fn end_as_subprogram(&mut self) {
        for code in &mut self.codes {
            if code.code == Code::End {
                *code = CodeWord::new(code.name, Code::SubprogramEnd, Group::Call, code.place);
            }
        }
    }
}

impl Reader {
    /// A subprogram is called.
    pub(super) fn call_named(&mut self, call: Call, place: SourcePosition) -> Result<(), NcError> {
        if call.times == 0 {
            return Ok(());
        }
        let upper = call.name.to_ascii_uppercase();
        let found = self.find(Name::Siemens(&call.name, &upper), place)?;
        let by = Called::Name {
            arguments: call.arguments,
            bound: false,
        };
        self.enter_level(found, by, call.times, place)?;
        self.interpreter.parameters.enter(&[]);
        Ok(())
    }

    /// PROC gives the parameters of the subprogram their values; without a call there are none.
    pub(super) fn bind(&mut self, header: Header, place: SourcePosition) -> Result<(), NcError> {
        let mut first = true;
        for_each_line(self.level(), place, |found, text| {
            let before = found.line + 1 < place.line;
            first &= !(before && says_something(text));
            !(before && first)
        })?;
        if !first {
            let (code, why) = (
                "PROC",
                "another program begins here: end the one before with M30, M17 or RET",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let arguments = self.level().take_arguments();
        if arguments.len() > header.parameters.len() {
            let (given, most) = (arguments.len(), header.parameters.len());
            return Err(Problem::Arguments { given, most }.at(place));
        }
        if header.saves && self.is_named() {
            self.interpreter.save_codes(place);
        }
        for (index, (name, kind, default)) in header.parameters.into_iter().enumerate() {
            let value = arguments.get(index).copied().flatten().unwrap_or(default);
            self.interpreter
                .parameters
                .define(name, Variable::new(kind, vec![value]));
        }
        Ok(())
    }

    /// RET and M17, and M2 and M30 of a subprogram; those of the main program end it.
    pub(crate) fn end_subprogram(
        &mut self,
        code: &'static str,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        match self.level().called() {
            None => {
                self.ends_text(code, place)?;
                self.interpreter.finish(code, place)
            }
            Some(Called::Name { .. } | Called::Number) => self.leave_again(),
            Some(Called::Macro(_) | Called::OWord(_) | Called::Part { .. }) => {
                let why =
                    "it stands in a part that REPEAT runs again, or in a subroutine of O words or of G65";
                Err(Problem::Impossible { code, why }.at(place))
            }
        }
    }

    /// What stands behind M17 in the main program would be left out, and machines of other builders switch with M17.
    fn ends_text(&mut self, code: &'static str, place: SourcePosition) -> Result<(), NcError> {
        if code != "M17" {
            return Ok(());
        }
        let mut behind = false;
        for_each_line(self.level(), place, |found, text| {
            let only_ends = ["M2", "M02", "M30"].contains(&text.trim());
            behind = found.line + 1 > place.line && says_something(text) && !only_ends;
            behind
        })?;
        if behind {
            let why = "it ends the program (Siemens), and blocks stand behind it; leave it out, or end the program with M30";
            return Err(Problem::Impossible { code, why }.at(place));
        }
        Ok(())
    }
}
