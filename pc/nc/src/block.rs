//! From a line of text to a block: codes by modal group, words by their letter, parameters that it sets.

use super::codes::{CODES, Code, Group, LATHE, NEAR, of_other_machines, refused};
use super::error::{NcError, Problem, SourcePosition};
use super::expression;
use super::flow::{self, OWord};
use super::foreign;
use super::grbl;
use super::parameters::{InBlock, Lookup, Parameter};
use super::scanner::Scanner;
use super::siemens::{self, Read, Statement};
use std::collections::BTreeSet;

/// A word with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// Letter, or a name such as `V1` of `V1=2`; upper case.
    pub address: String,
    /// Its value.
    pub value: f64,
    /// A name, written with `=`.
    pub named: bool,
    /// How it is meant by IC( ) and its like, whatever G90 and G91 say.
    pub distance: Option<Distance>,
    /// Where it starts.
    pub place: SourcePosition,
}

/// How the value of one word is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distance {
    /// IC( ): a step.
    Step,
    /// AC( ): a coordinate.
    Absolute,
    /// DC( ): an angle up to whole turns, the short way.
    Shortest,
    /// ACP( ): the same in the positive direction.
    Upward,
    /// ACN( ): the same in the negative direction.
    Downward,
}

impl Distance {
    /// Of lengths, which have no other ones but coordinates.
    pub fn is_step(self) -> bool {
        self == Self::Step
    }

    /// DC( ), ACP( ) and ACN( ) are for rotary axes.
    pub fn turns(self) -> bool {
        matches!(self, Self::Shortest | Self::Upward | Self::Downward)
    }

    /// The coordinate that `value` means where the axis is at `now`.
    pub fn coordinate(self, value: f64, now: f64) -> f64 {
        let turns = (now - value) / 360.0;
        // Angles that differ by less are the same.
        let same = 1e-9;
        value
            + 360.0
                * match self {
                    Self::Step => return now + value,
                    Self::Absolute => return value,
                    Self::Shortest => turns.round(),
                    Self::Upward => (turns - same).ceil(),
                    Self::Downward => (turns + same).floor(),
                }
    }
}

impl Word {
    /// As it is written, without its value: `X`, `V1=`.
    pub fn label(&self) -> String {
        let sign = if self.named { "=" } else { "" };
        format!("{}{sign}", self.address)
    }

    /// Its value, if that is one of 0 … `count` − 1.
    pub fn number_below(&self, count: u8) -> Option<u8> {
        (0..count).find(|n| f64::from(*n) == self.value)
    }

    /// What is wrong with its value.
    pub fn value_error(&self, reason: &'static str) -> NcError {
        Problem::Value {
            word: self.label(),
            value: self.value,
            reason,
        }
        .at(self.place)
    }
}

/// A code in a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CodeWord {
    /// What it means.
    pub code: Code,
    /// As people write it.
    pub name: &'static str,
    /// Where.
    pub place: SourcePosition,
    group: Group,
}

impl CodeWord {
    pub(super) fn group(&self) -> Group {
        self.group
    }

    pub(super) fn new(name: &'static str, code: Code, group: Group, place: SourcePosition) -> Self {
        Self {
            code,
            name,
            place,
            group,
        }
    }
}

/// One line of a program that is to be carried out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Line of the file.
    pub line: u32,
    /// G and M codes, at most one of each modal group, but M7 and M8.
    pub codes: Vec<CodeWord>,
    /// All other words, each at most once, without N.
    pub words: Vec<Word>,
    /// Polar steps that X and Y were made of: \[mm\] and \[deg\].
    pub polar_step: Option<[f64; 2]>,
    /// Parameters that get a value when all of the block has been read.
    pub settings: Vec<(Parameter, f64)>,
    /// T with the name of a tool.
    pub tool_name: Option<(String, SourcePosition)>,
    /// WELDON with the name of its data, or WELDOFF without.
    pub weld: Option<(Option<String>, SourcePosition)>,
    /// M codes and commands to Grbl that are passed over.
    pub passed_over: Vec<(String, SourcePosition)>,
    /// Comments, in their order.
    pub comments: Vec<(String, SourcePosition)>,
}

impl Block {
    /// The code of `group` in this block.
    pub fn code(&self, group: Group) -> Option<&CodeWord> {
        self.codes.iter().find(|c| c.group == group)
    }

    /// Whether `code` is in this block.
    pub fn has(&self, code: Code) -> bool {
        self.codes.iter().any(|c| c.code == code)
    }

    /// The word with this letter or name.
    pub fn word(&self, address: &str) -> Option<&Word> {
        self.words.iter().find(|w| w.address == address)
    }

    /// Whether it has comments and nothing else.
    pub fn is_comment(&self) -> bool {
        self.settings_alone() && self.settings.is_empty() && self.passed_over.is_empty()
    }

    /// Whether it sets parameters, if it does anything.
    pub fn settings_alone(&self) -> bool {
        self.codes.is_empty() && self.words.is_empty() && self.weld.is_none() && self.tool_name.is_none()
    }

    /// Whether nothing stands in it.
    pub fn is_empty(&self) -> bool {
        self.is_comment() && self.comments.is_empty()
    }
}

/// What a line of text is.
#[derive(Clone, Debug, PartialEq)]
pub enum Parsed {
    /// Nothing but blanks, or deleted.
    Blank,
    /// Starts with `%`.
    Percent,
    /// `O…`.
    Flow(OWord),
    /// A line of a Siemens program that is no block.
    Statement(Statement),
    /// Something to carry out.
    Block(Block),
}

/// Most bytes of a line: more is no program.
const LONGEST_LINE: usize = 10_000;
/// Letters and names that are words of the dialect, besides G, M and N.
const WORDS: [&str; 21] = [
    "X", "Y", "Z", "A", "B", "C", "I", "J", "K", "R", "F", "P", "L", "E", "Q", "S", "T", "H", "D", "@", "^",
];
/// Words that are lengths.
pub(super) const LENGTHS: [&str; 7] = ["X", "Y", "Z", "I", "J", "K", "R"];
/// The same, written with `=`.
const NAMED_WORDS: [&str; 22] = [
    "V1", "V2", "A3", "B3", "C3", "CR", "AR", "TURN", "I1", "J1", "K1", "AP", "RP", "RPL", "CTOL", "ANG",
    "RND", "RNDM", "CHF", "CHR", "FRC", "FRCM",
];

/// What of a program is not carried out.
#[derive(Clone, Copy)]
pub(super) struct Skipped<'a> {
    /// Blocks that begin with `/`.
    pub(super) blocks: bool,
    /// M codes that mean nothing here.
    pub(super) functions: &'a BTreeSet<u16>,
    /// Commands to Grbl that move nothing.
    pub(super) commands: bool,
    /// Something has moved.
    pub(super) moved: bool,
}

/// Reads line number `line`, in which `lookup` knows the values of parameters.
pub(super) fn parse(
    text: &str,
    line: u32,
    skipped: Skipped<'_>,
    lookup: &mut dyn Lookup,
) -> Result<Parsed, NcError> {
    let mut scanner = Scanner::new(text, line);
    if text.len() > LONGEST_LINE {
        return Err(Problem::LongLine(LONGEST_LINE).at(scanner.place()));
    }
    scanner.skip_blanks();
    match scanner.peek() {
        None => return Ok(Parsed::Blank),
        Some('0'..='9' | '%') if is_heidenhain(text) => return Err(Problem::Heidenhain.at(scanner.place())),
        Some('%') => return Ok(Parsed::Percent),
        Some('/') if scanner.at_slashes() => return Ok(Parsed::Blank),
        Some('/') if skipped.blocks => return Ok(Parsed::Blank),
        Some('/') => {
            scanner.step();
            // The number of one of several switches, on other controllers.
            if let Some('1'..='9') = scanner.peek() {
                scanner.step();
            }
        }
        Some(_) => {}
    }
    if let Some(word) = flow::o_word(&mut scanner, lookup, true)? {
        return Ok(Parsed::Flow(word));
    }
    let mut block = Block {
        line,
        ..Block::default()
    };
    let lookup = &mut InBlock::new(lookup);
    let mut first = true;
    loop {
        scanner.skip_blanks();
        let place = scanner.place();
        let Some(c) = scanner.peek() else { break };
        match c {
            ';' => break,
            '(' => {
                let comment = scanner.comment()?;
                block.comments.push((comment, place));
                continue;
            }
            '/' if scanner.at_slashes() => break,
            '/' => return Err(Problem::DeleteInside.at(place)),
            '#' => {
                scanner.step();
                setting(&mut scanner, lookup)?;
            }
            '0'..='9' | '.' | '+' | '-' | '[' => return Err(Problem::LooseNumber.at(place)),
            '@' | '^' => {
                let word = word(&mut scanner, lookup)?;
                take(&mut block, word, false, skipped)?;
            }
            c if c.is_ascii_alphabetic() || c == '_' => {
                if matches!(c, 'W' | 'w') && weld(&mut scanner, &mut block)? {
                    first = false;
                    continue;
                }
                match siemens::read(&mut scanner, &mut block, lookup)? {
                    Read::Statement(statement) => return Ok(Parsed::Statement(*statement)),
                    Read::Words => {}
                    Read::Nothing => match tool_name(&mut scanner)? {
                        Some(name) => block.tool_name = Some((name, place)),
                        None => {
                            let word = word(&mut scanner, lookup)?;
                            take(&mut block, word, first, skipped)?;
                        }
                    },
                }
            }
            '$' | '?' if first && skipped.commands => {
                let command = grbl::command(&mut scanner, skipped.moved)?;
                block.passed_over.push((command, place));
            }
            '$' => return Err(Problem::Dollar.at(place)),
            c => return Err(Problem::Character(c).at(place)),
        }
        first = false;
    }
    block.settings = std::mem::take(&mut lookup.settings);
    foreign::adapt(&mut block)?;
    lathe_cycle(&block)?;
    siemens::check(&block, SourcePosition { line, column: 1 })?;
    // A block number alone does nothing.
    Ok(if block.is_empty() {
        Parsed::Blank
    } else {
        Parsed::Block(block)
    })
}

/// `0 BEGIN PGM NAME MM`, or `%NAME G71 *` of their DIN/ISO programs.
fn is_heidenhain(text: &str) -> bool {
    let text = text.trim_ascii();
    match text.strip_prefix('%') {
        Some(name) => {
            let name = name.trim_end_matches([' ', '*']);
            name.ends_with(" G70") || name.ends_with(" G71")
        }
        None => text
            .trim_start_matches(|c: char| c.is_ascii_digit())
            .trim_ascii_start()
            .starts_with("BEGIN PGM "),
    }
}

/// G70 and G71 are units but where they have words of a cycle, and G50 is the end of scaling but where it has words.
fn lathe_cycle(block: &Block) -> Result<(), NcError> {
    if let Some(code) = block.codes.iter().find(|code| code.name == "G50")
        && ["S", "X", "Y", "Z"].iter().any(|name| block.word(name).is_some())
    {
        let (letter, number, why) = ('G', 50.0, LATHE);
        return Err(Problem::RefusedCode { letter, number, why }.at(code.place));
    }
    let units = block
        .code(Group::Units)
        .filter(|code| matches!(code.name, "G70" | "G71"));
    match units {
        Some(code) if block.word("Q").is_some() || block.word("P").is_some() => Err(Problem::RefusedCode {
            letter: 'G',
            number: if code.name == "G70" { 70.0 } else { 71.0 },
            why: LATHE,
        }
        .at(code.place)),
        _ => Ok(()),
    }
}

/// `#… = …`, behind the `#`.
pub(super) fn setting(scanner: &mut Scanner, lookup: &mut InBlock) -> Result<(), NcError> {
    let place = scanner.place();
    let parameter = expression::parameter(scanner, lookup)?;
    scanner.skip_blanks();
    if scanner.peek() != Some('=') {
        return Err(Problem::LooseParameter(parameter.to_string()).at(place));
    }
    scanner.step();
    scanner.skip_blanks();
    let place = scanner.place();
    lookup.next = Some(parameter.clone());
    let value = expression::terms(scanner, lookup)?.ok_or(Problem::NoValue.at(place))?;
    lookup.next = None;
    lookup.settings.push((parameter, value));
    Ok(())
}

/// WELDON or WELDOFF, if one stands at the scanner.
fn weld(scanner: &mut Scanner, block: &mut Block) -> Result<bool, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let letters = scanner.letters();
    let name = match letters.as_str() {
        "WELDON" => Some(weld_name(scanner, place)?),
        "WELDOFF" => None,
        _ => {
            scanner.go_back(start);
            return Ok(false);
        }
    };
    if block.weld.is_some() {
        return Err(Problem::Twice(letters).at(place));
    }
    block.weld = Some((name, place));
    Ok(true)
}

/// The name in `T="NAME"`, if that stands at the scanner.
fn tool_name(scanner: &mut Scanner) -> Result<Option<String>, NcError> {
    let start = scanner.mark();
    if matches!(scanner.peek(), Some('T' | 't'))
        && scanner.address().is_some_and(|address| address == "T")
        && let Some(name) = siemens::tool_name(scanner)?
    {
        return Ok(Some(name));
    }
    scanner.go_back(start);
    Ok(None)
}

/// `=name` behind WELDON.
fn weld_name(scanner: &mut Scanner, place: SourcePosition) -> Result<String, NcError> {
    scanner.skip_blanks();
    let sign = scanner.peek() == Some('=');
    if sign {
        scanner.step();
        scanner.skip_blanks();
    }
    let name = scanner.take(|c| c.is_alphanumeric() || c == '_' || c == '-');
    if !sign || name.is_empty() {
        return Err(Problem::NoWeldName.at(place));
    }
    Ok(name.to_owned())
}

/// A letter or name with its number.
fn word(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Word, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let letters = scanner.skip_letters();
    scanner.go_back(start);
    let (address, sign) = match scanner.address() {
        Some(name) => (name, true),
        None => {
            let letter = scanner.peek().unwrap_or(' ').to_ascii_uppercase();
            scanner.step();
            (letter.to_string(), false)
        }
    };
    // A letter may be written with a sign, too: X=1.
    let named = sign && address.len() > 1;
    let of_word = |error: NcError| match error.problem {
        Problem::TooLarge(_) => Problem::TooLarge(address.clone()).at(place),
        _ => error,
    };
    if !sign && LENGTHS.contains(&address.as_str()) && scanner.has_implied_point() {
        return Err(Problem::ImpliedPoint(address).at(place));
    }
    let (value, distance) = match sign {
        true => siemens::value(scanner, lookup).map_err(of_word)?,
        // X R1 is not X=R1, but a word without a number.
        false if scanner.at_signed_parameter() => (None, None),
        false => (expression::value(scanner, lookup).map_err(of_word)?, None),
    };
    match value {
        Some(value) => Ok(Word {
            address,
            value,
            named,
            distance,
            place,
        }),
        None if letters > 1 && !named => {
            scanner.go_back(start);
            Err(unknown(scanner.letters(), false).at(place))
        }
        None => {
            let sign = if named { "=" } else { "" };
            Err(Problem::NoNumber(format!("{address}{sign}")).at(place))
        }
    }
}

/// Puts a word where it belongs in its block; it may be the `first`.
fn take(block: &mut Block, mut word: Word, first: bool, skipped: Skipped<'_>) -> Result<(), NcError> {
    if word.named && matches!(word.address.as_str(), "S1" | "M1") {
        // Of the first spindle, which is the only one.
        (word.address, word.named) = (word.address[..1].to_owned(), false);
    }
    match (word.address.as_str(), word.named) {
        ("N", false) => {
            if !first || word.value < 0.0 {
                return Err(Problem::BlockNumber.at(word.place));
            }
            Ok(())
        }
        ("G" | "M", false) => match code(&word) {
            Err(_) if siemens::is_without_effect(&word.address, word.value) => Ok(()),
            Err(error) => match of_other_machines(&word.address, word.value) {
                Some(number) if skipped.functions.contains(&number) => {
                    block.passed_over.push((format!("M{number}"), word.place));
                    Ok(())
                }
                _ => Err(error),
            },
            Ok(code) => block.add(code),
        },
        ("U" | "V" | "W", false) => Err(Problem::NoParallelAxes(word.address).at(word.place)),
        (address, named) => {
            let known: &[&str] = if named { &NAMED_WORDS } else { &WORDS };
            if !known.contains(&address) {
                return match named && siemens::is_without_effect(address, word.value) {
                    true => Ok(()),
                    false => Err(unknown(word.address, named).at(word.place)),
                };
            }
            if block.word(address).is_some() {
                return Err(Problem::Twice(word.label()).at(word.place));
            }
            block.words.push(word);
            Ok(())
        }
    }
}

/// Why a word is not understood.
fn unknown(mut word: String, named: bool) -> Problem {
    siemens::refused_word(&word).unwrap_or_else(|| {
        word.push_str(if named { "=" } else { "" });
        Problem::UnknownWord(word)
    })
}

impl Block {
    /// Puts a code into it, which must not exclude another one.
    pub(super) fn add(&mut self, code: CodeWord) -> Result<(), NcError> {
        let both = code.group == Group::Coolant && code.code != Code::CoolantOff;
        if matches!(code.group, Group::Hint | Group::Corners) {
            self.codes.push(code);
            return Ok(());
        }
        if let Some(other) = self.code(code.group)
            && !(both && other.code != Code::CoolantOff && other.code != code.code)
        {
            let (first, second) = (other.name, code.name);
            return Err(Problem::ModalGroup { first, second }.at(code.place));
        }
        self.codes.push(code);
        Ok(())
    }
}

fn code(word: &Word) -> Result<CodeWord, NcError> {
    let tenths = word.value * 10.0;
    let letter = if word.address == "G" { 'G' } else { 'M' };
    let found = CODES
        .iter()
        .find(|(own, number, ..)| *own == letter && (tenths - f64::from(*number)).abs() < NEAR);
    if let Some(&(_, _, code, name, group)) = found {
        let place = word.place;
        return Ok(CodeWord {
            code,
            name,
            place,
            group,
        });
    }
    let number = word.value;
    let problem = match refused(letter, tenths) {
        Some(why) => Problem::RefusedCode { letter, number, why },
        None => Problem::UnknownCode { letter, number },
    };
    Err(problem.at(word.place))
}
