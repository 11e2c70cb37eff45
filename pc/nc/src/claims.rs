//! Assigns words to codes: P, Q and others have a different meaning with each code.

use super::block::{Block, Word};
use super::codes::{Code, Group};
use super::direction::DIRECTION_WORDS;
use super::error::{NcError, Problem};
use super::program::{AXIS_WORDS, EXTENSION_WORDS};

/// Words that belong to a code; all others stand for themselves.
const SHARED: [&str; 17] = [
    "P", "Q", "L", "E", "I", "J", "K", "R", "H", "D", "CR", "AR", "TURN", "I1", "J1", "K1", "RPL",
];

/// The direction of the tool in straight motions after G43.5.
pub(super) const VECTOR_LETTERS: [&str; 3] = ["I", "J", "K"];

/// The words of a block with their codes.
#[derive(Debug, Default)]
pub(super) struct Claims<'b>(Vec<(&'b Word, Code)>);

impl<'b> Claims<'b> {
    /// Finds for every word of `block` the code that it belongs to; `modal` is the motion that continues in a
    /// block without a code of its own. With `vectors` I J K of a straight motion are the direction of the tool.
    pub(super) fn of(block: &'b Block, modal: Option<Code>, vectors: bool) -> Result<Self, NcError> {
        let own = block.codes.iter().map(|code| code.code);
        // Without a word of its motion a block has none: G64 P0.1 after an arc.
        let modal = modal.filter(|_| own.clone().next().is_none() || block.words.iter().any(of_motion));
        let codes: Vec<Code> = own.chain(modal).collect();
        let mut claims = Self::default();
        for word in block
            .words
            .iter()
            .filter(|w| SHARED.contains(&w.address.as_str()))
        {
            let address = word.address.as_str();
            if address == "D" && is_edge(block, word) {
                continue;
            }
            let takes = |words: fn(Code) -> &'static [&'static str]| {
                let code = codes.iter().copied();
                code.filter(move |code| words(*code).contains(&address))
            };
            // A code that cannot be without the word comes first.
            let owner = match takes(needs).next() {
                Some(code) => code,
                None => {
                    let words = if vectors { with_vectors } else { may_have };
                    let mut may = takes(words);
                    let first = may
                        .next()
                        .ok_or_else(|| Problem::Orphan(word.label()).at(word.place))?;
                    if let Some(second) = may.find(|code| *code != first) {
                        let (first, second) = (first.name(), second.name());
                        let word_label = word.label();
                        return Err(Problem::Ambiguous {
                            word: word_label,
                            first,
                            second,
                        }
                        .at(word.place));
                    }
                    first
                }
            };
            claims.0.push((word, owner));
        }
        Ok(claims)
    }

    /// The word `address` of `code`.
    pub(super) fn word(&self, code: Code, address: &str) -> Option<&'b Word> {
        let found = self
            .0
            .iter()
            .find(|(word, owner)| *owner == code && word.address == address);
        found.map(|(word, _)| *word)
    }
}

/// Whether D is the edge of a tool, or beside T and M6 the number of its radius, on other controllers.
fn is_edge(block: &Block, word: &Word) -> bool {
    let of_tool = block.word("T").is_some() || block.has(Code::ChangeTool);
    let count = if of_tool { 100 } else { 10 };
    let of_code = block.code(Group::ToolLength).is_some()
        || block
            .code(Group::Compensation)
            .is_some_and(|code| code.code != Code::CompensationOff);
    !of_code && word.number_below(count).is_some()
}

/// Whether a word cannot belong to anything but a motion.
fn of_motion(word: &Word) -> bool {
    let address = word.address.as_str();
    let words = [
        &AXIS_WORDS[..],
        &EXTENSION_WORDS,
        &DIRECTION_WORDS,
        &VECTOR_LETTERS,
        &["R", "CR", "AR"],
    ];
    words.iter().any(|words| words.contains(&address))
}

/// Words without which a code means nothing.
fn needs(code: Code) -> &'static [&'static str] {
    match code {
        Code::Dwell | Code::OutputOn | Code::OutputOff | Code::OutputOnNow | Code::OutputOffNow => &["P"],
        Code::Analog | Code::AnalogNow => &["E", "Q"],
        Code::SetOffsets => &["L", "P"],
        Code::Call => &["P"],
        Code::SetTool => &["Q"],
        _ => &[],
    }
}

/// The same as [`may_have`], where directions of the tool are vectors.
fn with_vectors(code: Code) -> &'static [&'static str] {
    match code {
        Code::Rapid | Code::Feed => &VECTOR_LETTERS,
        code if code.is_cycle() => &["R", "Q", "P", "L"],
        _ => may_have(code),
    }
}

/// Words that a code may have besides.
fn may_have(code: Code) -> &'static [&'static str] {
    match code {
        Code::ArcClockwise | Code::ArcCounterClockwise => &["I", "J", "K", "R", "CR", "P", "AR", "TURN"],
        Code::ArcThrough => &["I1", "J1", "K1"],
        Code::Turn | Code::MoreTurn => &["RPL"],
        Code::UniformNurbs => &["P", "L"],
        Code::KnotNurbs => &["P", "K", "R"],
        Code::Continuous => &["P", "Q"],
        Code::WaitForInput => &["P", "E", "L", "Q"],
        Code::CubicSpline => &["I", "J", "P", "Q"],
        Code::QuadraticSpline => &["I", "J"],
        Code::SetOffsets => &["R", "I", "J", "Q"],
        Code::TurnAbout => &["R"],
        Code::Tilt => &["I", "J", "K", "P", "Q", "R"],
        Code::ToolToPlane | Code::ToolToPlaneAtTip => &["P"],
        Code::Call => &["L"],
        Code::ToolLength | Code::MoreLength => &["H", "D"],
        Code::Left | Code::LeftBy | Code::Right | Code::RightBy => &["D"],
        Code::TipOn | Code::TipByVectors => &["H"],
        // K is what other controllers have for L.
        code if code.is_cycle() => &["R", "Q", "P", "L", "K"],
        _ => &[],
    }
}
