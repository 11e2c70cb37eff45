//! The characters of one line, with their places.

use super::error::{NcError, Problem, SourcePosition};
use std::borrow::Cow;

/// Largest number of a program: nine digits before the point. Of more, too few are left behind it.
const LARGEST: f64 = 999_999_999.999_999_9;

/// Reads a line from its start.
#[derive(Clone, Debug)]
pub(super) struct Scanner<'t> {
    text: Cow<'t, str>,
    /// Bytes that are read.
    next: usize,
    line: u32,
    /// A byte is a character.
    ascii: bool,
}

impl<'t> Scanner<'t> {
    /// Line number `line`.
    pub(super) fn new(text: &'t str, line: u32) -> Self {
        Self {
            text: text.into(),
            next: 0,
            line,
            ascii: text.is_ascii(),
        }
    }

    /// The next character.
    pub(super) fn peek(&self) -> Option<char> {
        match self.text.as_bytes().get(self.next) {
            Some(byte) if byte.is_ascii() => Some(char::from(*byte)),
            _ => self.text[self.next..].chars().next(),
        }
    }

    /// Goes over it.
    pub(super) fn step(&mut self) {
        self.next += self.peek().map_or(0, char::len_utf8);
    }

    /// Where it stands.
    pub(super) fn place(&self) -> SourcePosition {
        let before = match self.ascii {
            true => self.next,
            false => self.text[..self.next].chars().count(),
        };
        SourcePosition {
            line: self.line,
            column: before as u32 + 1,
        }
    }

    /// To come back to.
    pub(super) fn mark(&self) -> usize {
        self.next
    }

    /// To where [`Self::mark`] was asked.
    pub(super) fn go_back(&mut self, mark: usize) {
        self.next = mark;
    }

    pub(super) fn skip_blanks(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.step();
        }
    }

    /// Goes over letters; how many.
    pub(super) fn skip_letters(&mut self) -> usize {
        let rest = self.text.as_bytes()[self.next..].iter();
        let letters = rest.take_while(|byte| byte.is_ascii_alphabetic()).count();
        self.next += letters;
        letters
    }

    /// Letters, in upper case; blanks do not part them from brackets behind.
    pub(super) fn letters(&mut self) -> String {
        self.take(|c| c.is_ascii_alphabetic()).to_ascii_uppercase()
    }

    /// Characters as long as they are `wanted`.
    pub(super) fn take(&mut self, wanted: impl Fn(char) -> bool) -> &str {
        let rest = &self.text[self.next..];
        let length = rest.find(|c| !wanted(c)).unwrap_or(rest.len());
        let start = self.next;
        self.next += length;
        &self.text[start..self.next]
    }

    /// `(…)`, with the scanner at the bracket: what stands inside.
    pub(super) fn comment(&mut self) -> Result<String, NcError> {
        let start = self.place();
        self.step();
        let rest = &self.text[self.next..];
        let mut depth = 1;
        let closing = rest.bytes().position(|byte| {
            match byte {
                b'(' => depth += 1,
                b')' => depth -= 1,
                _ => {}
            }
            depth == 0
        });
        let Some(length) = closing else {
            return Err(Problem::OpenComment.at(start));
        };
        let inside = rest[..length].to_owned();
        self.next += length + 1;
        Ok(inside)
    }

    /// `<name>`, in lower case and without blanks.
    pub(super) fn name(&mut self) -> Result<String, NcError> {
        let place = self.place();
        self.step();
        let rest = &self.text[self.next..];
        let length = rest.find('>').ok_or(Problem::OpenName.at(place))?;
        let name: String = rest[..length].chars().filter(|c| !c.is_whitespace()).collect();
        if name.is_empty() {
            return Err(Problem::NoName.at(place));
        }
        self.next += length + 1;
        Ok(name.to_lowercase())
    }

    /// `NAME=`, where a name is letters and digits; nothing is consumed if there is none.
    pub(super) fn address(&mut self) -> Option<String> {
        let start = self.next;
        self.skip_letters();
        while self.peek().is_some_and(|c| c.is_ascii_digit()) {
            self.step();
        }
        let end = self.next;
        self.skip_blanks();
        if self.peek() == Some('=') {
            self.step();
            return Some(self.text[start..end].to_ascii_uppercase());
        }
        self.next = start;
        None
    }

    /// A name: letters, digits and `_`, none at all where no letter stands.
    pub(super) fn identifier(&mut self) -> &str {
        match self.peek() {
            Some(c) if c.is_ascii_alphabetic() || c == '_' => {
                self.take(|c| c.is_ascii_alphanumeric() || c == '_')
            }
            _ => "",
        }
    }

    /// Goes over block delete and the number of a block, which it returns.
    pub(super) fn skip_block_number(&mut self) -> Option<u32> {
        self.skip_blanks();
        if self.peek() == Some('/') {
            self.step();
            self.skip_blanks();
        }
        let start = self.next;
        if !matches!(self.peek(), Some('N' | 'n')) {
            return None;
        }
        self.step();
        let number = self.take(|c| c.is_ascii_digit()).parse().ok();
        if number.is_none() {
            self.next = start;
        }
        self.skip_blanks();
        number
    }

    /// Whether a number of five digits or more without a point begins here with 0, and is not 0.
    pub(super) fn has_implied_point(&self) -> bool {
        let rest = self.text[self.next..].trim_start().trim_start_matches(['+', '-']);
        let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        let zero = rest[..end].bytes().all(|digit| digit == b'0');
        rest.starts_with('0') && end >= 5 && !zero && !rest[end..].starts_with('.')
    }

    /// The number and the operator of `#1 EQ #0]` or `#1 NE #0]`, if that stands here; the scanner goes behind it.
    pub(super) fn vacancy(&mut self) -> Option<(u32, String)> {
        let rest = self.text[self.next..]
            .trim_start()
            .strip_prefix('#')?
            .trim_start();
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let number = rest[..digits].parse().ok()?;
        let rest = rest[digits..].trim_start();
        let operator = rest.get(..2)?.to_ascii_uppercase();
        let behind = rest[2..]
            .trim_start()
            .strip_prefix("#0")?
            .trim_start()
            .strip_prefix(']')?;
        if !matches!(operator.as_str(), "EQ" | "NE") {
            return None;
        }
        self.next = self.text.len() - behind.len();
        Some((number, operator))
    }

    /// Whether `//` stands here, which begins a comment for Mach3 and is nothing else to others.
    pub(super) fn at_slashes(&self) -> bool {
        self.text[self.next..].starts_with("//")
    }

    /// Whether G65 stands here.
    pub(super) fn at_macro_call(&self) -> bool {
        match self.text.as_bytes()[self.next..] {
            [b'G' | b'g', b'6', b'5', ref rest @ ..] => {
                !matches!(rest.first(), Some(byte) if byte.is_ascii_digit() || *byte == b'.')
            }
            _ => false,
        }
    }

    /// Whether an R parameter stands here behind blanks and signs.
    pub(super) fn at_signed_parameter(&self) -> bool {
        let rest = self.text[self.next..].trim_start_matches(|c: char| c.is_whitespace() || "+-".contains(c));
        rest.starts_with(['R', 'r']) && rest[1..].starts_with(|c: char| c.is_ascii_digit())
    }

    /// Whether R and digits stand here, or with `bracket` R and `[`.
    pub(super) fn at_siemens_parameter(&self, bracket: bool) -> bool {
        match self.text.as_bytes()[self.next..] {
            [b'R' | b'r', second, ..] => second.is_ascii_digit() || bracket && second == b'[',
            _ => false,
        }
    }

    /// Whether a name or number that stands here, with its index in brackets, has a single `=` behind it.
    pub(super) fn is_assignment(&self) -> bool {
        let rest = &self.text[self.next..];
        let rest = rest.trim_start_matches(|c: char| c.is_ascii_alphanumeric() || c == '_');
        let behind = match rest.strip_prefix('[') {
            Some(index) => index.split_once(']').map_or("", |(_, behind)| behind),
            None => rest,
        };
        let behind = behind.trim_start();
        behind.starts_with('=') && !behind.starts_with("==")
    }

    /// Sign, digits, point, digits; at least one digit, with blanks in between. Nothing is consumed if there is none.
    pub(super) fn number(&mut self) -> Result<Option<f64>, NcError> {
        let place = self.place();
        let rest = &self.text.as_bytes()[self.next..];
        let mut digits = 0;
        let mut point = false;
        let mut length = 0;
        for (index, byte) in rest.iter().enumerate() {
            match byte {
                b'+' | b'-' if index == 0 => {}
                b'0'..=b'9' => digits += 1,
                b'.' if !point => point = true,
                b' ' | b'\t' => continue,
                _ => break,
            }
            length = index + 1;
        }
        if digits == 0 {
            return Ok(None);
        }
        let text = &self.text[self.next..self.next + length];
        let value: f64 = match text.parse() {
            Ok(value) => value,
            Err(_) => {
                let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
                text.parse().unwrap_or(f64::INFINITY)
            }
        };
        self.next += length;
        if value.abs() > LARGEST {
            return Err(Problem::TooLarge("this value".to_owned()).at(place));
        }
        Ok(Some(value))
    }
}
