//! O words: subroutines, conditions and loops.

use super::error::{NcError, Problem, SourcePosition};
use super::expression;
use super::parameters::Lookup;
use super::scanner::Scanner;

/// What an O word says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keyword {
    /// Nothing: the number of the program, or of a subroutine for M98.
    Number,
    /// `sub`.
    Sub,
    /// `endsub`.
    EndSub,
    /// `call`.
    Call,
    /// `return`.
    Return,
    /// `if`.
    If,
    /// `elseif`.
    ElseIf,
    /// `else`.
    Else,
    /// `endif`.
    EndIf,
    /// `while`, at the start of a loop or at the end of a `do`.
    While,
    /// `endwhile`.
    EndWhile,
    /// `do`.
    Do,
    /// `repeat`.
    Repeat,
    /// `endrepeat`.
    EndRepeat,
    /// `break`.
    Break,
    /// `continue`.
    Continue,
}

const KEYWORDS: [(&str, Keyword); 15] = [
    ("SUB", Keyword::Sub),
    ("ENDSUB", Keyword::EndSub),
    ("CALL", Keyword::Call),
    ("RETURN", Keyword::Return),
    ("IF", Keyword::If),
    ("ELSEIF", Keyword::ElseIf),
    ("ELSE", Keyword::Else),
    ("ENDIF", Keyword::EndIf),
    ("WHILE", Keyword::While),
    ("ENDWHILE", Keyword::EndWhile),
    ("DO", Keyword::Do),
    ("REPEAT", Keyword::Repeat),
    ("ENDREPEAT", Keyword::EndRepeat),
    ("BREAK", Keyword::Break),
    ("CONTINUE", Keyword::Continue),
];

/// A line that begins with O, or with a colon and the number of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct OWord {
    /// Number or name, lower case.
    pub label: String,
    /// What it says.
    pub keyword: Keyword,
    /// Values in brackets after it; none if they were not to be computed.
    pub arguments: Vec<f64>,
    /// Where.
    pub place: SourcePosition,
}

/// The O word at the scanner, behind a block number or without one, if there is one. Arguments are computed if they
/// are `wanted`; without, whatever follows the keyword is not read.
pub(super) fn o_word(
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    wanted: bool,
) -> Result<Option<OWord>, NcError> {
    let start = scanner.mark();
    scanner.skip_blanks();
    if matches!(scanner.peek(), Some('N' | 'n')) {
        scanner.step();
        scanner.take(|c| c.is_ascii_digit() || c == '.' || c.is_whitespace());
    }
    let place = scanner.place();
    let colon = scanner.peek() == Some(':');
    if !colon && !matches!(scanner.peek(), Some('O' | 'o')) {
        scanner.go_back(start);
        return Ok(None);
    }
    scanner.step();
    scanner.skip_blanks();
    if colon && matches!(scanner.peek(), Some('O' | 'o')) {
        // As some posts write it.
        scanner.step();
    }
    // Words of other controllers may begin with it.
    if scanner.peek().is_some_and(|c| c.is_ascii_alphabetic()) {
        scanner.go_back(start);
        return Ok(None);
    }
    let label = if scanner.peek() == Some('<') {
        scanner.name()?
    } else {
        let number = expression::value(scanner, lookup)?;
        let number = number.ok_or(Problem::NoNumber("O".to_owned()).at(place))?;
        format!("{}", number.round())
    };
    scanner.skip_blanks();
    let (at, behind) = (scanner.place(), scanner.mark());
    let name = scanner.letters();
    let keyword = if name.len() == 1 {
        // A word behind the number of a program.
        scanner.go_back(behind);
        Keyword::Number
    } else if name.is_empty() {
        Keyword::Number
    } else if colon {
        return Err(Problem::FlowRest.at(at));
    } else {
        let found = KEYWORDS.iter().find(|(own, _)| *own == name);
        found.ok_or(Problem::UnknownKeyword(name).at(at))?.1
    };
    let mut arguments = Vec::new();
    if wanted {
        loop {
            scanner.skip_blanks();
            let at = scanner.place();
            match scanner.peek() {
                None | Some(';') => break,
                Some('(') => drop(scanner.comment()?),
                Some('[') if keyword != Keyword::Number => {
                    arguments.extend(expression::value(scanner, lookup)?)
                }
                Some(_) => return Err(Problem::FlowRest.at(at)),
            }
        }
    }
    Ok(Some(OWord {
        label,
        keyword,
        arguments,
        place,
    }))
}
