//! What programs of Siemens controllers (Sinumerik 840D) have besides. None of it means anything in RS274/NGC.
//!
//! ```text
//! line → read: assignments, labels, words without a number → block → interpreter
//!           or a Statement, alone in its line: DEF, IF … GOTOF, WHILE, calls, cycles → reader
//! ```

mod arcs;
pub(super) mod calls;
pub(super) mod corners;
pub(super) mod drilling;
pub(super) mod expression;
mod frames;
mod holes;
mod inserts;
mod jumps;
mod keywords;
pub(super) mod labels;
mod macros;
mod poles;
mod repeats;
mod statement;
pub(super) mod structures;
mod swivel;
pub(super) mod variables;
mod words;

pub(super) use keywords::{is_without_effect, refused_word};
pub use statement::Statement;
pub(super) use words::{check, tool_name, value};

use super::block::Block;
use super::error::NcError;
use super::parameters::InBlock;
use super::scanner::Scanner;

/// What stood at the scanner.
pub(super) enum Read {
    /// Nothing of Siemens.
    Nothing,
    /// Something that is in the block now.
    Words,
    /// A line of its own. In a box, as one is read for every word.
    Statement(Box<Statement>),
}

impl Read {
    fn statement(statement: Statement) -> Self {
        Self::Statement(Box::new(statement))
    }
}

/// What of Siemens stands at the scanner, if that is no word with a letter.
pub(super) fn read(scanner: &mut Scanner, block: &mut Block, lookup: &mut InBlock) -> Result<Read, NcError> {
    let start = scanner.mark();
    let letters = scanner.skip_letters();
    let name = letters > 1 || scanner.peek() == Some('_');
    scanner.go_back(start);
    if !name {
        return single_letter(scanner, block, lookup);
    }
    let first = block.is_empty() && lookup.settings.is_empty();
    if first {
        if words::label(scanner) {
            return Ok(Read::Words);
        }
        if let Some(statement) = statement::read(scanner, lookup)? {
            return Ok(Read::statement(statement));
        }
    }
    if words::message(scanner, block, lookup)?
        || keywords::read(scanner, block)?
        || variables::assignment(scanner, lookup)?
    {
        return Ok(Read::Words);
    }
    match first {
        true => Ok(calls::by_name(scanner, lookup)?.map_or(Read::Nothing, Read::statement)),
        false => Ok(Read::Nothing),
    }
}

/// `R1=…`, or `L123` as a call.
fn single_letter(scanner: &mut Scanner, block: &Block, lookup: &mut InBlock) -> Result<Read, NcError> {
    match scanner.peek() {
        Some('R' | 'r') if variables::assignment(scanner, lookup)? => Ok(Read::Words),
        Some('G' | 'g') if scanner.at_macro_call() && block.is_empty() && lookup.settings.is_empty() => {
            Ok(Read::statement(macros::call(scanner, lookup)?))
        }
        Some('L' | 'l') if block.is_empty() => {
            Ok(calls::by_number(scanner, lookup)?.map_or(Read::Nothing, Read::statement))
        }
        _ => Ok(Read::Nothing),
    }
}
