//! The radius of the tool, by D, its number or its diameter, and what Siemens programs say of the form of corners.

use crate::block::{Block, CodeWord, Word};
use crate::claims::Claims;
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem};
use crate::interpreter::Interpreter;
use crate::tool_length::tool;
use shared::geometry::Turn;

/// G450 or G451, and NORM or KONT.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Corners {
    /// Outside corners are not gone around, but to where the lines meet: since there.
    sharp: Option<CodeWord>,
    /// The tool goes around the contour to where that begins.
    around: Option<CodeWord>,
}

impl Corners {
    /// Takes up what a block says of them.
    pub(super) fn block(&mut self, block: &Block) {
        for code in block.codes.iter().filter(|code| code.group() == Group::Corners) {
            match code.code {
                Code::RoundCorners => self.sharp = None,
                Code::SharpCorners => self.sharp = Some(*code),
                Code::StraightEntry => self.around = None,
                _ => self.around = Some(*code),
            }
        }
    }
}

impl Interpreter {
    /// How far to the left of the contour the tip goes by G41 or G42 \[mm\].
    pub(super) fn offset(&mut self, code: CodeWord, block: &Block, claims: &Claims) -> Result<f64, NcError> {
        let d = claims.word(code.code, "D");
        let diameter = match (code.code, d) {
            (Code::LeftBy | Code::RightBy, Some(d)) => d.value * self.modal.unit(),
            (Code::LeftBy | Code::RightBy, None) => {
                let (name, word) = (code.name, "D, the diameter of the tool");
                return Err(Problem::Missing { code: name, word }.at(code.place));
            }
            _ => self.diameter(code, block, d)?,
        };
        if diameter == 0.0 {
            return Ok(0.0);
        }
        let corners = self.compensation.corners;
        let unlike = [
            (corners.sharp, "corners are gone around by arcs here: write G450"),
            (
                corners.around,
                "the tool goes straight to the contour here: write NORM",
            ),
        ];
        if let Some((said, why)) = unlike.into_iter().find_map(|(said, why)| Some((said?, why))) {
            return Err(Problem::Impossible { code: said.name, why }.at(code.place));
        }
        let left = matches!(code.code, Code::Left | Code::LeftBy);
        // What is mirrored has the tool on the other side.
        let arcs = self.offsets.arcs(self.modal.plane);
        let turn = arcs
            .ok_or(Problem::StretchedArc.at(code.place))?
            .turn(Turn::CounterClockwise);
        let same = left == (turn == Turn::CounterClockwise);
        Ok(if same { diameter / 2.0 } else { -diameter / 2.0 })
    }

    /// The diameter of the tool of D, or of the one in the machine \[mm\].
    fn diameter(&mut self, code: CodeWord, block: &Block, d: Option<&Word>) -> Result<f64, NcError> {
        let mounted = self.tool_numbers[1];
        let own = block.code(Group::Tool).is_none().then_some(mounted);
        let number = match d {
            // Of a tool that is called by a name, D is the edge.
            Some(d) if self.name_of_tool(mounted).is_none() => {
                let number = tool(d)?;
                let said = own.filter(|own| number != 0 && *own != 0 && *own != number);
                if let Some(own) = said.filter(|_| !self.setup.tools.is_empty()) {
                    let text = format!(
                        "{} D{number} takes the diameter of tool {number}, as on LinuxCNC, with tool {own} in the machine",
                        code.name
                    );
                    self.tell_once(text, d.place);
                }
                if number == 0 { mounted } else { number }
            }
            _ => mounted,
        };
        let diameter = match self.tools.diameter_of(number) {
            Some(diameter) => diameter,
            None if number == 0 || self.setup.tools.is_empty() => 0.0,
            None => {
                let place = d.map_or(code.place, |d| d.place);
                return Err(Problem::NoTool(number).at(place));
            }
        };
        if diameter == 0.0 {
            let text = format!(
                "{} changes nothing: the machine file has no diameter of the tool",
                code.name
            );
            self.tell_once(text, code.place);
        }
        Ok(diameter)
    }
}
