//! From the words of a line to a block: codes by modal group, and words by their letter.

use super::codes::{CODES, Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::lexer::{self, Word};

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

/// One line of a program that is to be carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Line of the file.
    pub line: u32,
    /// Starts with `/`.
    pub delete: bool,
    /// G and M codes, at most one of each modal group.
    pub codes: Vec<CodeWord>,
    /// All other words, each at most once, without N.
    pub words: Vec<Word>,
}

impl Block {
    /// The code of `group` in this block.
    pub fn code(&self, group: Group) -> Option<&CodeWord> {
        self.codes.iter().find(|c| c.group == group)
    }

    /// The word with this letter or name.
    pub fn word(&self, address: &str) -> Option<&Word> {
        self.words.iter().find(|w| w.address == address)
    }
}

/// What a line of text is.
#[derive(Clone, Debug, PartialEq)]
pub enum Parsed {
    /// Nothing but blanks and comments.
    Blank,
    /// `%`.
    Percent(SourcePosition),
    /// Something to carry out.
    Block(Block),
}

/// Letters and names that are words of the dialect, besides G, M and N.
const WORDS: [&str; 16] = [
    "X", "Y", "Z", "A", "B", "C", "I", "J", "K", "R", "F", "P", "L", "E", "Q", "S",
];
/// The same, written with `=`.
const NAMED_WORDS: [&str; 2] = ["V1", "V2"];

/// Reads line number `line`.
pub fn parse(text: &str, line: u32) -> Result<Parsed, NcError> {
    let parts = lexer::split(text, line)?;
    if let Some(place) = parts.percent {
        return if parts.words.is_empty() && !parts.delete {
            Ok(Parsed::Percent(place))
        } else {
            Err(Problem::Percent.at(place))
        };
    }
    if parts.words.is_empty() {
        return Ok(Parsed::Blank);
    }
    let mut block = Block {
        line,
        delete: parts.delete,
        codes: Vec::new(),
        words: Vec::new(),
    };
    for (index, word) in parts.words.into_iter().enumerate() {
        match (word.address.as_str(), word.named) {
            ("N", false) => {
                if index > 0 || word.value < 0.0 || word.value.fract() != 0.0 {
                    return Err(Problem::BlockNumber.at(word.place));
                }
            }
            ("G" | "M", false) => {
                let code = code(&word)?;
                if let Some(other) = block.code(code.group) {
                    let (first, second) = (other.name, code.name);
                    return Err(Problem::ModalGroup { first, second }.at(word.place));
                }
                block.codes.push(code);
            }
            (address, named) => {
                let known: &[&str] = if named { &NAMED_WORDS } else { &WORDS };
                if !known.contains(&address) {
                    return Err(Problem::UnknownWord(word.label()).at(word.place));
                }
                if block.word(address).is_some() {
                    return Err(Problem::Twice(word.label()).at(word.place));
                }
                block.words.push(word);
            }
        }
    }
    Ok(Parsed::Block(block))
}

fn code(word: &Word) -> Result<CodeWord, NcError> {
    let tenths = word.value * 10.0;
    CODES
        .iter()
        .find(|(letter, number, ..)| {
            word.address.starts_with(*letter) && (tenths - f64::from(*number)).abs() < 1e-6
        })
        .map(|&(_, _, code, name, group)| CodeWord {
            code,
            name,
            place: word.place,
            group,
        })
        .ok_or_else(|| {
            Problem::UnknownCode {
                letter: if word.address == "G" { 'G' } else { 'M' },
                number: word.value,
            }
            .at(word.place)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> Problem {
        parse(text, 1).unwrap_err().problem
    }

    #[test]
    fn codes_are_found_by_number_and_group() {
        let Parsed::Block(block) = parse("n20 G01 g43.4 G090 X1", 3).unwrap() else {
            panic!("a block")
        };
        assert_eq!(block.line, 3);
        assert_eq!(block.code(Group::Motion).unwrap().code, Code::Feed);
        assert_eq!(block.code(Group::ToolLength).unwrap().code, Code::TipOn);
        assert_eq!(block.word("X").unwrap().value, 1.0);
        assert_eq!(block.words.len(), 1);
    }

    #[test]
    fn two_codes_of_one_group_exclude_each_other() {
        let (first, second) = ("G0", "G1");
        assert_eq!(problem("G0 G1 X1"), Problem::ModalGroup { first, second });
        let (first, second) = ("M62", "M67");
        assert_eq!(problem("M62 P0 M67 E0 Q1"), Problem::ModalGroup { first, second });
    }

    #[test]
    fn foreign_words_and_codes_are_refused() {
        let letter = 'G';
        assert_eq!(problem("G5 X1"), Problem::UnknownCode { letter, number: 5.0 });
        assert_eq!(problem("G43 H1"), Problem::UnknownCode { letter, number: 43.0 });
        assert_eq!(problem("D100"), Problem::UnknownWord("D".into()));
        assert_eq!(problem("A3=1"), Problem::UnknownWord("A3=".into()));
        assert_eq!(problem("V1"), Problem::UnknownWord("V".into()));
        assert_eq!(problem("X1 x2"), Problem::Twice("X".into()));
        assert_eq!(problem("G1 N5"), Problem::BlockNumber);
        assert_eq!(problem("N-5 G1"), Problem::BlockNumber);
        assert_eq!(problem("% G1"), Problem::Percent);
        assert_eq!(parse("  (nothing) ; here", 1), Ok(Parsed::Blank));
    }
}
