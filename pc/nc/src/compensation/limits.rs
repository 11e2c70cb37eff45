//! What is not possible while the tip goes beside a contour.

use crate::block::Block;
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use shared::io::AXES;

impl Interpreter {
    /// Refuses what changes where the contour is, or ends the look ahead along it.
    pub(super) fn check_beside_contour(&self, block: &Block) -> Result<(), NcError> {
        let Some(side) = self.compensation.side else {
            return Ok(());
        };
        let wrong = |code, place| {
            Err(Problem::WhileCompensated {
                code,
                line: side.line,
            }
            .at(place))
        };
        for code in &block.codes {
            let group = code.group();
            let possible = match code.code {
                Code::Dwell | Code::End => true,
                Code::OptionalPause => !self.optional_stop,
                Code::WaitForInput | Code::InverseTime | Code::RestoreModes => false,
                Code::System(number) => usize::from(number) == self.offsets.active + 1,
                code if group == Group::Motion => code.leads_to_an_end(),
                _ if group == Group::Plane => self.modal.plane == side.plane,
                _ => !matches!(
                    group,
                    Group::NonModal | Group::ToolLength | Group::Tool | Group::Stop | Group::Offset
                ),
            };
            if !possible {
                return wrong(code.name, code.place);
            }
        }
        if let Some((word, _)) = self.turning_word(block).filter(|_| self.tools.length != 0.0) {
            let why = "a tool with a length of its own is not turned beside a contour: write G40 before";
            return Err(word.value_error(why));
        }
        let moves = block
            .words
            .iter()
            .any(|word| crate::program::AXIS_WORDS.contains(&word.address.as_str()));
        if moves && self.modal.inverse_time() {
            return wrong(
                "G93",
                SourcePosition {
                    line: block.line,
                    column: 1,
                },
            );
        }
        if moves && self.modal.motion.is_some_and(|code| !code.leads_to_an_end()) {
            let name = self.modal.motion.map_or("", Code::name);
            return wrong(
                name,
                SourcePosition {
                    line: block.line,
                    column: 1,
                },
            );
        }
        Ok(())
    }

    fn turning_word<'b>(&self, block: &'b Block) -> Option<(&'b crate::block::Word, usize)> {
        (3..AXES).find_map(|axis| Some((block.word(crate::program::AXIS_WORDS[axis])?, axis)))
    }

    /// Refuses what needs the tip to be where the program says, after G40 without a motion.
    pub(crate) fn check_come_back(&self, code: &'static str, place: SourcePosition) -> Result<(), NcError> {
        let why = "after G40 a straight motion leads away from the contour first: write G0 or G1 with the axes of the plane before";
        match self.has_to_come_back() {
            true => Err(Problem::Impossible { code, why }.at(place)),
            false => Ok(()),
        }
    }

    /// Refuses G41 and G42 where one of them holds, or where a frame does not let the side be known.
    pub(crate) fn check_off(&self, code: &'static str, place: SourcePosition) -> Result<(), NcError> {
        match self.compensation.side {
            Some(side) => Err(Problem::WhileCompensated {
                code,
                line: side.line,
            }
            .at(place)),
            None => Ok(()),
        }
    }
}
