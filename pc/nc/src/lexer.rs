//! From a line of text to words.

use super::error::{NcError, Problem, SourcePosition};

/// Largest number of a program: nine digits before the point. Of more, too few are left behind it.
const LARGEST: f64 = 999_999_999.999_999_9;

/// What a word is about: a letter, or a name such as `V1` of `V1=2`. Upper case.
pub type Address = String;

/// A word with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// Letter or name.
    pub address: Address,
    /// Its value.
    pub value: f64,
    /// Written with `=`.
    pub named: bool,
    /// Where it starts.
    pub place: SourcePosition,
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

/// The parts of one line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Starts with `/`.
    pub delete: bool,
    /// `%` in this line.
    pub percent: Option<SourcePosition>,
    /// Words in their order.
    pub words: Vec<Word>,
}

/// Splits line number `line` into words; comments and blanks are gone.
pub fn split(text: &str, line: u32) -> Result<Line, NcError> {
    let mut scanner = Scanner {
        text: text.chars().collect(),
        next: 0,
        line,
    };
    let mut parts = Line::default();
    let mut empty = true;
    loop {
        scanner.skip_blanks();
        let place = scanner.place();
        let Some(c) = scanner.peek() else {
            return Ok(parts);
        };
        match c {
            ';' => return Ok(parts),
            '(' => scanner.comment()?,
            '/' if empty => {
                scanner.next += 1;
                parts.delete = true;
            }
            '/' => return Err(Problem::DeleteInside.at(place)),
            '%' => {
                scanner.next += 1;
                if parts.percent.replace(place).is_some() {
                    return Err(Problem::Percent.at(place));
                }
            }
            '#' | '[' | ']' | '=' => return Err(Problem::Expression.at(place)),
            '0'..='9' | '.' | '+' | '-' => return Err(Problem::LooseNumber.at(place)),
            c if c.is_ascii_alphabetic() => {
                let word = scanner.word()?;
                parts.words.push(word);
            }
            c => return Err(Problem::Character(c).at(place)),
        }
        empty = false;
    }
}

struct Scanner {
    text: Vec<char>,
    next: usize,
    line: u32,
}

impl Scanner {
    fn peek(&self) -> Option<char> {
        self.text.get(self.next).copied()
    }

    fn place(&self) -> SourcePosition {
        SourcePosition {
            line: self.line,
            column: self.next as u32 + 1,
        }
    }

    fn skip_blanks(&mut self) {
        self.take(char::is_whitespace);
    }

    fn take(&mut self, wanted: impl Fn(char) -> bool) -> String {
        let start = self.next;
        while self.peek().is_some_and(&wanted) {
            self.next += 1;
        }
        self.text[start..self.next].iter().collect()
    }

    fn comment(&mut self) -> Result<(), NcError> {
        let start = self.place();
        self.next += 1;
        self.take(|c| c != '(' && c != ')');
        match self.peek() {
            Some(')') => {
                self.next += 1;
                Ok(())
            }
            Some(_) => Err(Problem::NestedComment.at(self.place())),
            None => Err(Problem::OpenComment.at(start)),
        }
    }

    fn word(&mut self) -> Result<Word, NcError> {
        let place = self.place();
        let (address, named) = match self.name() {
            Some(name) => (name, true),
            None => {
                let letter = self.text[self.next].to_ascii_uppercase();
                self.next += 1;
                if letter == 'O' {
                    return Err(Problem::Subroutine.at(place));
                }
                (letter.to_string(), false)
            }
        };
        self.skip_blanks();
        if matches!(self.peek(), Some('#' | '[')) {
            return Err(Problem::Expression.at(self.place()));
        }
        let value = self.number().ok_or_else(|| {
            let sign = if named { "=" } else { "" };
            Problem::NoNumber(format!("{address}{sign}")).at(place)
        })?;
        if value.abs() > LARGEST {
            return Err(Problem::TooLarge(address).at(place));
        }
        Ok(Word {
            address,
            value,
            named,
            place,
        })
    }

    /// `NAME=`, where a name is letters and digits; nothing is consumed if there is none.
    fn name(&mut self) -> Option<Address> {
        let start = self.next;
        let mut name = self.take(|c| c.is_ascii_alphabetic());
        name += &self.take(|c| c.is_ascii_digit());
        self.skip_blanks();
        if self.peek() == Some('=') {
            self.next += 1;
            Some(name.to_ascii_uppercase())
        } else {
            self.next = start;
            None
        }
    }

    /// Sign, digits, point, digits; at least one digit.
    fn number(&mut self) -> Option<f64> {
        let start = self.next;
        if matches!(self.peek(), Some('+' | '-')) {
            self.next += 1;
        }
        self.take(|c| c.is_ascii_digit());
        if self.peek() == Some('.') {
            self.next += 1;
            self.take(|c| c.is_ascii_digit());
        }
        let text: String = self.text[start..self.next].iter().collect();
        text.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(String, f64, u32)> {
        split(text, 1)
            .unwrap()
            .words
            .iter()
            .map(|w| (w.label(), w.value, w.place.column))
            .collect()
    }

    fn problem(text: &str) -> (Problem, u32) {
        let error = split(text, 7).unwrap_err();
        assert_eq!(error.place.line, 7);
        (error.problem, error.place.column)
    }

    #[test]
    fn words_may_touch_and_be_of_any_case() {
        let expected = [
            ("N", 10.0, 1),
            ("G", 1.0, 4),
            ("X", -1.25, 6),
            ("Y", 0.5, 12),
            ("Z", 3.0, 16),
            ("V1=", 2.5, 20),
        ]
        .map(|(label, value, column)| (label.to_owned(), value, column));
        assert_eq!(words("N10g1x-1.25Y+.5z3. v1=2.5"), expected);
    }

    #[test]
    fn values_keep_all_their_digits() {
        let [(_, value, _)] = words("X4999.987654321")[..] else {
            panic!("one word")
        };
        assert_eq!(value, 4999.987654321);
    }

    #[test]
    fn comments_vanish_and_must_be_closed() {
        assert_eq!(words("G1 (X5) X2 ; X7 (").len(), 2);
        assert_eq!(problem("G1 (open"), (Problem::OpenComment, 4));
        assert_eq!(problem("G1 (a (b))"), (Problem::NestedComment, 7));
    }

    #[test]
    fn what_is_not_understood_has_its_place() {
        assert_eq!(problem("G1 X#5"), (Problem::Expression, 5));
        assert_eq!(problem("X[1+2]"), (Problem::Expression, 2));
        assert_eq!(problem("G1 5"), (Problem::LooseNumber, 4));
        assert_eq!(problem("G1 X"), (Problem::NoNumber("X".into()), 4));
        assert_eq!(problem("G1 X-."), (Problem::NoNumber("X".into()), 4));
        assert_eq!(problem("G1 ö"), (Problem::Character('ö'), 4));
        assert_eq!(problem("o100 call"), (Problem::Subroutine, 1));
        assert_eq!(
            problem("G1 C99999999999999999999"),
            (Problem::TooLarge("C".into()), 4)
        );
        assert_eq!(
            problem(&format!("V1=-{}", "9".repeat(400))),
            (Problem::TooLarge("V1".into()), 1)
        );
        assert_eq!(words("X-999999999.9"), [("X".to_owned(), -999_999_999.9, 1)]);
        assert_eq!(problem("G1 / X1"), (Problem::DeleteInside, 4));
    }
}
