//! What can be wrong with an NC program, and where.

use thiserror::Error;

/// A place in a program; both count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line of the file.
    pub line: u32,
    /// Character in the line.
    pub column: u32,
}

/// A problem and its place.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("line {}, column {}: {problem}", place.line, place.column)]
pub struct NcError {
    /// Where.
    pub place: Place,
    /// What.
    pub problem: Problem,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Problem {
    /// No character of the dialect.
    #[error("'{0}' is not understood here")]
    Character(char),
    /// `(` without `)`.
    #[error("the comment is not closed")]
    OpenComment,
    /// `(` inside a comment.
    #[error("comments cannot be nested")]
    NestedComment,
    /// A letter without a number.
    #[error("{0} needs a number")]
    NoNumber(String),
    /// A number without a letter.
    #[error("a number without a letter before it")]
    LooseNumber,
    /// `#`, `[`: parameters and expressions.
    #[error("parameters and expressions are not supported")]
    Expression,
    /// `/` not at the start of a line.
    #[error("block delete must stand at the start of the line")]
    DeleteInside,
    /// `%` with something else in its line, or at a wrong place.
    #[error("% must stand alone, in the first and in the last line")]
    Percent,
    /// N not at the start of a block, or not a whole number.
    #[error("a block number is a whole number at the start of the line")]
    BlockNumber,
    /// A word of another dialect.
    #[error("{0} is not understood")]
    UnknownWord(String),
    /// A G or M code of another dialect.
    #[error("{letter}{number} is not understood")]
    UnknownCode {
        /// G or M.
        letter: char,
        /// Its number.
        number: f64,
    },
    /// The same word twice in a block.
    #[error("{0} stands twice in this block")]
    Twice(String),
    /// Two codes of one modal group in a block.
    #[error("{first} and {second} exclude each other in one block")]
    ModalGroup {
        /// First code.
        first: &'static str,
        /// Second code.
        second: &'static str,
    },
    /// A word that belongs to a code that is not in the block.
    #[error("{0} has no code in this block that it belongs to")]
    Orphan(String),
    /// A code without a word it needs.
    #[error("{code} needs {word}")]
    Missing {
        /// The code.
        code: &'static str,
        /// The word.
        word: &'static str,
    },
    /// A word with a value it cannot have.
    #[error("{word}{value} is not possible: {reason}")]
    Value {
        /// The word.
        word: String,
        /// Its value.
        value: f64,
        /// What is possible.
        reason: &'static str,
    },
    /// Axis words without G0, G1, G2 or G3.
    #[error("axis words without a motion: G0, G1, G2 or G3 must come first")]
    NoMotion,
    /// Motion without tool centre point control.
    #[error("G43.4 must come before the first motion of the tip: X Y Z are its coordinates")]
    NotTip,
    /// The first motion must be complete.
    #[error("the first motion of the tip must be a G0 with X Y Z and all rotary axes of the machine")]
    FirstMotion,
    /// G53 with G1, G2 or G3.
    #[error("G53 moves axes with G0 only: write G53 G0")]
    AxesNeedRapid,
    /// M62 for a motion in axis space.
    #[error("M62 cannot take effect with G53: in axis space beams and tracking stay off")]
    OnInAxes,
    /// An arc with centre and radius.
    #[error("an arc has a centre (I J) or a radius (R), not both")]
    CentreAndRadius,
    /// G1, G2 or G3 without F.
    #[error("G1, G2 and G3 need a feed: no F was given")]
    NoFeed,
    /// G4, M62, M63 or M67 without a motion after it.
    #[error("{0} has no motion after it, before or with which it would take effect")]
    NoMotionAfter(&'static str),
    /// Something after the end.
    #[error("nothing may follow the end of the program")]
    AfterEnd,
    /// No M2 or M30.
    #[error("the program has no end: M2 or M30 is missing")]
    NoEnd,
    /// Only commands that do not move.
    #[error("the program does not move the machine")]
    Empty,
}

impl Problem {
    /// This problem at `place`.
    pub(super) fn at(self, place: Place) -> NcError {
        NcError { place, problem: self }
    }
}
